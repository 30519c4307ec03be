// One cloth and many viewers, through a bus and relays: what a viewer costs the server that runs the session, and what
// it costs its relay. By hand, on a quiet machine, after `apt-get install nats-server`:
//   CLOTHLAB=build/release/clothlab node tests/bench/relay.mjs [VIEWERS ...] [--relays 2] [--seconds 10] [--rate 10]
//                              [--encoding q16] [--direct 100] [--out FILE]
// A server with the seed scene publishes on nats-server; relays share the viewers, 0, 100 and 1000 if none are named.
// All run on this machine, the viewers in one process, which acknowledges each frame and reads only its header. Beside
// it as many viewers as --direct says, at the server itself, as without a bus. Prints (and writes) JSON: processor time
// of each process [cores], bytes a second that leave the server, frames a second that a viewer gets, and the server's
// real time factor.
import { readFileSync, writeFileSync } from "node:fs";
import { cpus } from "node:os";
import { parseArgs } from "node:util";
import WebSocket from "ws";
import { NatsServer, noBus } from "../protocol/bus.mjs";
import { Server, sleep } from "../protocol/harness.mjs";
import { processorSeconds } from "./processor.mjs";

const why = noBus();
if (why) throw new Error(why);
const { values, positionals } = parseArgs({
  options: {
    relays: { type: "string", default: "2" },
    seconds: { type: "string", default: "10" },
    rate: { type: "string", default: "10" },
    encoding: { type: "string", default: "q16" },
    direct: { type: "string", default: "100" },
    out: { type: "string" },
  },
  allowPositionals: true,
});
const counts = positionals.length > 0 ? positionals.map(Number) : [0, 100, 1000];
const seconds = Number(values.seconds),
  rate = Number(values.rate);
const round = (value, digits = 4) => Number(value.toFixed(digits));
const most = String(Math.max(...counts, Number(values.direct)) + 10);
const limits = ["--max-clients", most, "--max-clients-per-address", most];

const bus = await NatsServer.start();
const origin = await Server.start("--publish", bus.url, ...limits);
const relays = [];
while (relays.length < Number(values.relays)) relays.push(await Server.launch("relay", "--from", bus.url, ...limits));

class Viewer {
  frames = 0;

  static async connect(port) {
    const viewer = new Viewer();
    viewer.socket = new WebSocket(`ws://127.0.0.1:${port}/ws`, ["clothlab.v1"], { perMessageDeflate: false });
    const send = (message) => viewer.socket.send(JSON.stringify({ jsonrpc: "2.0", ...message }));
    viewer.socket.on("message", (data, binary) => {
      if (binary && data[0] === 2) {
        ++viewer.frames;
        send({ method: "stream.ack", params: { frame: data.readUInt32LE(8) } });
      } else if (!binary && data.includes('"sim.status"') && viewer.status) viewer.status(JSON.parse(data).params);
    });
    await new Promise((resolve, reject) => viewer.socket.on("open", resolve).on("error", reject));
    send({ id: 1, method: "stream.subscribe", params: { encoding: values.encoding, rate, in_flight: 2 } });
    return viewer;
  }
}

const memory = (pid) => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, "utf8"))[1]); // [kB]

async function measure(count, ports) {
  const viewers = [];
  for (let i = 0; i < count; ++i) viewers.push(await Viewer.connect(ports[i % ports.length]));
  await sleep(3000);
  const pids = [origin, bus, ...relays].map(({ child }) => child.pid);
  const sample = async () => ({
    cpu: pids.map(processorSeconds),
    bus: await origin.metric("clothlab_bus_bytes_sent_total"),
    direct: await origin.metric("clothlab_bytes_sent_total"),
    steps: await origin.metric("clothlab_steps_total"),
    frames: viewers.map(({ frames }) => frames),
    at: performance.now(),
  });
  const before = await sample();
  await sleep(1000 * seconds);
  const after = await sample();
  const elapsed = (after.at - before.at) / 1000;
  const each = after.cpu.map((used, i) => (used - before.cpu[i]) / elapsed);
  const rates = after.frames.map((frames, i) => (frames - before.frames[i]) / elapsed).sort((a, b) => a - b);
  const row = {
    viewers: count,
    through: ports.length === relays.length && ports[0] === relays[0].port ? "relays" : "the server itself",
    cores: { server: round(each[0]), bus: round(each[1]), relays: round(each.slice(2).reduce((a, b) => a + b, 0)) },
    server_bytes_per_second: {
      to_the_bus: round((after.bus - before.bus) / elapsed, 0),
      to_viewers: round((after.direct - before.direct) / elapsed, 0),
    },
    frames_per_second: count === 0 ? null : { least: round(rates[0], 2), median: round(rates[count >> 1], 2) },
    real_time_factor: round((0.001 * (after.steps - before.steps)) / elapsed, 3),
    memory_MB: {
      server: round(memory(pids[0]) / 1000, 1),
      relays: pids.slice(2).map((pid) => round(memory(pid) / 1000, 1)),
    },
  };
  console.error(JSON.stringify(row));
  for (const { socket } of viewers) socket.terminate();
  await sleep(8000); // a relay leaves a session that nobody has watched for 5 s
  return row;
}

let result;
try {
  const rows = [];
  // One viewer of the server keeps its session awake, as an operator would.
  const operator = await Viewer.connect(origin.port);
  for (const count of counts)
    rows.push(
      await measure(
        count,
        relays.map(({ port }) => port),
      ),
    );
  if (Number(values.direct) > 0) rows.push(await measure(Number(values.direct), [origin.port]));
  operator.socket.terminate();
  result = {
    benchmark: "relay",
    machine: `${cpus()[0].model.trim()}, ${cpus().length} cores`,
    relays: relays.length,
    encoding: values.encoding,
    rate_asked: rate,
    rows,
  };
} finally {
  for (const server of [...relays, origin]) await server.stop("SIGKILL");
  await bus.stop();
}
const text = JSON.stringify(result, null, 2);
console.log(text);
if (values.out) writeFileSync(values.out, `${text}\n`);
process.exit(0);
