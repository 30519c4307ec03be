// A thread beside the page's for the frames of slow lines: takes meshes and c16 messages, and answers each message, in
// their order, with a q16 message or with what is wrong with it.
import { Unpacker, type Mesh } from "./unpack";

export type ToWorker = { mesh: Mesh } | { message: ArrayBuffer };
export type FromWorker = { buffer: ArrayBuffer } | { problem: string };

const unpacker = new Unpacker();
let last = Promise.resolve();

self.onmessage = ({ data }: MessageEvent<ToWorker>) => {
  last = last.then(async () => {
    if ("mesh" in data) return unpacker.take(data.mesh);
    let answer: FromWorker;
    try {
      answer = { buffer: await unpacker.unpack(data.message) };
    } catch (error) {
      answer = { problem: (error as Error).message };
    }
    self.postMessage(answer, { transfer: "buffer" in answer ? [answer.buffer] : [] });
  });
};
