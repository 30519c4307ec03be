// Measures how much one client, a viewer or one without a token, can take from another by each kind of request that the
// protocol allows: a bystander's frames/s and the session's real-time factor, alone and beside each abuse. Then all
// clients that one address may have do the same at once, from their first message on, and a bystander watches another
// session. Then it applies valid patches that are more than the machine can step, and measures what they take from
// another session, and how long undoing them and ending the server take. By hand, on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/abuse.mjs [SECONDS] [--only NAME|alone|bursts|heavy] [--out FILE]
// The abuser is a process of its own that uses as much as it can of the same cores. Prints (and writes) JSON.
import { fork } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { writeFile } from "node:fs/promises";
import http from "node:http";
import { cpus, tmpdir } from "node:os";
import { join } from "node:path";
import { NatsServer, noBus } from "../protocol/bus.mjs";
import { Client, Server, sleep } from "../protocol/harness.mjs";
import { heavyPatches } from "../protocol/heavy.mjs";
import { abuses, asViewer, bursts, longScene, token, viewToken } from "./abuses.mjs";

const patience = 60_000; // [ms] for a heavy patch
const tokens = ["--token", token, "--view-token", viewToken, "--log-level", "error"];

/// The forked process: it runs one abuse until it is killed, or makes and undoes a heavy patch when the parent says so.
/// (This process reads that session's frames: they take seconds, in which a bystander in the same process would see
/// nothing.)
if (process.send) {
  const start =
    (list) =>
    async ({ name, server }) => {
      http.globalAgent = new http.Agent({ keepAlive: true, maxSockets: 64 });
      await list[name](server);
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
  const tasks = { begin: start(abuses), burst: start(bursts), open, make, undo };
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
  const chosen = (list, of) => Object.keys(list).filter((name) => !only || name === only || of === only);
  const cases = [],
    crowds = [],
    heavy = [];
  for (const name of chosen(abuses, "alone")) cases.push(await measure(name, seconds));
  for (const name of chosen(bursts, "bursts")) crowds.push(await measureBurst(name, seconds));
  for (const name of chosen(heavyPatches, "heavy")) heavy.push(await measureHeavy(name, seconds));
  const result = {
    benchmark: "abuse",
    machine: `${cpus()[0].model.trim()}, ${cpus().length} cores`,
    seconds,
    rate_asked: 30,
    cases,
    bursts: { rate_asked: 60, cases: crowds },
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

/// The most memory that a server has had [kB].
function resident(server) {
  return Number(/VmHWM:\s+(\d+)/.exec(readFileSync(`/proc/${server.child.pid}/status`, "utf8"))[1]);
}

async function measure(name, seconds) {
  const server = await Server.start(...tokens);
  const abuser = fork(new URL(import.meta.url).pathname);
  try {
    const bystander = await asViewer(server);
    await bystander.request("stream.subscribe", { encoding: "q16", rate: 30, in_flight: 2 });
    await bystander.frame();
    const before = resident(server);
    await ask(abuser, { task: "begin", name, port: server.port });
    await sleep(2000);
    return {
      abuse: name,
      ...(await watch(bystander, seconds)),
      memory_grown_MB: round((resident(server) - before) / 1024, 0),
    };
  } catch (error) {
    return { abuse: name, failed: error.message };
  } finally {
    abuser.kill("SIGKILL");
    await server.stop("SIGKILL");
  }
}

/// The servers of a burst: one with the long scene, one behind a bus and a relay, or one alone. `entry` is where
/// clients connect to.
async function serversFor(name) {
  if (name.includes("relay")) {
    const bus = await NatsServer.start();
    const origin = await Server.start(...tokens, "--publish", bus.url);
    const entry = await Server.launch(
      "relay",
      "--from",
      bus.url,
      "--log-level",
      "error",
      "--max-clients-per-address",
      "64",
    );
    const stop = () => Promise.all([entry.stop("SIGKILL"), origin.stop("SIGKILL"), bus.stop()]);
    return { entry, origin, stop };
  }
  const folder = mkdtempSync(join(tmpdir(), "clothlab-abuse-"));
  const file = join(folder, "long.json");
  writeFileSync(file, JSON.stringify(longScene()));
  const entry = await Server.start(...(name.includes("/api/scene") ? [file] : []), ...tokens);
  const stop = () => entry.stop("SIGKILL").then(() => rmSync(folder, { recursive: true }));
  return { entry, origin: entry, stop };
}

/// What a crowd in the session `main` takes from one who watches another session, from its first message on.
async function measureBurst(name, seconds) {
  if (name.includes("relay") && noBus()) return { burst: name, skipped: noBus() };
  const { entry, origin, stop } = await serversFor(name);
  const abuser = fork(new URL(import.meta.url).pathname);
  try {
    const session = "watched";
    const operator = await Client.connect(origin, { session });
    await operator.request("auth", { token });
    const bystander = entry === origin ? operator : await Client.connect(entry, { session });
    if (name.includes("/api/scene")) await operator.request("scene.load", { preset: "seed" });
    await bystander.request("stream.subscribe", { encoding: "q16", rate: 60, in_flight: 2 });
    await bystander.nextFrames(60);
    const before = resident(entry);
    const begun = ask(abuser, { task: "burst", name, port: entry.port });
    const seen = await watch(bystander, seconds);
    await begun;
    return { burst: name, ...seen, memory_grown_MB: round((resident(entry) - before) / 1024, 0) };
  } catch (error) {
    return { burst: name, failed: error.message };
  } finally {
    abuser.kill("SIGKILL");
    await stop();
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
