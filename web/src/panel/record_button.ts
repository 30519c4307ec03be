// The button that records the session. What it does is loaded when it is used, or when the session is being recorded.
import { button } from "./dom";
import type { RecordControl } from "./record";

/// As `sim.status` and `record.*` tell it.
export interface RecordingFacts {
  state: "none" | "recording" | "ready";
  scene: string; ///< the name of the one that it began with
  rate: number; ///< [1/s]
  frames: number;
  bytes: number;
  full: boolean;
  times: [number, number] | null; ///< of the first and the newest frame [s]
}

export interface RecordPort {
  request(method: string, params: Record<string, unknown>): Promise<Record<string, unknown>>;
  get(path: string): Promise<ArrayBuffer>;
}

export class RecordButton {
  private control: Promise<RecordControl> | null = null;

  constructor(private readonly port: RecordPort) {
    button("record").onclick = () => void this.load().then((control) => control.toggle());
  }

  told(facts: RecordingFacts | undefined): void {
    if (facts && (this.control || facts.state !== "none")) void this.load().then((control) => control.show(facts));
  }

  private load(): Promise<RecordControl> {
    return (this.control ??= import("./record").then(({ RecordControl }) => new RecordControl(this.port)));
  }
}
