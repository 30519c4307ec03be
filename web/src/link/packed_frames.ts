// The page's side of the thread that unpacks c16 frames; it is started when the first of them comes.
import type { Mesh } from "./unpack";
import type { FromWorker, ToWorker } from "./unpack_worker";
import { BadMessage } from "./protocol";

type Done = (buffer: ArrayBuffer) => void;

export class PackedFrames {
  private worker: Worker | null = null;
  private mesh: Mesh | null = null;
  private waiting: Done[] = []; // for the answers to come, in their order

  /// `refused`: a message is no frame; `broken`: there is no thread for them here.
  constructor(private readonly events: { refused(error: BadMessage): void; broken(): void }) {}

  /// Takes the topology of the frames that follow.
  take({ vertexCount, triangles }: Mesh): void {
    this.mesh = { vertexCount, triangles };
    this.send({ mesh: this.mesh });
  }

  /// Calls `done` with the message as q16, after those of all messages before it.
  unpack(message: ArrayBuffer, done: Done): void {
    if (!this.worker) this.start();
    this.waiting.push(done);
    this.send({ message }, [message]);
  }

  /// Forgets the frames under way: the link is another one.
  forget(): void {
    this.worker?.terminate();
    this.worker = null;
    this.waiting = [];
  }

  private start(): void {
    this.worker = new Worker("unpack.js");
    this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      const done = this.waiting.shift();
      if ("buffer" in data) done?.(data.buffer);
      else this.events.refused(new BadMessage(data.problem));
    };
    this.worker.onerror = () => this.events.broken();
    if (this.mesh) this.send({ mesh: this.mesh });
  }

  private send(message: ToWorker, transfer: Transferable[] = []): void {
    this.worker?.postMessage(message, transfer);
  }
}
