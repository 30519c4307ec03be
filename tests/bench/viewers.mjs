// Many viewers of one session, some stalled, one slow: what each receives, what the simulation loses, and how much
// memory a viewer costs. By hand, on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/viewers.mjs [VIEWERS] [SECONDS] [--out FILE]
// Every tenth viewer reads nothing after its first frame. One more reads 64 kB/s; the age of its frames is the
// difference in simulated time to a viewer that keeps up, at real time. Prints (and writes) JSON.
import { readFileSync } from "node:fs";
import { writeFile } from "node:fs/promises";
import { cpus } from "node:os";
import { Client, Server, sleep } from "../protocol/harness.mjs";

const args = process.argv.slice(2);
const outAt = args.indexOf("--out");
const out = outAt < 0 ? null : args.splice(outAt, 2)[1];
const [viewers = 100, seconds = 20] = args.map(Number);
const rate = 30,
  slowRate = 64_000;
const round = (value, digits = 2) => Number(value.toFixed(digits));

const server = await Server.start(
  "--max-clients",
  String(viewers + 10),
  "--max-clients-per-address",
  String(viewers + 10),
);
const resident = () => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${server.child.pid}/status`, "utf8"))[1]); // [kB]

/// Counts frames without decoding them: decoding here would disturb the measurement.
// biome-ignore lint/complexity/noStaticOnlyClass: it has fields, which `connect` gives it
class Viewer {
  static async connect() {
    const viewer = new Viewer();
    const client = (viewer.client = await Client.connect(server));
    viewer.frames = 0;
    viewer.time = 0;
    client.receive = (data, binary) => {
      if (!binary) return Client.prototype.receive.call(client, data, false);
      if (data[0] !== 2) return;
      ++viewer.frames;
      viewer.time = data.readDoubleLE(16);
      viewer.onFrame?.(viewer.time);
      if (!viewer.stalled) client.notify("stream.ack", { frame: data.readUInt32LE(8) });
    };
    await client.request("stream.subscribe", { encoding: "q16", rate, in_flight: 2 });
    client.messages.length = 0;
    return viewer;
  }
}

/// Lets a socket deliver at most this many bytes a second.
function throttle(socket, bytesPerSecond) {
  let allowed = 0;
  const read = socket.read.bind(socket);
  socket.pause();
  const timer = setInterval(() => {
    allowed = Math.min(allowed + bytesPerSecond / 100, bytesPerSecond / 20);
    const chunk = socket.readableLength > allowed ? read(Math.floor(allowed)) : read();
    if (chunk) allowed -= chunk.length;
  }, 10);
  return () => clearInterval(timer);
}

let result;
try {
  const first = await Viewer.connect();
  await sleep(3000);
  const before = resident();
  const all = [first];
  while (all.length < viewers) all.push(await Viewer.connect());
  const slow = await Viewer.connect();
  await sleep(2000);
  for (let i = 9; i < all.length; i += 10) {
    all[i].stalled = true;
    all[i].client.socket._socket.pause();
  }
  const ages = [];
  const stop = throttle(slow.client.socket._socket, slowRate);
  await sleep(3000);
  slow.onFrame = (time) => ages.push(1000 * (first.time - time));
  const counts = all.map((viewer) => viewer.frames),
    slowBefore = slow.frames;
  const simulated = first.time,
    begun = performance.now();
  await sleep(seconds * 1000);
  const elapsed = (performance.now() - begun) / 1000;
  const rates = all
    .map((viewer, i) => (viewer.frames - counts[i]) / elapsed)
    .filter((_, i) => !all[i].stalled)
    .sort((a, b) => a - b);
  ages.sort((a, b) => a - b);
  result = {
    benchmark: "viewers",
    machine: `${cpus()[0].model.trim()}, ${cpus().length} cores`,
    viewers,
    stalled: all.filter(({ stalled }) => stalled).length,
    rate_asked: rate,
    frames_per_second_of_the_others: { least: round(rates[0]), median: round(rates[rates.length >> 1]) },
    real_time_factor: round((first.time - simulated) / elapsed, 3),
    slow_viewer: {
      bytes_per_second: slowRate,
      frames_per_second: round((slow.frames - slowBefore) / elapsed),
      frame_age_ms: {
        median: round(ages[ages.length >> 1] ?? NaN, 0),
        p95: round(ages[Math.floor(0.95 * ages.length)] ?? NaN, 0),
        longest: round(ages.at(-1) ?? NaN, 0),
      },
    },
    server_memory_kB_a_viewer: round((resident() - before) / viewers, 0),
  };
  stop();
} finally {
  await server.stop("SIGKILL");
}
const text = JSON.stringify(result, null, 2);
console.log(text);
if (out) await writeFile(out, text + "\n");
process.exit(0);
