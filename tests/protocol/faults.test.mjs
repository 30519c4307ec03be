// Faults of one session: it reports them and goes on if it can, and the other sessions are not affected.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { cpSync, existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { after, test } from "node:test";
import { thorough } from "../thorough.mjs";
import { Client, runProgram, Server, sleep } from "./harness.mjs";
import { strip } from "./strip.mjs";

const root = fileURLToPath(new URL("../../", import.meta.url));
const folders = [];
after(() => folders.forEach((folder) => rmSync(folder, { recursive: true, force: true })));

function folder() {
  folders.push(mkdtempSync(join(tmpdir(), "clothlab-faults-")));
  return folders.at(-1);
}

/// Starts a server that meets a fault, or that keeps its data elsewhere.
async function startWith(environment, ...args) {
  const before = { ...process.env };
  Object.assign(process.env, environment);
  try {
    return await Server.start(...args);
  } finally {
    for (const name of Object.keys(environment)) {
      if (name in before) process.env[name] = before[name];
      else delete process.env[name];
    }
  }
}

async function watch(server, session) {
  const client = await Client.connect(server, { session });
  await client.request("stream.subscribe", { encoding: "q16" });
  return client;
}

/// What a session was told, but for how fast the machine is: tests run beside others.
const notices = (client) =>
  client.messages.filter(({ method, params }) => method === "notice" && !/cannot keep up/.test(params.text));

for (const [kind, why] of [
  ["exception", /a fault on purpose/],
  ["no-memory", /not enough memory/],
  ["context-lost", /the device was reset/],
])
  test(`a session whose thread ends by ${kind} goes on with its viewers, at most a second back; others never notice`, async () => {
    const server = await startWith({ CLOTHLAB_FAULT: `${kind}:hurt:2000` });
    const [hurt, other] = [await watch(server, "hurt"), await watch(server, "other")];
    await hurt.request("scene.patch", { patch: { name: "patched" } });
    const { text } = await hurt.notification("notice", ({ text }) => !/cannot keep up/.test(text));
    assert.match(text, why);
    assert.match(text, /goes on from where it was/);
    const failed = hurt.binary.findLast((message) => message.kind === 2);
    assert.ok(failed.time > 1.5, `it met the fault at ${failed.time} s`);
    const next = await hurt.nextFrame((frame) => frame.sequence > failed.sequence);
    assert.ok(next.time > failed.time - 1, `back from ${failed.time} s to ${next.time} s`);
    assert.equal((await hurt.request("scene.get")).document.name, "patched");
    await hurt.nextFrame((frame) => frame.time > failed.time + 0.5);
    const frames = other.binary.filter((message) => message.kind === 2);
    assert.ok(
      frames.every((frame, i) => i === 0 || frame.time >= frames[i - 1].time),
      "the other session's time only rises",
    );
    assert.deepEqual(notices(other), []);
    assert.equal(await server.metric("clothlab_sessions_brought_back_total"), 1);
    assert.equal((await server.get("/healthz")).status, 200);
    await server.stop();
  });

test("the steps of a session that failed stay counted", async () => {
  const server = await startWith({ CLOTHLAB_FAULT: "exception:hurt:2000" });
  const hurt = await watch(server, "hurt");
  const steps = [];
  for (let back = 0; back < 3; ) {
    // reads twice more once the session is back
    steps.push(await server.metric("clothlab_steps_total"));
    back += await server.metric("clothlab_sessions_brought_back_total");
    await sleep(20);
  }
  assert.deepEqual(
    steps,
    [...steps].sort((a, b) => a - b),
  );
  await hurt.close();
  await server.stop();
});

test("a request that a session fails to answer is answered all the same, with -32603", async () => {
  const server = await startWith({ CLOTHLAB_FAULT: "exception:main:500" });
  const client = await watch(server);
  const error = await client.refusal("sim.step", { steps: 100_000 });
  assert.equal(error.code, -32603);
  assert.match(error.message, /a fault on purpose/);
  assert.ok((await client.request("sim.step", { steps: 2 })).step > 0);
  await server.stop();
});

test("a change for which there is not enough memory is refused, and the scene goes on as it was", async () => {
  const server = await startWith({ CLOTHLAB_FAULT: "change-fails::1" });
  const client = await watch(server);
  const { time } = await client.frame((frame) => frame.step > 1);
  const error = await client.refusal("scene.patch", { patch: { gravity: [0, -1, 0] } });
  assert.equal(error.code, -32603);
  assert.match(error.message, /not enough memory.*smaller scene/);
  assert.deepEqual((await client.request("scene.get")).document.gravity, [0, -9.8, 0]);
  await client.nextFrame((frame) => frame.time > time);
  await client.request("scene.patch", { patch: { gravity: [0, -1, 0] } });
  await server.stop();
});

test("a shader that does not compile refuses the change that needs it, with file and line, until it is mended", async () => {
  const data = folder();
  for (const part of ["shaders", "server/scene/presets", "web/dist"])
    cpSync(join(root, part), join(data, part), { recursive: true });
  const server = await startWith({ CLOTHLAB_DATA: data });
  const client = await watch(server);
  const { time } = await client.frame();
  const shader = join(data, "shaders/methods/rk4.comp");
  const sound = readFileSync(shader, "utf8");
  writeFileSync(shader, sound.replace("void main()", "void main() { no_such_thing(); }\nvoid unused()"));
  const error = await client.refusal("scene.patch", { patch: { solver: { method: "rk4" } } });
  assert.match(error.message, /rk4\.comp/);
  assert.match(error.message, /no_such_thing/);
  await client.nextFrame((frame) => frame.time > time);
  assert.equal((await client.request("scene.get")).document.solver.method, "symplectic_euler");
  writeFileSync(shader, sound);
  await client.request("scene.patch", { patch: { solver: { method: "rk4" } } });
  await server.stop();
});

/// Mounts a file system of 256 KiB; null if none can be mounted.
function tinyDisk() {
  const where = folder();
  if (spawnSync("mount", ["-t", "tmpfs", "-o", "size=256k", "tmpfs", where]).status !== 0) return null;
  return { where, remove: () => spawnSync("umount", ["-l", where]) };
}

test("a full disk: the session says that it cannot be saved, goes on, and is saved again when there is room", async (context) => {
  const disk = tinyDisk();
  if (!disk) return context.skip("no tmpfs can be mounted here: it needs root");
  try {
    const server = await Server.start("--state-dir", disk.where);
    const client = await watch(server);
    await client.frame((frame) => frame.time > 0.2);
    const ballast = join(disk.where, "ballast");
    for (let size = 256; size > 0; size -= 4)
      try {
        writeFileSync(ballast, Buffer.alloc(size * 1024));
        break;
      } catch {
        /* a little less */
      }
    const { text } = await client.nextNotification("notice", ({ level }) => level === "error");
    assert.match(text, /cannot be saved: .*No space left on device.*goes on/);
    const { time } = await client.nextFrame();
    await client.nextFrame((frame) => frame.time > time + 1.5);
    assert.equal(notices(client).length, 1, "told once");
    const mesh = "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n".padEnd(20_000, "#");
    const unkept = client.nextNotification("notice", ({ text }) => /the mesh mine cannot be saved/.test(text));
    await client.request("mesh.upload", { name: "mine", obj: mesh });
    await unkept;
    const kept = () => readdirSync(disk.where).some((name) => /^main\.mesh-[0-9a-f]{16}$/.test(name));
    assert.equal(kept(), false);
    await client.request("sim.pause"); // so that nothing changes any more
    // With room for the session alone, the session is saved.
    writeFileSync(ballast, Buffer.alloc(184 * 1024));
    const { revision } = await client.request("scene.patch", { patch: { name: "small" } });
    const large = client.nextNotification("notice", ({ text }) => /the mesh large cannot be saved/.test(text));
    await client.request("mesh.upload", { name: "large", obj: mesh.padEnd(60_000, "#") });
    await large;
    const session = () => readFileSync(join(disk.where, "main.session")).toString("latin1");
    await client.until(
      () => [session()],
      (text) => text.includes(`"name":"small"`) && text.includes(`"revision":${revision}`),
      "the session without its mesh",
    );
    rmSync(ballast);
    await client.until(
      () => [server.stderr],
      (text) => text.includes("event=session_saved_again"),
      "the session to be saved",
    );
    assert.ok(kept(), "the mesh, too");
    await server.stop();
  } finally {
    disk.remove();
  }
});

test("a full disk: an export of the command line ends with an error that names the file, and exit code 1", async (context) => {
  const disk = tinyDisk();
  if (!disk) return context.skip("no tmpfs can be mounted here: it needs root");
  try {
    for (const name of ["cloth.obj", "cloth.ply", "cloth.pc2"]) {
      const { code, stderr } = await runProgram([
        "run",
        "seed",
        "--time",
        "0.004",
        "--every",
        "0.001",
        "--set",
        "/cloths/0/mesh/grid/columns=200",
        "--set",
        "/cloths/0/mesh/grid/rows=100",
        "--set",
        "/cloths/0/pins=[]",
        "--out",
        join(disk.where, name),
      ]);
      assert.equal(code, 1, `${name}: ${stderr}`);
      assert.match(stderr, /cloth[-\d]*\.(obj|ply|pc2).*could not be written.*disk/);
    }
  } finally {
    disk.remove();
  }
});

test("a process that is stopped for two seconds, as by a sleeping machine, does not leap through the time it missed", async () => {
  const server = await Server.start();
  const client = await watch(server);
  const { time } = await client.frame((frame) => frame.time > 0.3);
  server.child.kill("SIGSTOP");
  await sleep(2000);
  server.child.kill("SIGCONT");
  const seen = client.binary.length;
  await client.nextFrame((frame) => frame.time > time + 0.3);
  const frames = client.binary.slice(seen - 1).filter((message) => message.kind === 2);
  // Time jumps by at most the lag of a frame or two, not by the seconds that were missed.
  for (let i = 1; i < frames.length; ++i)
    assert.ok(frames[i].time - frames[i - 1].time < 0.5, `from ${frames[i - 1].time} to ${frames[i].time} s`);
  await server.stop();
});

// Built with the tests, except with sanitizers (tests/CMakeLists.txt).
const jumpingClock = join(dirname(process.env.CLOTHLAB), "tests/libjumping_clock.so");

test("a clock that jumps an hour ahead and two back: nobody is sent away, time goes on, and the session is kept", async (context) => {
  if (!existsSync(jumpingClock)) return context.skip("the library that makes the clock jump was not built");
  const state = folder();
  const server = await startWith(
    { LD_PRELOAD: jumpingClock },
    "--state-dir",
    state,
    "--idle-timeout",
    "4",
    "--log-level",
    "debug",
  );
  const client = await watch(server);
  const { job } = await client.request("lab.chart", { methods: ["verlet"], time: 0.2, budget: 20, fresh: true });
  const { time } = await client.frame();
  await client.frame((frame) => frame.time > time + 4.5);
  const late = await Client.connect(server); // writes a line to the log after the last jump
  await late.close();
  await client.until(
    () => [server.stderr],
    (text) => hours(text).has(-1),
    "the log to show that the clock has jumped",
  );
  const frames = client.frames;
  for (let i = 1; i < frames.length; ++i)
    assert.ok(
      frames[i].time > frames[i - 1].time && frames[i].time - frames[i - 1].time < 0.5,
      `from ${frames[i - 1].time} to ${frames[i].time} s`,
    );
  assert.deepEqual(
    notices(client).filter(({ params }) => !/cannot keep up|of its speed/.test(params.text)),
    [],
  );
  const { state: end } = await client.labResult(job);
  assert.equal(end, "finished");
  assert.equal((await server.get("/healthz")).status, 200);
  await server.stop("SIGKILL");
  const again = await Server.start("--state-dir", state);
  const back = await watch(again);
  assert.ok((await back.frame()).time > time + 3, "what it kept is from after the jumps");
  await again.stop();
});

/// Whole hours by which the times of log lines differ from the first line's.
function hours(log) {
  const times = [...log.matchAll(/^time=(\S+)/gm)].map(([, text]) => Date.parse(text));
  return new Set(times.map((time) => Math.round((time - times[0]) / 3_600_000)));
}

const chart = { methods: ["verlet", "symplectic_euler"], time: 0.2, budget: 5, fresh: true };
const measured = async (client, params = chart) => client.labResult((await client.request("lab.chart", params)).job);

// The last of what may happen is the one after which most has to be made anew.
for (const [kind, why] of [
  ["exception", /a fault on purpose/],
  ["no-memory", /not enough memory/],
  ["context-lost", /the device was reset/],
].slice(thorough ? 0 : -1))
  test(`a measurement of the lab that meets ${kind} fails and says why; the next one is whole, and the session never notices`, async () => {
    const server = await startWith({ CLOTHLAB_FAULT: `${kind}:/lab:0` });
    const client = await watch(server);
    await client.request("scene.load", { scene: strip() });
    const failed = await measured(client);
    assert.equal(failed.state, "failed");
    assert.match(JSON.stringify(failed), why);
    const next = await measured(client);
    assert.equal(next.state, "finished");
    assert.equal(next.result.complete, true);
    assert.deepEqual(
      notices(client).filter(({ params }) => !/cannot keep up|of its speed/.test(params.text)),
      [],
    );
    const { time } = await client.nextFrame();
    await client.nextFrame((frame) => frame.time > time);
    assert.equal(await server.metric("clothlab_sessions_brought_back_total"), 0);
    await server.stop();
  });

for (const [kind, why] of [
  ["exception", /a fault on purpose/],
  ["no-memory", /not enough memory/],
  ["context-lost", /the device was reset/],
])
  test(`a picture that meets ${kind} is answered with 500 and why; the next one is drawn, and the session never notices`, async () => {
    const server = await startWith({ CLOTHLAB_FAULT: `${kind}:/export:0` });
    const client = await watch(server);
    const failed = await server.get("/api/snapshot.png?width=64&height=48");
    assert.equal(failed.status, 500);
    assert.match(failed.body.toString(), why);
    assert.equal((await server.get("/api/snapshot.png?width=64&height=48")).status, 200);
    const { time } = await client.nextFrame();
    await client.nextFrame((frame) => frame.time > time);
    assert.deepEqual(
      notices(client).filter(({ params }) => !/cannot keep up|of its speed/.test(params.text)),
      [],
    );
    await server.stop();
  });
