// Cost of compressed frames: bytes a vertex of c16 over the first second of `drape`, and the time that the page's
// thread for them takes to unpack one, in Node, whose engine is Chromium's. By hand, on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/unpack.mjs [--out FILE]
import { writeFile } from "node:fs/promises";
import { cpus, loadavg } from "node:os";
import { load } from "../page/module.mjs";
import { Client, Server } from "../protocol/harness.mjs";
import { median } from "../median.mjs";

const out = process.argv[2] === "--out" ? process.argv[3] : null;
const before = loadavg()[0]; // of other processes: if it is not near 0, every time below is wrong
const { Unpacker } = await load("link/unpack");

const server = await Server.start();
const rows = [];
for (const side of [25, 64]) {
  const client = await Client.connect(server, { session: `unpack-${side}` });
  const messages = [];
  client.socket.on("message", (data, isBinary) => {
    if (isBinary && data[0] === 2 && data[1] === 2) messages.push(new Uint8Array(data).slice().buffer);
  });
  const { document } = await client.request("scene.load", { preset: "drape" }).then(() => client.request("scene.get"));
  document.cloths[0].mesh.grid.columns = document.cloths[0].mesh.grid.rows = side;
  await client.request("scene.load", { scene: document });
  await client.request("stream.subscribe", { encoding: "c16", rate: 30 });
  await client.nextFrame(({ time, vertexCount }) => vertexCount === side * side && time > 1);
  await client.request("sim.pause");
  const { vertexCount, triangles } = client.topologies.at(-1);
  const unpacker = new Unpacker();
  unpacker.take({ vertexCount, triangles: Uint32Array.from(triangles.flat()) });
  const times = [];
  const ours = messages.filter((message) => new DataView(message).getUint32(12, true) === vertexCount);
  for (const message of [...ours, ...ours]) {
    const start = performance.now();
    await unpacker.unpack(message);
    times.push(performance.now() - start);
  }
  const sizes = ours.map((message) => (message.byteLength - 64) / vertexCount);
  rows.push({
    grid: `${side}x${side}`,
    frames: ours.length,
    bytes_per_vertex: Number((sizes.reduce((sum, size) => sum + size, 0) / sizes.length).toFixed(2)),
    unpack_ms: Number(median(times.slice(ours.length)).toFixed(2)), // the first time the engine still compiles
  });
  console.log(JSON.stringify(rows.at(-1)));
  await client.close();
}
const result = { machine: `${cpus()[0].model}, ${cpus().length} cores`, load: Number(before.toFixed(2)), rows };
if (out) await writeFile(out, `${JSON.stringify(result, null, 1)}\n`);
await server.stop();
