// Saves what is on screen: a PNG of the picture, or a video that the browser itself records of it; and the present
// cloths as the server writes them.
import { button } from "./dom";
import { fileName } from "./file_name";
import { notice, noticeError } from "./notices";
import type { Screen } from "./save_buttons";

const mostSeconds = 600; // of a video
const mostBytes = 256e6; // of a video, which the browser keeps in memory
const rate = 30; // frames a second
const kinds = [
  ["video/webm;codecs=vp9", "webm"],
  ["video/webm;codecs=vp8", "webm"],
  ["video/webm", "webm"],
  ["video/mp4", "mp4"], // Safari before 18.4 knows no other
] as const;

function save(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

export class ScreenSaver {
  // The picture is transparent beside the scene: here it lies on the page's backdrop.
  private readonly canvas = document.createElement("canvas");
  private readonly button = button("save-video");
  private recorder: MediaRecorder | null = null;
  private timer = 0;

  constructor(private readonly screen: Screen) {}

  private get time(): number {
    return this.screen.stage.frame?.header.time ?? 0;
  }

  private paint(): void {
    const { canvas: view } = this.screen.stage;
    const { canvas } = this;
    const context = canvas.getContext("2d") as CanvasRenderingContext2D;
    const { width, height } = canvas;
    const style = getComputedStyle(document.documentElement);
    const backdrop = context.createRadialGradient(0, 0, 0, 0, 0, 1);
    backdrop.addColorStop(0, style.getPropertyValue("--backdrop-near").trim());
    backdrop.addColorStop(1, style.getPropertyValue("--backdrop-far").trim());
    context.setTransform(0.9 * width, 0, 0, 0.75 * height, 0.45 * width, 0.55 * height); // as in style.css
    context.fillStyle = backdrop;
    context.fillRect(-1, -1, 3, 3);
    context.resetTransform();
    context.drawImage(view, 0, 0, width, height);
  }

  private resize(): void {
    const { width, height } = this.screen.stage.canvas;
    Object.assign(this.canvas, { width, height });
  }

  savePicture(): void {
    const name = fileName(this.screen.sceneName(), this.time, "png");
    this.screen.stage.drawSharp();
    if (!this.recorder) this.resize();
    this.paint();
    this.canvas.toBlob((blob) => {
      if (blob) save(blob, name);
      else noticeError("Not saved", new Error("The browser made no picture of it."));
    }, "image/png");
  }

  async saveModel(): Promise<void> {
    try {
      const bytes = await this.screen.get("/api/mesh.glb");
      save(new Blob([bytes], { type: "model/gltf-binary" }), fileName(this.screen.sceneName(), this.time, "glb"));
    } catch (error) {
      noticeError("Not saved", error as Error);
    }
  }

  toggleVideo(): void {
    if (this.recorder) this.recorder.stop();
    else this.startVideo();
  }

  private startVideo(): void {
    const able = "MediaRecorder" in window && "captureStream" in this.canvas;
    const kind = able ? kinds.find(([type]) => MediaRecorder.isTypeSupported(type)) : undefined;
    if (!kind) {
      notice("warning", {
        title: "This browser records no video",
        lines: [
          "It has no MediaRecorder that writes WebM. Record, beside it, saves a page that plays in any browser; Picture saves a PNG.",
        ],
      });
      return;
    }
    const [type, ending] = kind;
    const name = fileName(this.screen.sceneName(), this.time, ending);
    this.resize();
    const { stage } = this.screen;
    stage.drawSharp();
    this.paint();
    const stream = this.canvas.captureStream(rate);
    const recorder = (this.recorder = new MediaRecorder(stream, { mimeType: type, videoBitsPerSecond: 8e6 }));
    const chunks: Blob[] = [];
    const begun = performance.now();
    let bytes = 0;
    recorder.ondataavailable = ({ data }) => {
      chunks.push(data);
      bytes += data.size;
      const long = performance.now() - begun > 1000 * mostSeconds;
      if (recorder.state !== "recording" || (!long && bytes <= mostBytes)) return;
      recorder.stop();
      notice("warning", {
        title: "The video has ended and is saved",
        lines: [`A video has ${mostSeconds / 60} minutes and ${mostBytes / 1e6} MB at most.`],
      });
    };
    recorder.onerror = () => noticeError("The video has ended", new Error("The browser could not go on recording it."));
    recorder.onstop = () => {
      stage.onDrawn = () => undefined;
      for (const track of stream.getTracks()) track.stop();
      clearInterval(this.timer);
      this.recorder = null;
      this.tell("Video", false);
      if (bytes > 0) save(new Blob(chunks, { type: type.split(";")[0] ?? type }), name);
    };
    stage.onDrawn = () => this.paint();
    recorder.start(1000);
    const tell = (): void => this.tell(`Stop video (${((performance.now() - begun) / 1000).toFixed(0)} s)`, true);
    tell();
    this.timer = window.setInterval(tell, 1000);
  }

  private tell(text: string, live: boolean): void {
    this.button.textContent = text;
    this.button.classList.toggle("live", live);
  }
}
