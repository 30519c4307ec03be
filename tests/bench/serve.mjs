// Serving benchmark: one viewer at 60 frames/s on the seed scene. Run by hand on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/serve.mjs [SECONDS] [--out FILE] [ARGUMENT of serve]...
// Prints (and writes) JSON: frames/s received, real-time factor, the server's p95 latency, time to the first frame.
import { writeFile } from "node:fs/promises";
import { cpus } from "node:os";
import { Client, Server, sleep } from "../protocol/harness.mjs";

const args = process.argv.slice(2);
const seconds = /^\d+$/.test(args[0] ?? "") ? Number(args.shift()) : 20;
const out = args[0] === "--out" ? args.splice(0, 2)[1] : null;

const server = await Server.start(...args);
const listening = performance.now();
const client = await Client.connect(server);
await client.request("stream.subscribe", { encoding: "q16", rate: 60, in_flight: 2 });
const first = await client.frame();
const { renderer } = await client.notification("hello");

const metric = (text, name) => Number(new RegExp(`^${name} (\\S+)$`, "m").exec(text)[1]);
const metrics = async () => (await server.get("/metrics")).body.toString();
/// 95th percentile of what was added to the histogram between two readings [s].
function p95(before, after) {
  const buckets = (text) =>
    [...text.matchAll(/latency_seconds_bucket\{le="([^"]+)"\} (\d+)/g)].map((m) => [Number(m[1]), Number(m[2])]);
  const earlier = buckets(before);
  const added = buckets(after).map(([edge, count], i) => [edge, count - earlier[i][1]]);
  const rank = 0.95 * added.at(-1)[1];
  const i = added.findIndex(([, count]) => count >= rank);
  const [low, below] = i === 0 ? [0, 0] : added[i - 1];
  return low + ((added[i][0] - low) * (rank - below)) / (added[i][1] - below);
}

await sleep(2000); // warm-up
const before = await metrics();
const mark = { frames: client.frames.length, messages: client.messages.length, at: performance.now() };
await sleep(seconds * 1000);
const frames = client.frames.slice(mark.frames);
const elapsed = (performance.now() - mark.at) / 1000;
const statuses = client.messages
  .slice(mark.messages)
  .filter((m) => m.method === "sim.status")
  .map((m) => m.params);
const after = await metrics();
const gaps = frames
  .slice(1)
  .map((frame, i) => frame.receivedAt - frames[i].receivedAt)
  .sort((a, b) => a - b);

const round = (value, digits) => Number(value.toFixed(digits));
const result = {
  benchmark: "serve",
  machine: `${cpus()[0].model.trim()}, ${cpus().length} cores`,
  renderer,
  scene: args.includes("--scene") ? args[args.indexOf("--scene") + 1] : "seed",
  vertices: first.vertexCount,
  seconds: round(elapsed, 1),
  frames_per_second: round(frames.length / elapsed, 2),
  frame_gap_p95_ms: round(gaps[Math.floor(0.95 * gaps.length)], 2),
  real_time_factor_mean: round(statuses.reduce((sum, s) => sum + s.real_time_factor, 0) / statuses.length, 4),
  real_time_factor_min: round(Math.min(...statuses.map((s) => s.real_time_factor)), 4),
  server_latency_p95_ms: round(p95(before, after) * 1000, 3),
  bytes_per_second: round(
    (metric(after, "clothlab_bytes_sent_total") - metric(before, "clothlab_bytes_sent_total")) / elapsed,
    0,
  ),
  listening_after_s: round((listening - server.startedAt) / 1000, 3),
  first_frame_after_s: round((first.receivedAt - server.startedAt) / 1000, 3),
};
await client.close();
await server.stop();
const text = JSON.stringify(result, null, 2);
console.log(text);
if (out) await writeFile(out, text + "\n");
