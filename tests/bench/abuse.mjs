// Measures how much one client, a viewer or one without a token, can take from another by each kind of request that the
// protocol allows: a bystander's frames/s and the session's real-time factor, alone and beside each abuse. Then it
// applies valid patches that are more than the machine can step, and measures what they take from another session, and
// how long undoing them and ending the server take. By hand, on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/abuse.mjs [SECONDS] [--only NAME|heavy] [--out FILE]
// The abuser is a process of its own that uses as much as it can of the same cores. Prints (and writes) JSON.
import { fork } from "node:child_process";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import { writeFile } from "node:fs/promises";
import http from "node:http";
import net from "node:net";
import { cpus } from "node:os";
import { Client, Server, sleep } from "../protocol/harness.mjs";
import { heavyPatches } from "../protocol/heavy.mjs";

const token = "operator-of-this",
  viewToken = "viewer-of-this";
const patience = 60_000; // [ms] for a heavy patch
const bearer = { authorization: `Bearer ${viewToken}` };

const asViewer = async (server, options = {}) => {
  const client = await Client.connect(server, options);
  await client.request("auth", { token: viewToken });
  return client;
};

/// Sends `frame` repeatedly, as fast as the socket takes it, and drops the answers.
function pour(socket, frame) {
  const many = Buffer.concat(Array(Math.ceil(65536 / frame.length)).fill(frame));
  socket.removeAllListeners("data");
  socket.resume();
  const more = () => {
    while (socket.writable && socket.write(many));
    if (socket.writable) socket.once("drain", more);
  };
  more();
}
const masked = (first, length = 0) =>
  Buffer.concat([Buffer.from([first, 0x80 | length, 0, 0, 0, 0]), Buffer.alloc(length)]);

/// Keeps `lanes` requests open at any time; each lane asks one after the other.
function keepAsking(lanes, ask) {
  const lane = async () => {
    for (;;) await ask().catch(() => sleep(10));
  };
  for (let i = 0; i < lanes; ++i) lane();
}
const get = (server, path, headers = bearer) => server.get(path, headers);

/// Sends requests and hangs up before the answers, at most `rate` times a second.
const askAndLeave = (server, path, rate) =>
  setInterval(() => {
    const socket = net.connect(server.port, "127.0.0.1", () => {
      socket.write(`GET ${path} HTTP/1.1\r\nhost: ${server.host}\r\nauthorization: ${bearer.authorization}\r\n\r\n`);
      setTimeout(() => socket.destroy(), 20);
    });
    socket.on("error", () => {});
  }, 1000 / rate);

/// Ten viewers each send `text` repeatedly, just within the allowed rate: 1900 messages a second if it is short.
async function chatter(server, text) {
  const rate = 1900 / Math.ceil(text.length / 256);
  for (let i = 0; i < 10; ++i) {
    const client = await asViewer(server);
    client.receive = () => {};
    let due = 0;
    setInterval(() => {
      for (due += rate / 100; due >= 1 && client.socket.bufferedAmount < 1e6; --due) client.send(text);
    }, 10);
  }
}
const call = (method, params = {}) => JSON.stringify({ jsonrpc: "2.0", id: 1, method, params });

const abuses = {
  nothing: async () => {},
  "scene.get": async (server) => chatter(server, call("scene.get")),
  "stream.subscribe": async (server) => chatter(server, call("stream.subscribe", { encoding: "f32", rate: 120 })),
  "messages of 64 kB": async (server) => chatter(server, call("ping", { t: "x".repeat(65000) })),
  "messages of 64 kB that are no JSON": async (server) => chatter(server, "[".repeat(65000)),
  "messages of 64 kB of numbers": async (server) => chatter(server, call("ping", { t: Array(16000).fill(1.5) })),
  "coming and going": async (server) =>
    keepAsking(16, async () => {
      const client = await asViewer(server);
      await client.request("stream.subscribe", { encoding: "f32", rate: 120 });
      client.socket.terminate();
    }),
  pings: async (server) => pour((await asViewer(server)).socket._socket, masked(0x89)),
  "pings, ten clients": async (server) => {
    for (let i = 0; i < 10; ++i) await abuses.pings(server);
  },
  "empty fragments": async (server) => {
    const { _socket: socket } = (await asViewer(server)).socket;
    socket.write(masked(0x01));
    pour(socket, masked(0x00));
  },
  "empty fragments, ten clients": async (server) => {
    for (let i = 0; i < 10; ++i) await abuses["empty fragments"](server);
  },
  "pictures of 4096x4096": async (server) =>
    keepAsking(16, () => get(server, "/api/snapshot.png?width=4096&height=4096")),
  "pictures of 4096x4096, not waited for": async (server) =>
    askAndLeave(server, "/api/snapshot.png?width=4096&height=4096", 50),
  meshes: async (server) => keepAsking(16, () => get(server, "/api/mesh.obj")),
  "the page, over and over": async (server) => keepAsking(16, () => get(server, "/", {})),
  "metrics, over and over": async (server) => keepAsking(16, () => get(server, "/metrics")),
  "wrong tokens, WebSocket": async (server) =>
    keepAsking(8, async () => {
      const client = await Client.connect(server);
      for (let i = 0; i < 1000 && !client.over; ++i) await client.refusal("auth", { token: `guess ${i}` });
      client.socket.terminate();
    }),
  "wrong tokens, HTTP": async (server) =>
    keepAsking(16, () => get(server, "/metrics", { authorization: "Bearer guess" })),
  "connections that say nothing": async (server) =>
    setInterval(() => {
      const socket = net.connect(server.port, "127.0.0.1");
      socket.on("error", () => {});
    }, 1),
};

/// The forked process: it runs one abuse until it is killed, or makes and undoes a heavy patch when the parent says so.
/// (This process reads that session's frames: they take seconds, in which a bystander in the same process would see
/// nothing.)
if (process.send) {
  const begin = async ({ name, server }) => {
    http.globalAgent = new http.Agent({ keepAlive: true, maxSockets: 64 });
    await abuses[name](server);
  };
  let heavy, light;
  const open = async ({ server }) => {
    heavy = await Client.connect(server, { session: "heavy" });
    // Frames are acknowledged and dropped: a page does not read a million vertices one by one, either.
    heavy.receive = (data, isBinary) => {
      if (!isBinary) Client.prototype.receive.call(heavy, data, false);
      else if (data[0] === 2) heavy.notify("stream.ack", { frame: data.readUInt32LE(8) });
    };
    ({ document: light } = await heavy.notification("scene"));
    await heavy.request("stream.subscribe", { encoding: "q16", rate: 60, in_flight: 2 });
  };
  const make = ({ name }) => heavy.request("scene.patch", { patch: heavyPatches[name] }, patience);
  const undo = () => heavy.request("scene.load", { scene: light }, patience);
  const tasks = { begin, open, make, undo };
  process.on("unhandledRejection", () => {});
  process.on("message", async ({ task, name, port }) => {
    const begun = performance.now();
    const failed = await tasks[task]({
      name,
      server: Object.assign(new Server(), { port, host: `127.0.0.1:${port}` }),
    }).then(
      () => null,
      (error) => error.message,
    );
    process.send({ failed, took_ms: round(performance.now() - begun, 0) });
  });
} else {
  const args = process.argv.slice(2);
  const option = (flag) => (args.includes(flag) ? args.splice(args.indexOf(flag), 2)[1] : null);
  const out = option("--out"),
    only = option("--only");
  const [seconds = 8] = args.map(Number);
  const chosen = (list) =>
    Object.keys(list).filter((name) => !only || name === only || (only === "heavy" && list === heavyPatches));
  const cases = [],
    heavy = [];
  for (const name of chosen(abuses)) cases.push(await measure(name, seconds));
  for (const name of chosen(heavyPatches)) heavy.push(await measureHeavy(name, seconds));
  const result = {
    benchmark: "abuse",
    machine: `${cpus()[0].model.trim()}, ${cpus().length} cores`,
    seconds,
    rate_asked: 30,
    cases,
    heavy_patches: { rate_asked: 60, cases: heavy },
  };
  console.log(JSON.stringify(result, null, 2));
  if (out) await writeFile(out, JSON.stringify(result, null, 2) + "\n");
  process.exit(0);
}

function round(value, digits = 2) {
  return Number(value.toFixed(digits));
}

/// The bystander's frames/s and real-time factor, over this many seconds.
async function watch(bystander, seconds) {
  const from = bystander.frames.length,
    begun = performance.now(),
    answers = [];
  while (performance.now() - begun < seconds * 1000) {
    const asked = performance.now();
    await bystander.request("scene.get");
    answers.push(performance.now() - asked);
    await sleep(100);
  }
  const elapsed = (performance.now() - begun) / 1000;
  const frames = bystander.frames.slice(from);
  const gaps = frames.slice(1).map((frame, i) => frame.receivedAt - frames[i].receivedAt);
  return {
    frames_per_second: round(frames.length / elapsed, 1),
    longest_gap_ms: round(Math.max(...gaps), 0),
    real_time_factor:
      frames.length > 1
        ? round((frames.at(-1).time - frames[0].time) / ((frames.at(-1).receivedAt - frames[0].receivedAt) / 1000), 3)
        : 0,
    answer_ms: {
      median: round(answers.sort((a, b) => a - b)[answers.length >> 1], 1),
      longest: round(answers.at(-1), 0),
    },
  };
}

async function measure(name, seconds) {
  const server = await Server.start("--token", token, "--view-token", viewToken, "--log-level", "error");
  const resident = () => Number(/VmHWM:\s+(\d+)/.exec(readFileSync(`/proc/${server.child.pid}/status`, "utf8"))[1]); // [kB]
  const abuser = fork(new URL(import.meta.url).pathname);
  try {
    const bystander = await asViewer(server);
    await bystander.request("stream.subscribe", { encoding: "q16", rate: 30, in_flight: 2 });
    await bystander.frame();
    const before = resident();
    await ask(abuser, { task: "begin", name, port: server.port });
    await sleep(2000);
    return {
      abuse: name,
      ...(await watch(bystander, seconds)),
      memory_grown_MB: round((resident() - before) / 1024, 0),
    };
  } catch (error) {
    return { abuse: name, failed: error.message };
  } finally {
    abuser.kill("SIGKILL");
    await server.stop("SIGKILL");
  }
}

/// Has a forked process do a task; returns the time that it took [ms].
async function ask(child, task) {
  child.send(task);
  const [{ failed, took_ms }] = await once(child, "message");
  if (failed) throw new Error(failed);
  return took_ms;
}

/// Makes the patch, undoes it, makes it again; then ends the server.
async function measureHeavy(name, seconds) {
  const server = await Server.start("--log-level", "error");
  const heavy = fork(new URL(import.meta.url).pathname);
  try {
    const bystander = await Client.connect(server);
    await bystander.request("stream.subscribe", { encoding: "q16", rate: 60, in_flight: 2 });
    await bystander.frame();
    await ask(heavy, { task: "open", port: server.port });
    const made = ask(heavy, { task: "make", name });
    const meanwhile = await watch(bystander, seconds);
    const answered_ms = await made;
    await sleep(2000);
    const undone_ms = await ask(heavy, { task: "undo" });
    await ask(heavy, { task: "make", name });
    await sleep(2000);
    const told = performance.now();
    await server.stop();
    return { patch: name, ...meanwhile, answered_ms, undone_ms, ended_ms: round(performance.now() - told, 0) };
  } catch (error) {
    await server.stop("SIGKILL");
    return { patch: name, failed: error.message };
  } finally {
    heavy.kill("SIGKILL");
  }
}
