// Starts and ends a recording of the session, and saves the last one: as a page that plays it, or alone.
import { button, element } from "./dom";
import { noticeError } from "./notices";
import type { RecordingFacts, RecordPort } from "./record_button";

const megabytes = (bytes: number): string => `${(bytes / 1e6).toFixed(bytes < 1e7 ? 1 : 0)} MB`;

/// How long it plays [s]: it begins with its first frame, at 0.
const secondsOf = (frames: number, rate: number): string => (Math.max(0, frames - 1) / rate).toFixed(0);

const kinds = [
  ["html", "Save as page", "One file that plays in any browser, without a server"],
  ["clothlab", "Save as .clothlab", "The recording alone"],
  ["glb", "Export .glb", "With bodies, for Blender, game engines and viewers: glTF with a shape a frame"],
  ["usda", "Export .usda", "With bodies, for programs that read USD"],
] as const;

export class RecordControl {
  private readonly start = button("record");
  private readonly files = element("record-files", HTMLElement);
  private recording = false;
  private name = "clothlab"; ///< of its files: the scene and the times that they show

  constructor(private readonly port: RecordPort) {
    for (const [ending, text, title] of kinds) {
      const save = document.createElement("button");
      Object.assign(save, { type: "button", textContent: text, title });
      save.onclick = () => void this.save(ending);
      this.files.append(save);
    }
    this.files.hidden = true;
  }

  toggle(): void {
    this.port
      .request(this.recording ? "record.stop" : "record.start", {})
      .then((facts) => this.show(facts as unknown as RecordingFacts))
      .catch((error: Error) => noticeError("Not recorded", error));
  }

  show({ state, scene, rate, frames, bytes, times }: RecordingFacts): void {
    if (times) this.name = `${scene} ${times.map((time) => time.toFixed(2)).join("-")} s`;
    this.recording = state === "recording";
    const text = this.recording ? `Stop recording (${secondsOf(frames, rate)} s, ${megabytes(bytes)})` : "Record";
    if (this.start.textContent !== text) this.start.textContent = text;
    this.start.classList.toggle("live", this.recording);
    this.files.hidden = state !== "ready" || frames === 0;
  }

  private async save(ending: string): Promise<void> {
    try {
      const bytes = await this.port.get(`/api/recording.${ending}`);
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([bytes]));
      link.download = `${this.name}.${ending}`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
    } catch (error) {
      noticeError("The recording could not be saved", error as Error);
    }
  }
}
