// What a job of the lab costs the session beside it: one viewer at 60 frames/s on a playing scene, first alone, then
// while its chart is measured on the processor and on the GPU, then alone again. By hand, on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/lab.mjs [SECONDS] [--out FILE] [ARGUMENT of serve]...
// Prints (and writes) JSON: for each stretch of time the frames/s received, the gaps between them, the real-time
// factor, and how long a cancel takes.
import { writeFile } from "node:fs/promises";
import { cpus } from "node:os";
import { Client, Server, sleep, withTimeout } from "../protocol/harness.mjs";

const args = process.argv.slice(2);
const seconds = /^\d+$/.test(args[0] ?? "") ? Number(args.shift()) : 20;
const out = args[0] === "--out" ? args.splice(0, 2)[1] : null;

const server = await Server.start(...args);
const client = await Client.connect(server);
await client.request("stream.subscribe", { encoding: "q16", rate: 60, in_flight: 2 });
const first = await client.frame();
const { renderer } = await client.notification("hello");
const round = (value, digits) => Number(value.toFixed(digits));

async function stretch(name) {
  const mark = { frames: client.frames.length, messages: client.messages.length, at: performance.now() };
  await sleep(seconds * 1000);
  const frames = client.frames.slice(mark.frames);
  const elapsed = (performance.now() - mark.at) / 1000;
  const factors = client.messages
    .slice(mark.messages)
    .filter((m) => m.method === "sim.status")
    .map((m) => m.params.real_time_factor);
  const gaps = frames
    .slice(1)
    .map((frame, i) => frame.receivedAt - frames[i].receivedAt)
    .sort((a, b) => a - b);
  // The slowest second tells more than the mean of all seconds.
  const inSecond = Array.from(
    { length: seconds },
    (_, i) => frames.filter((frame) => Math.floor((frame.receivedAt - mark.at) / 1000) === i).length,
  );
  return {
    name,
    frames_per_second: round(frames.length / elapsed, 2),
    frames_in_slowest_second: Math.min(...inSecond),
    frame_gap_p95_ms: round(gaps[Math.floor(0.95 * gaps.length)], 2),
    frame_gap_longest_ms: round(gaps.at(-1), 2),
    real_time_factor_mean: round(factors.reduce((sum, factor) => sum + factor, 0) / factors.length, 4),
    real_time_factor_min: round(Math.min(...factors), 4),
  };
}

/// Measures while a chart is doing `what`, then cancels the chart.
async function beside(name, what, params) {
  const { job } = await client.request("lab.chart", { ...params, fresh: true });
  await withTimeout(
    client.notification("lab.progress", (p) => p.job === job && what.test(p.doing)),
    name,
    120_000,
  );
  const measured = await stretch(name);
  const last = client.messages.findLast((m) => m.method === "lab.progress").params;
  const asked = performance.now();
  await client.request("lab.cancel", { job });
  const { state, result } = await client.notification("lab.result", (r) => r.job === job && r.state !== "running");
  return {
    ...measured,
    job: {
      doing: last.doing,
      state,
      points: result?.points.length ?? 0,
      cancel_ms: round(performance.now() - asked, 1),
    },
  };
}

const stretches = [];
try {
  await sleep(2000); // warm-up
  stretches.push(await stretch("alone"));
  stretches.push(await beside("beside the reference of a chart", /^the reference/, { budget: 600 }));
  stretches.push(await beside("beside the trials of a chart", /, dt /, { time: 0.1, budget: 600 }));
  stretches.push(await stretch("alone again"));
} finally {
  await client.close();
  await server.stop();
}

const text = JSON.stringify(
  {
    benchmark: "lab",
    machine: `${cpus()[0].model.trim()}, ${cpus().length} cores`,
    renderer,
    scene: args.includes("--scene") ? args[args.indexOf("--scene") + 1] : "seed",
    vertices: first.vertexCount,
    seconds_a_stretch: seconds,
    stretches,
  },
  null,
  2,
);
console.log(text);
if (out) await writeFile(out, text + "\n");
