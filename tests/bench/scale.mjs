// Large cloths: how long a server takes to load one, to send its first frame, and what it then steps and sends, with
// the memory it has. A square sheet on a ball (`drape`), its thickness that of its mesh. By hand, on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/scale.mjs [SIDE,SIDE...] [--seconds S] [--out FILE]
// Prints (and writes) JSON, a row for each number of vertices along a side.
import { readFileSync } from "node:fs";
import { writeFile } from "node:fs/promises";
import { cpus, loadavg } from "node:os";
import { parseArgs } from "node:util";
import WebSocket from "ws";
import { Server, sleep } from "../protocol/harness.mjs";
import { fineDrape } from "./scenes.mjs";

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: { seconds: { type: "string", default: "10" }, out: { type: "string" } },
});
const sides = (positionals[0] ?? "256,512,1000").split(",").map(Number);
const load = loadavg()[0]; // of other processes: if it is not near 0, every time below is wrong

/// A client that does not decode frames, as it shares the cores with the server.
class RawClient {
  static async connect(server, session) {
    const client = new RawClient();
    client.answers = new Map();
    client.frames = [];
    client.socket = new WebSocket(`ws://${server.host}/ws?session=${session}`, ["clothlab.v1"]);
    client.socket.on("message", (data, isBinary) => {
      if (isBinary) {
        if (data[0] !== 2) return; // a topology
        client.frames.push({ at: performance.now(), bytes: data.length, vertices: data.readUInt32LE(12) });
        client.socket.send(
          JSON.stringify({ jsonrpc: "2.0", method: "stream.ack", params: { frame: data.readUInt32LE(8) } }),
        );
        return client.wake?.();
      }
      const message = JSON.parse(data);
      if (message.id !== undefined) client.answers.get(message.id)(message);
      else if (message.method === "sim.status") client.status = message.params;
      else if (message.method === "sim.diverged") throw new Error(message.params.reason);
    });
    await new Promise((resolve) => client.socket.once("open", resolve));
    return client;
  }
  async request(method, params = {}) {
    const id = this.answers.size;
    const answer = await new Promise((resolve) => {
      this.answers.set(id, resolve);
      this.socket.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
    });
    if (answer.error) throw new Error(JSON.stringify(answer.error));
    return answer.result;
  }
  async frameOf(vertices) {
    while (!this.frames.some((frame) => frame.vertices === vertices))
      await new Promise((resolve) => (this.wake = resolve));
    return this.frames.find((frame) => frame.vertices === vertices);
  }
}

/// [MB]
const memory = (server, what) =>
  Number(
    new RegExp(`^${what}:\\s+(\\d+) kB`, "m").exec(readFileSync(`/proc/${server.child.pid}/status`, "latin1"))[1],
  ) / 1000;
const round = (value, digits = 2) => Number(value.toFixed(digits));

const rows = [];
for (const side of sides) {
  const server = await Server.start();
  const client = await RawClient.connect(server, "main");
  await client.request("stream.subscribe", { encoding: "q16", rate: 30, in_flight: 2 });
  await client.request("sim.pause");
  const scene = fineDrape(side);
  const start = performance.now();
  await client.request("scene.load", { scene });
  const loaded = performance.now();
  const first = await client.frameOf(side * side);
  await client.request("sim.play");
  await sleep(2000);
  const mark = client.frames.length;
  const before = client.status;
  await sleep(1000 * Number(values.seconds));
  const after = client.status;
  rows.push({
    vertices: side * side,
    load_s: round((loaded - start) / 1000),
    first_frame_s: round((first.at - start) / 1000),
    first_frame_mb: round(first.bytes / 1e6),
    steps_per_s: round((after.step - before.step) / Number(values.seconds)),
    frames_per_s: round((client.frames.length - mark) / Number(values.seconds)),
    buffers_mb: round(after.memory_bytes / 1e6, 0),
    memory_mb: round(memory(server, "VmRSS"), 0),
    most_memory_mb: round(memory(server, "VmHWM"), 0),
  });
  console.log(JSON.stringify(rows.at(-1)));
  client.socket.terminate();
  await server.stop();
}
const result = { machine: `${cpus()[0].model.trim()}, ${cpus().length} cores`, load: round(load), rows };
if (values.out) await writeFile(values.out, `${JSON.stringify(result, null, 1)}\n`);
