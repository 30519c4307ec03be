// Saves the scene as it is seen, in the size that is chosen: a PNG, or a video that the browser itself records; and the
// present cloths as the server writes them.
import { button, element } from "./dom";
import { fileName } from "./file_name";
import { notice, noticeError } from "./notices";
import { chosenSize, paint, saveFile, savePicture } from "./picture_file";
import type { Screen } from "./save_buttons";
import { withDuration } from "./webm_duration";
import type { PictureSize } from "../view/photograph";

const mostSeconds = 600; // of a video
const mostBytes = 256e6; // of a video, which the browser keeps in memory
const rate = 30; // frames a second
const kinds = [
  ["video/webm;codecs=vp9", "webm"],
  ["video/webm;codecs=vp8", "webm"],
  ["video/webm", "webm"],
  ["video/mp4", "mp4"], // Safari before 18.4 knows no other
] as const;

const backdrop = [0.45, 0.55] as const; // as in style.css

export class ScreenSaver {
  // Of a video. The stage's picture is transparent beside the scene: here it lies on the page's backdrop.
  private readonly canvas = document.createElement("canvas");
  private readonly button = button("save-video");
  private recorder: MediaRecorder | null = null;
  private timer = 0;

  constructor(private readonly screen: Screen) {}

  private get time(): number {
    return this.screen.stage.frame?.header.time ?? 0;
  }

  private get size(): PictureSize {
    return chosenSize(element("picture-size", HTMLSelectElement), this.screen.stage);
  }

  async savePicture(): Promise<void> {
    const name = fileName(this.screen.sceneName(), this.time, "png");
    const clear = element("picture-clear", HTMLInputElement).checked;
    if (!(await savePicture(this.screen.stage, this.size, backdrop, clear, name)))
      noticeError("Not saved", new Error("The browser made no picture of it."));
  }

  async saveModel(): Promise<void> {
    try {
      const bytes = await this.screen.get("/api/mesh.glb");
      saveFile(new Blob([bytes], { type: "model/gltf-binary" }), fileName(this.screen.sceneName(), this.time, "glb"));
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
    const { stage } = this.screen;
    const { size } = this;
    Object.assign(this.canvas, size).getContext("2d"); // there is no stream of a canvas without
    stage.film = { size, take: () => paint(stage, this.canvas, backdrop) };
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
      stage.film = null;
      for (const track of stream.getTracks()) track.stop();
      clearInterval(this.timer);
      this.recorder = null;
      this.tell("Video", false);
      if (bytes > 0) void this.saveVideo(new Blob(chunks, { type: type.split(";")[0] ?? type }), name);
    };
    recorder.start(1000);
    const tell = (): void => this.tell(`Stop video (${((performance.now() - begun) / 1000).toFixed(0)} s)`, true);
    tell();
    this.timer = window.setInterval(tell, 1000);
  }

  private async saveVideo(video: Blob, name: string): Promise<void> {
    const { type } = video;
    if (type !== "video/webm") return saveFile(video, name);
    saveFile(new Blob(withDuration(new Uint8Array(await video.arrayBuffer()), 1 / rate), { type }), name);
  }

  private tell(text: string, live: boolean): void {
    this.button.textContent = text;
    this.button.classList.toggle("live", live);
  }
}
