// Sessions side by side on one server, each watched at 60 frames/s and as fast as it can: how much they compute
// together, how fairly, and how many frames they deliver. Several programs alternate, so that a noisy machine disturbs
// all alike. By hand, on a quiet machine:
//   node tests/bench/sessions.mjs [NUMBER,NUMBER...] [--seconds S] [--out FILE] PROGRAM...
//   e.g. node tests/bench/sessions.mjs 1,2,16 before/clothlab build/release/clothlab
// Prints (and writes) JSON with medians of three rounds. It waits until kernels are compiled before it measures.
import { writeFile } from "node:fs/promises";
import { cpus } from "node:os";
import { Client, Server, sleep } from "../protocol/harness.mjs";
import { processorSeconds } from "./processor.mjs";
import { median } from "../median.mjs";

const args = process.argv.slice(2);
const option = (name) => (args.includes(name) ? args.splice(args.indexOf(name), 2)[1] : null);
const out = option("--out");
const seconds = Number(option("--seconds") ?? 5);
const numbers = (/^[\d,]+$/.test(args[0] ?? "") ? args.shift() : "1,2,4,16").split(",").map(Number);
const programs = args.length > 0 ? args : [process.env.CLOTHLAB];
const rounds = 3;

const round = (value) => Number(value.toFixed(2));

/// Counts a client's frames without decoding them: decoding here would disturb the measurement.
function countFrames(client) {
  client.count = 0;
  client.receive = (data, binary) => {
    if (!binary) return Client.prototype.receive.call(client, data, false);
    if (data[0] !== 2) return;
    ++client.count;
    client.notify("stream.ack", { frame: data.readUInt32LE(8) });
  };
}

async function measure(program, number) {
  process.env.CLOTHLAB = program;
  const server = await Server.start("--scene", "seed", "--max-sessions", "32");
  try {
    const clients = [];
    for (let i = 0; i < number; ++i) {
      const client = await Client.connect(server, { session: `s${i}` });
      countFrames(client);
      await client.request("stream.subscribe", { encoding: "q16", rate: 60, in_flight: 2 });
      await client.request("sim.speed", { factor: 50 });
      clients.push(client);
    }
    await sleep(2000 + 1000 * number);
    const simulated = () =>
      clients.map((client) => client.messages.filter((m) => m.method === "sim.status").at(-1).params.time);
    const frames = () => clients.reduce((sum, client) => sum + client.count, 0);
    const before = {
      time: simulated(),
      frames: frames(),
      cpu: processorSeconds(server.child.pid),
      at: performance.now(),
    };
    await sleep(1000 * seconds);
    const elapsed = (performance.now() - before.at) / 1000;
    const factors = simulated().map((time, i) => (time - before.time[i]) / elapsed);
    const all = factors.reduce((sum, factor) => sum + factor, 0);
    return {
      real_time_factor_of_all: all,
      least_of_mean: (Math.min(...factors) * number) / all,
      frames_per_s_each: (frames() - before.frames) / elapsed / number,
      cores: (processorSeconds(server.child.pid) - before.cpu) / elapsed,
    };
  } finally {
    await server.stop();
  }
}

const measured = programs.map((program) => ({ program, rows: numbers.map((number) => ({ number, samples: [] })) }));
for (let i = 0; i < rounds; ++i)
  for (const at of numbers.keys())
    for (const { program, rows } of measured) rows[at].samples.push(await measure(program, rows[at].number));

const result = {
  what: "sessions of the seed scene on one server, each watched at 60 frames/s and as fast as it can",
  cpu: cpus()[0].model,
  cores: cpus().length,
  rounds,
  seconds,
  programs: measured.map(({ rows }, i) => ({
    program: i + 1 < programs.length ? "before" : "now",
    sessions: rows.map(({ number, samples }) => ({
      number,
      ...Object.fromEntries(Object.keys(samples[0]).map((key) => [key, round(median(samples.map((s) => s[key])))])),
      real_time_factors_of_all: samples.map((s) => round(s.real_time_factor_of_all)),
    })),
  })),
};
console.log(JSON.stringify(result, null, 1));
if (out) await writeFile(out, `${JSON.stringify(result, null, 1)}\n`);
process.exit(0);
