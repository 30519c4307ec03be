// Hours of viewers that come and go: shows if the server keeps anything of those that have left. By hand, beside other
// work:
//   CLOTHLAB=build/release/clothlab node tests/bench/soak.mjs [MINUTES] [--out NAME]
// In rounds of three minutes, all from one random seed, viewers come, stall, vanish and leave; scenes are loaded and
// patched; sessions are made and given up; the lab measures; bad clients are turned away. After each round everybody
// leaves and the same four sessions show the same scene; what the server then holds (memory, file descriptors, threads)
// is compared from round to round. Prints JSON; --out writes NAME.json and NAME.svg, the plot. Exits with 1 if the
// server failed, or held more descriptors or threads in the second half than in the first.
import { readFileSync, readdirSync, mkdtempSync, rmSync } from "node:fs";
import { writeFile } from "node:fs/promises";
import net from "node:net";
import { cpus, tmpdir } from "node:os";
import { join } from "node:path";
import { Client, RpcError, Server, sleep } from "../protocol/harness.mjs";
import { strip } from "../protocol/strip.mjs";
import { soakPlot } from "./soak_plot.mjs";

const args = process.argv.slice(2);
const outAt = args.indexOf("--out");
const out = outAt < 0 ? null : args.splice(outAt, 2)[1];
const minutes = Number(args[0] ?? 120);
const busySeconds = Math.min(180, 60 * minutes),
  unwatchedSeconds = 32,
  places = 4;

let seed = 20261122;
/// mulberry32: makes each soak the same, as far as sockets allow.
function random() {
  seed = (seed + 0x6d2b79f5) | 0;
  let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
  t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
  return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
}
const pick = (list) => list[Math.floor(random() * list.length)];
const between = (low, high) => low + (high - low) * random();

const stateDir = mkdtempSync(join(tmpdir(), "clothlab-soak-"));
const server = await Server.start(
  "--max-sessions",
  String(places),
  "--state-dir",
  stateDir,
  "--header-timeout",
  "3",
  "--idle-timeout",
  "20",
);
const pid = server.child.pid;
let ended = null;
server.child.on("exit", (code, signal) => (ended = { code, signal }));

const begun = performance.now();
const counts = {};
const count = (what) => (counts[what] = (counts[what] ?? 0) + 1);
let busy = true; // false once the round ends and everybody leaves

/// A pause that ends early when the round does.
async function dwell(seconds) {
  const until = performance.now() + 1000 * seconds;
  while (busy && performance.now() < until) await sleep(Math.min(200, until - performance.now()));
}

const sessions = ["main", "a", "b", "c", "d", "e"]; // two more than the server allows

async function enter(session) {
  try {
    const client = await Client.connect(server, { session });
    client.messages.push = () => 0; // nobody reads the messages, and hours of them need much memory
    client.binary.push = () => 0;
    count("connections");
    return client;
  } catch (error) {
    if (error.status !== 503) throw error;
    count("refused");
    return null;
  }
}

/// Sends a request. Returns the answer; a refusal by the scene's state is expected, any other error is not.
async function ask(client, method, params) {
  try {
    const result = await client.request(method, params);
    count(method);
    return result;
  } catch (error) {
    if (!(error instanceof RpcError) || error.code === -32603) throw error;
    count(`${method} refused`);
    return null;
  }
}

async function viewer() {
  const client = await enter(pick(sessions));
  if (!client) return dwell(2);
  await ask(client, "stream.subscribe", { encoding: pick(["f32", "q16"]), rate: pick([10, 30, 60]), in_flight: 2 });
  // A frame is counted and dropped, not decoded.
  client.receive = (data, binary) => {
    if (!binary) return Client.prototype.receive.call(client, data, false);
    if (data[0] !== 2) return;
    count("frames");
    client.notify("stream.ack", { frame: data.readUInt32LE(8) });
  };
  const how = pick(["stays", "stays", "stalls", "vanishes"]);
  if (how === "stalls") {
    await dwell(1);
    client.socket._socket?.pause();
  }
  await dwell(between(1, 15));
  if (how !== "stays") return client.socket.terminate();
  if (random() < 0.5) await ask(client, "stream.unsubscribe", {});
  await client.close();
}

const methods = ["explicit_euler", "symplectic_euler", "verlet", "rk4", "implicit_euler", "pbd", "xpbd", "vbd", "bdf2"];
const presets = [
  "seed",
  "flag",
  "curtain",
  "tablecloth",
  "drape",
  "twist",
  "hanging-strip",
  "cantilever",
  "trampoline",
  "fabrics",
  "stack",
  "tablecloth-pull",
  "blowup",
];
const patches = [
  () => ({ solver: { method: pick(methods), dt: pick([0.0005, 0.001, 0.002]) } }),
  () => ({ gravity: [0, between(-20, 0), 0] }),
  () => ({ wind: pick([null, { velocity: [between(0, 8), 0, 0], drag: 1 }]) }),
  () => ({ self_collision: pick([null, { thickness: 0.01, friction: 0.2 }]) }),
  () => [
    {
      op: "replace",
      path: "/cloths/0/mesh",
      value: { grid: { columns: 25, rows: Math.floor(between(9, 41)), width: 1, height: 1 } },
    },
  ],
  () => [
    {
      op: "add",
      path: "/colliders/-",
      value: { sphere: { center: [between(-1, 1), 0.3, 0], radius: 0.2 }, friction: 0.3 },
    },
  ],
  () => [
    {
      op: "replace",
      path: "/cloths/0/material",
      value: { structural: between(100, 20000), shear: 1000, bend: 10, damping: 0.5 },
    },
  ],
  () => [{ op: "replace", path: "/nowhere", value: 1 }],
];

async function operator() {
  const client = await enter(pick(sessions));
  if (!client) return dwell(2);
  for (let i = Math.floor(between(3, 12)); i > 0 && busy && !client.over; --i) {
    await pick([
      () => ask(client, "scene.load", { preset: pick(presets) }),
      () => ask(client, "scene.patch", { patch: pick(patches)() }),
      () => ask(client, "scene.patch", { patch: pick(patches)() }),
      () => ask(client, "scene.get", {}),
      () =>
        ask(client, "sim.pause", {})
          .then(() => ask(client, "sim.step", { steps: 10 }))
          .then(() => ask(client, "sim.play", {})),
      () => ask(client, "sim.reset", {}),
      () => ask(client, "sim.speed", { factor: pick([0.25, 1, 2]) }),
      async () => {
        client.notify("grab.start", { cloth: 0, vertex: 12, target: [0, 1, 0] });
        await dwell(0.3);
        client.notify("grab.move", { target: [0.2, 1.2, 0] });
        await dwell(0.3);
        client.notify("grab.end", {});
      },
    ])();
    await dwell(between(0.2, 2));
  }
  if (!client.over) await client.close();
}

async function measurer() {
  const client = await enter("main");
  const ends = new Map();
  client.messages.push = ({ method, params }) => {
    if (method === "lab.result" && params.state !== "running") ends.get(params.job)?.(params.state);
  };
  if (random() < 0.8) await ask(client, "scene.load", { scene: strip() });
  const job = await ask(
    client,
    ...pick([
      ["lab.chart", { methods: ["verlet", "xpbd"], time: 0.2, budget: 8, fresh: true }],
      ["lab.stability", { methods: ["verlet"], columns: 2, fresh: true }],
      ["lab.choose", { tolerance: 0.01, time: 0.2, fresh: true }],
      ["lab.simplify", { tolerance: 0.01, time: 0.2, fresh: true }],
    ]),
  );
  if (job) {
    const end = new Promise((resolve) => ends.set(job.job, resolve));
    const left = dwell(random() < 0.3 ? between(0.5, 4) : 40).then(() => null);
    const state = await Promise.race([end, left]);
    if (state === "finished") {
      await ask(client, "lab.export", { job: job.job, format: pick(["json", "csv", "svg"]) });
    } else if (state === null && random() < 0.5) {
      await ask(client, "lab.cancel", { job: job.job });
    }
    count(`a measurement ${state ?? "left or cancelled"}`);
  }
  await client.close(); // its other requests are of no interest
}

async function nuisance() {
  await pick([
    async () => {
      const client = await enter("main");
      client.send(
        pick([
          "",
          "{",
          "[]",
          "null",
          '{"jsonrpc":"2.0","id":1}',
          "\u0000",
          '{"jsonrpc":"2.0","id":1,"method":"nothing"}',
        ]),
      );
      await dwell(0.5);
      await client.close();
    },
    async () => {
      const client = await enter("main");
      client.send("x".repeat(70_000));
      await client.closed;
    },
    async () => {
      const client = await enter("main");
      for (let i = 0; i < 6000 && !client.over; ++i) client.send('{"jsonrpc":"2.0","method":"ping","params":{"t":0}}');
      await Promise.race([client.closed, dwell(5)]);
      if (!client.over) client.socket.terminate();
    },
    () =>
      Client.connect(server, { protocols: [] }).then(
        (client) => client.socket.terminate(),
        () => count("no subprotocol, refused"),
      ),
    async () => {
      // a request that never ends
      const socket = net.connect(server.port, "127.0.0.1", () => socket.write("GET / HTTP/1.1\r\nHost: x\r\n"));
      socket.on("error", () => {});
      await new Promise((resolve) => socket.on("close", resolve));
      count("slow requests closed");
    },
    ...[
      "/",
      "/metrics",
      "/healthz",
      "/nowhere",
      "/../../etc/passwd",
      "/api/scene?session=main",
      "/api/mesh.obj?session=main",
      "/api/snapshot.png?session=main&width=320&height=200",
    ].map((path) => async () => {
      const { status } = await server.get(path);
      if (status >= 500) throw new Error(`${path} answered ${status}`);
      count("HTTP requests");
    }),
  ])();
  await dwell(between(0.2, 1.5));
}

const actors = [viewer, viewer, viewer, viewer, viewer, viewer, operator, operator, measurer, nuisance];
const troubles = [];

async function round() {
  busy = true;
  const over = sleep(1000 * busySeconds).then(() => (busy = false));
  await Promise.all(
    actors.map(async (act) => {
      while (busy && !ended)
        await act().catch((error) => {
          // A closed session, or the end of the round, may interrupt an act; the server's end may not.
          troubles.push(`${((performance.now() - begun) / 60_000).toFixed(1)} min, ${act.name}: ${error.message}`);
          return dwell(1);
        });
    }),
  );
  await over;
}

/// After everybody has left: opens the same sessions, each with the seed scene at its start.
async function rest() {
  await sleep(1000 * unwatchedSeconds);
  for (const session of ["main", ...Array.from({ length: places - 1 }, (_, i) => `rest-${i}`)]) {
    const client = await Client.connect(server, { session });
    await client.request("scene.load", { preset: "seed" });
    await client.request("sim.pause", {});
    await client.close();
  }
  await sleep(6000);
}

function held() {
  const status = readFileSync(`/proc/${pid}/status`, "utf8");
  const number = (name) => Number(new RegExp(`^${name}:\\s+(\\d+)`, "m").exec(status)[1]);
  return {
    minute: Number(((performance.now() - begun) / 60_000).toFixed(2)),
    resident_MB: Number((number("VmRSS") / 1024).toFixed(1)),
    descriptors: readdirSync(`/proc/${pid}/fd`).length,
    threads: number("Threads"),
  };
}

/// Median of the slopes between all pairs of points (Theil 1950, Sen 1968): one odd sample does not move it.
function slope(points, x, y) {
  const slopes = [];
  points.forEach((p, i) => points.slice(i + 1).forEach((q) => slopes.push((q[y] - p[y]) / (q[x] - p[x]))));
  return slopes.sort((a, b) => a - b)[slopes.length >> 1] ?? 0;
}

const samples = [],
  rests = [];
const sampler = setInterval(() => ended || samples.push(held()), 10_000);

let result;
try {
  while (!ended && (performance.now() - begun) / 60_000 < minutes) {
    await round();
    if (ended) break;
    await rest();
    rests.push(held());
    console.error(JSON.stringify({ ...rests.at(-1), troubles: troubles.length }));
    // Each round's figures are written, so that a kill loses none of them.
    if (out) await writeFile(`${out}.partial.json`, JSON.stringify({ samples, rests, counts, troubles }));
  }
  clearInterval(sampler);
  const later = rests.slice(1); // in the first round the server allocates what it did not need before
  const spread = (what) => ({
    first: rests[0]?.[what],
    least: Math.min(...later.map((r) => r[what])),
    most: Math.max(...later.map((r) => r[what])),
    last: rests.at(-1)?.[what],
  });
  result = {
    benchmark: "soak",
    machine: `${cpus()[0].model.trim()}, ${cpus().length} cores`,
    minutes: Number(((performance.now() - begun) / 60_000).toFixed(1)),
    rounds: rests.length,
    server: ended ?? {
      health: (await server.get("/healthz")).status,
      steps: await server.metric("clothlab_steps_total"),
      brought_back: await server.metric("clothlab_sessions_brought_back_total"),
      megabytes_sent: Math.round((await server.metric("clothlab_bytes_sent_total")) / 1e6),
    },
    at_rest: {
      resident_MB: spread("resident_MB"),
      resident_MB_per_hour: Number((60 * slope(later, "minute", "resident_MB")).toFixed(2)),
      descriptors: spread("descriptors"),
      threads: spread("threads"),
    },
    busy_most: Object.fromEntries(
      ["resident_MB", "descriptors", "threads"].map((what) => [what, Math.max(...samples.map((s) => s[what]))]),
    ),
    done: Object.fromEntries(Object.entries(counts).sort(([a], [b]) => (a < b ? -1 : 1))),
    troubles,
    logged: server.stderr.split("\n").reduce((events, line) => {
      const event = /level=(?:error|warning) event=(\S+)/.exec(line)?.[1];
      if (event) events[event] = (events[event] ?? 0) + 1;
      return events;
    }, {}),
    rests,
  };
} finally {
  clearInterval(sampler);
  if (!ended) await server.stop();
  rmSync(stateDir, { recursive: true, force: true });
}
const text = JSON.stringify(result, null, 2);
console.log(text);
if (out) {
  await writeFile(`${out}.json`, text + "\n");
  await writeFile(`${out}.svg`, soakPlot(samples, rests, result));
  rmSync(`${out}.partial.json`, { force: true });
}
// Some threads start late and stay, such as Mesa's writers of its shader cache, up to four per screen: so the halves
// are compared.
const half = rests.length >> 1;
const grows = (what) =>
  Math.max(...rests.slice(half).map((r) => r[what])) > Math.max(...rests.slice(0, half).map((r) => r[what]));
process.exit(ended || (half > 0 && (grows("descriptors") || grows("threads"))) ? 1 : 0);
