// The frames of the last minute, as they came, to look at again. Bounded in time and in bytes.
import type { ShownFrame } from "./protocol";

export const longest = 60_000; // [ms]
export const mostBytes = 48e6;

export interface KeptFrame {
  frame: ShownFrame;
  at: number; ///< when it came, on the clock of performance.now() [ms]
}

export class KeptFrames {
  bytes = 0;
  wentBack: (step: number) => void = () => undefined; ///< the session has gone back to this step, or one before it
  private frames: KeptFrame[] = [];
  private first = 0; // frames before it are dropped

  /// The oldest first.
  get all(): KeptFrame[] {
    return this.frames.slice(this.first);
  }

  /// Frames of another cloth, or of steps that the session has gone back behind, are forgotten.
  take(frame: ShownFrame, at: number): void {
    const { step, topologyRevision } = frame.header;
    const last = this.frames.at(-1)?.frame.header;
    if (last && last.topologyRevision !== topologyRevision) this.clear();
    if (last && (last.topologyRevision !== topologyRevision || last.step > step)) this.wentBack(step);
    while (this.frames.length > this.first && (this.frames.at(-1) as KeptFrame).frame.header.step >= step)
      this.bytes -= (this.frames.pop() as KeptFrame).frame.buffer.byteLength;
    this.frames.push({ frame, at });
    this.bytes += frame.buffer.byteLength;
    for (;;) {
      const oldest = this.frames[this.first] as KeptFrame;
      if (at - oldest.at <= longest && (this.bytes <= mostBytes || oldest.frame === frame)) break;
      this.bytes -= oldest.frame.buffer.byteLength;
      delete this.frames[this.first++];
    }
    if (this.first < 1024) return;
    this.frames = this.all;
    this.first = 0;
  }

  /// These again, in the place of all: the session has gone back to the run that they are of.
  restore(frames: KeptFrame[]): void {
    this.frames = frames;
    this.first = 0;
    this.bytes = frames.reduce((sum, { frame }) => sum + frame.buffer.byteLength, 0);
  }

  private clear(): void {
    this.frames = [];
    this.first = this.bytes = 0;
  }
}
