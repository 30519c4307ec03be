// record.*: what happens in a session is recorded, bounded, and fetched over HTTP.
import assert from "node:assert/strict";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import { connect } from "node:net";
import { after, before, beforeEach, test } from "node:test";
import { inflateRawSync } from "node:zlib";
import { readGlb, readUsda } from "../cli/film_files.mjs";
import { load } from "../page/module.mjs";
import { Client, Server, sleep } from "./harness.mjs";
import { seamed } from "./seamed.mjs";

const inflate = async (bytes) => new Uint8Array(inflateRawSync(bytes));
let page, server;
before(async () => {
  page = await load("player/recording");
  server = await Server.start("--max-sessions", "20", "--max-clients-per-address", "64"); // 128 connections
});
after(() => server.stop());

let count = 0,
  session,
  client;
beforeEach(async () => {
  session = `record${++count}`;
  client = await Client.connect(server, { session });
  await client.notification("scene");
});

const get = (path, { from = server, ...options } = {}) => fetch(`http://${from.host}${path}`, options);
async function read(bytes) {
  const recording = await page.Reader.open(new Uint8Array(bytes).buffer, inflate);
  const moments = [];
  for (const group of recording.groups) moments.push(...(await page.readGroup(group, inflate)));
  return { recording, moments };
}
/// The JSON of the chunks of this kind.
function chunks(bytes, kind) {
  const buffer = Buffer.from(bytes);
  const found = [];
  for (let at = 16; at < buffer.length; at += 12 + buffer.readUInt32LE(at + 4))
    if (buffer.toString("latin1", at, at + 4) === kind)
      found.push(JSON.parse(inflateRawSync(buffer.subarray(at + 12, at + 12 + buffer.readUInt32LE(at + 4)))));
  return found;
}

/// Waits until the recording has this many frames, however slow the machine is; returns how many.
async function recorded(frames, by = client) {
  for (;;) {
    const now = await by.request("record.get");
    if (now.frames >= frames) return now.frames;
    await sleep(20);
  }
}
/// Waits until it has this many more than now.
const recordedMore = async (frames, by = client) => recorded((await recorded(0, by)) + frames, by);

test("what plays is recorded at the rate, and what changes the scene with its step and who did", async () => {
  const id = (await client.notification("hello")).client;
  const startedAt = performance.now();
  const started = await client.request("record.start", { rate: 20 });
  assert.deepEqual(started, {
    state: "recording",
    scene: "seed",
    rate: 20,
    frames: 0,
    bytes: started.bytes,
    full: false,
    times: null,
  });
  await recordedMore(30);
  await client.request("scene.patch", { patch: { gravity: [0, -1, 0] } });
  await recordedMore(5);
  const stopped = await client.request("record.stop");
  const seconds = (performance.now() - startedAt) / 1000;
  assert.equal(stopped.state, "ready");
  const { files, ...told } = await client.request("record.get");
  assert.deepEqual(told, stopped);
  assert.deepEqual(files, {
    clothlab: `/api/recording.clothlab?session=${session}`,
    html: `/api/recording.html?session=${session}`,
    glb: `/api/recording.glb?session=${session}`,
    usda: `/api/recording.usda?session=${session}`,
  });
  const answer = await get(files.clothlab);
  assert.equal(answer.status, 200);
  assert.match(
    answer.headers.get("content-disposition"),
    /^attachment; filename="seed \d+\.\d\d-\d+\.\d\d s\.clothlab"$/,
  );
  const bytes = await answer.arrayBuffer();
  assert.equal(bytes.byteLength, stopped.bytes);
  const { recording, moments } = await read(bytes);
  assert.equal(recording.name, "seed");
  assert.equal(recording.rate, 20);
  assert.equal(moments.length, stopped.frames);
  // One at the start, one where the scene changes, and 20 a second.
  assert.ok(moments.length >= 35 && moments.length <= 20 * seconds + 2, `${moments.length} frames in ${seconds} s`);
  for (let i = 1; i < moments.length; ++i) assert.ok(moments[i].step >= moments[i - 1].step);
  const edits = chunks(bytes, "edit");
  assert.equal(edits.length, 1);
  assert.deepEqual(edits[0].patch, { gravity: [0, -1, 0] });
  assert.equal(edits[0].by, id);
  assert.ok(edits[0].step > 0);
  const documents = recording.groups.map(({ setting }) => setting.document.gravity[1]);
  assert.deepEqual([documents[0], documents.at(-1)], [-9.8, -1]);
  const changed = recording.groups.find(({ setting }) => setting.document.gravity[1] === -1);
  assert.ok(moments[changed.first].step >= edits[0].step);
  await client.close();
});

test("it tells which vertex in frames each vertex of a mesh's file is, where numbers differ", async () => {
  const sheet = seamed(5);
  await client.request("sim.pause");
  await client.request("mesh.upload", { name: "sheet.obj", obj: sheet.obj });
  const cloths = [
    { name: "grid", mesh: { grid: { columns: 2, rows: 2 } } },
    { name: "sheet", mesh: { file: "sheet.obj" } },
  ];
  await client.request("scene.load", { scene: { version: 1, name: "numbered", cloths } });
  await client.request("record.start");
  await recorded(1);
  await client.request("record.stop");
  const { recording } = await read(await (await get(`/api/recording.clothlab?session=${session}`)).arrayBuffer());
  const { topology } = recording.groups.at(-1).setting;
  assert.deepEqual(
    topology.cloths.map(({ numbers }) => numbers),
    ["same", Uint32Array.from(sheet.inFrames, (vertex) => (vertex === 0xffffffff ? vertex : 4 + vertex))],
  );
  await client.close();
});

test("its frames are those that viewers get: a step by hand is recorded with its positions", async () => {
  await client.request("sim.pause");
  await client.request("sim.reset");
  await client.request("record.start");
  await client.request("stream.subscribe", { encoding: "f32" });
  for (let i = 0; i < 3; ++i) {
    const { step } = await client.request("sim.step", { steps: 100 });
    await client.frame((frame) => frame.step === step);
    await recorded(i + 2);
  }
  await client.request("record.stop");
  const { moments } = await read(await (await get(`/api/recording.clothlab?session=${session}`)).arrayBuffer());
  const at = (step) => moments.find((moment) => moment.step === step);
  const steps = moments.map(({ step }) => step);
  for (const step of [0, 100, 200, 300]) assert.ok(steps.includes(step), `${step} of ${steps}`);
  const shown = client.frames.find(({ step }) => step === 300);
  const { low, quantum, numbers, time } = at(300);
  assert.ok(Math.abs(time - 0.3) < 1e-9);
  for (const [i, position] of shown.positions.entries())
    for (const axis of [0, 1, 2])
      assert.ok(Math.abs(low[axis] + quantum * numbers[3 * i + axis] - position[axis]) < 0.51 * quantum);
  await client.close();
});

test("another mesh, another scene and a reset go on in the same recording", async () => {
  await client.request("record.start", { rate: 60 });
  const wait = () => recordedMore(5);
  await wait();
  await client.request("scene.patch", { patch: [{ op: "replace", path: "/cloths/0/mesh/grid/rows", value: 30 }] });
  await wait();
  const body = { name: "torso", mesh: { obj: "presets/torso.obj" }, transform: { translate: [0, -3, 0] } };
  const cloth = { mesh: { grid: { columns: 8, rows: 8, width: 1, height: 1 } } };
  await client.request("scene.load", { scene: { version: 1, name: "above", cloths: [cloth], colliders: [body] } });
  await wait();
  await client.request("sim.reset");
  await wait();
  await client.request("record.stop");
  const bytes = await (await get(`/api/recording.clothlab?session=${session}`)).arrayBuffer();
  const { recording } = await read(bytes);
  const vertices = [...new Set(recording.groups.map(({ setting }) => setting.topology.vertexCount))];
  assert.deepEqual(vertices, [625, 750, 64]);
  const last = recording.groups.at(-1).setting.document;
  assert.equal(last.name, "above");
  assert.ok(last.colliders[0].mesh.vertices.length > 100, "with the triangles of its body");
  assert.deepEqual(
    chunks(bytes, "edit").map((edit) => Object.keys(edit).find((key) => ["patch", "document", "reset"].includes(key))),
    ["patch", "document", "reset"],
  );
  await client.close();
});

test("a paused session adds no frames, and a second recording takes the first one's place", async () => {
  await client.request("record.start");
  await client.request("sim.pause");
  await recorded(1);
  await client.statuses(4); // the frame of the last step is on its way
  const { frames } = await client.request("record.get");
  await client.statuses(5);
  assert.equal((await client.request("record.get")).frames, frames);
  await client.request("record.stop");
  assert.equal((await client.request("record.get")).state, "ready");
  await client.request("record.start");
  const now = await client.request("record.get");
  assert.deepEqual([now.state, now.files], ["recording", null]);
  assert.equal((await get(`/api/recording.clothlab?session=${session}`)).status, 404);
  await client.request("record.stop");
  await client.close();
});

test("a second start, a stop without a start and a rate beyond the limits are refused with what to do", async () => {
  const stop = await client.refusal("record.stop");
  assert.equal(stop.code, -32602);
  assert.match(JSON.stringify(stop), /record\.start/);
  for (const rate of [0, 0.5, 61, "fast"])
    assert.equal((await client.refusal("record.start", { rate })).data.path, "/rate");
  await client.request("record.start");
  const again = await client.refusal("record.start");
  assert.equal(again.code, -32002);
  assert.match(again.message, /record\.stop/);
  for (const name of ["clothlab", "html"]) {
    const answer = await get(`/api/recording.${name}?session=${session}`);
    assert.equal(answer.status, 404);
    assert.match(await answer.text(), /record\.stop/);
  }
  await client.close();
  const answer = await get("/api/recording.html?session=main");
  assert.ok([404].includes(answer.status));
});

test("a recording ends by itself beyond --max-recording-bytes, says so, and is kept", async () => {
  const small = await Server.start("--max-recording-bytes", "60000");
  const other = await Client.connect(small);
  const { limits } = await other.notification("hello");
  assert.deepEqual(limits.recording, { bytes: 60000, rate: [1, 60] });
  await other.notification("scene");
  await other.request("record.start", { rate: 60 });
  await other.notification("notice", ({ text }) => /--max-recording-bytes/.test(text));
  const { state, full, bytes, frames } = await other.request("record.get");
  assert.deepEqual([state, full], ["ready", true]);
  assert.ok(bytes > 60000 && bytes < 260000, `${bytes}`);
  assert.equal((await other.refusal("record.stop")).code, -32602);
  const { moments } = await read(await (await get("/api/recording.clothlab", { from: small })).arrayBuffer());
  assert.equal(moments.length, frames);
  await other.request("record.start"); // and the next one may begin
  await other.close();
  await small.stop();
});

test("with a token: viewers may fetch and ask, not start or stop; without it nobody may fetch", async () => {
  const guarded = await Server.start("--token", "secret", "--view-token", "look");
  const operator = await Client.connect(guarded);
  await operator.request("auth", { token: "secret" });
  await operator.notification("scene");
  const viewer = await Client.connect(guarded);
  await viewer.request("auth", { token: "look" });
  for (const method of ["record.start", "record.stop"]) assert.equal((await viewer.refusal(method)).code, -32001);
  await operator.request("record.start");
  await recorded(3, operator);
  await operator.request("record.stop");
  const { files } = await viewer.request("record.get");
  for (const path of Object.values(files)) {
    assert.equal((await get(path, { from: guarded })).status, 401);
    const headers = { authorization: "Bearer look" };
    assert.equal((await get(path, { from: guarded, headers })).status, 200);
  }
  await operator.close();
  await viewer.close();
  await guarded.stop();
});

test("the films of a recording have its frames, and what cannot be a film says why", async () => {
  await client.request("record.start");
  await recordedMore(10);
  await client.request("record.stop");
  const { moments } = await read(await (await get(`/api/recording.clothlab?session=${session}`)).arrayBuffer());
  const answer = await get(`/api/recording.glb?session=${session}`);
  assert.equal(answer.status, 200);
  assert.equal(answer.headers.get("content-type"), "model/gltf-binary");
  assert.match(answer.headers.get("content-disposition"), /^attachment; filename="seed \d+\.\d\d-\d+\.\d\d s\.glb"$/);
  const glb = readGlb(Buffer.from(await answer.arrayBuffer()));
  assert.equal(glb.array(glb.json.animations[0].samplers[0].input).length, moments.length);
  const usda = await (await get(`/api/recording.usda?session=${session}`)).text();
  assert.equal(readUsda(usda).prims[0].name, "seed");
  await client.request("record.start");
  await recordedMore(3);
  await client.request("scene.load", { preset: "hanging-strip" });
  await recordedMore(6);
  await client.request("record.stop");
  const refused = await get(`/api/recording.glb?session=${session}`);
  assert.equal(refused.status, 409);
  assert.match(await refused.text(), /mesh changes .* s after its first frame/);
});

test("the page of a recording has the same recording in it", async () => {
  await client.request("record.start");
  await recorded(10);
  await client.request("record.stop");
  const html = await get(`/api/recording.html?session=${session}`);
  assert.equal(html.status, 200);
  assert.match(html.headers.get("content-type"), /^text\/html/);
  assert.match(html.headers.get("content-disposition"), /^attachment; filename="seed \d+\.\d\d-\d+\.\d\d s\.html"$/);
  const inside = Buffer.from(/id="recording">([A-Za-z0-9+/=]*)</.exec(await html.text())[1], "base64");
  const alone = Buffer.from(await (await get(`/api/recording.clothlab?session=${session}`)).arrayBuffer());
  assert.ok(inside.equals(alone));
  await client.close();
});

/// Asks for `path` on a connection of its own, and reads nothing but the beginning of the answer.
async function stalled(path, { from = server } = {}) {
  const socket = connect({ host: "127.0.0.1", port: from.port });
  socket.on("error", () => {});
  socket.write(`GET ${path} HTTP/1.1\r\nHost: ${from.host}\r\n\r\n`);
  await once(socket, "readable");
  const [head] = /^[^]*?\r\n\r\n/.exec(socket.read().toString("latin1"));
  return { socket, head };
}
const residentBytes = ({ child }) =>
  1024 * Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${child.pid}/status`, "utf8"))[1]);
/// A cloth that starts at random places.
const incompressible = {
  version: 1,
  gravity: [0, 0, 0],
  cloths: [{ mesh: { grid: { columns: 128, rows: 128 } }, start: { scatter: { size: 1 } } }],
  solver: { method: "xpbd", dt: 0.005, iterations: 2 },
};

test("sixty who download and read nothing share one copy of a recording, of its page too, and the next one gets it whole", async () => {
  await client.request("scene.load", { scene: incompressible });
  await client.request("record.start", { rate: 60 });
  await recorded(30);
  await client.request("record.stop");
  const { bytes, files } = await client.request("record.get");
  assert.ok(bytes > 1_500_000, `${bytes}`);
  for (const [path, share] of [
    [files.html, 4 / 3], // in base64
    [files.clothlab, 1],
  ]) {
    const first = await stalled(path); // which has the page made
    const before = residentBytes(server);
    const others = await Promise.all(Array.from({ length: 59 }, () => stalled(path)));
    const grown = residentBytes(server) - before;
    for (const { head } of [first, ...others]) assert.match(head, /^HTTP\/1.1 200/);
    // Each has a piece of 64 KiB; a third of the copies is less than memory that was free already hides.
    assert.ok(grown < (59 * share * bytes) / 3, `${path}: ${grown} bytes for 59 more of ${share * bytes}`);
    const whole = await (await get(path)).arrayBuffer();
    assert.ok(whole.byteLength >= share * bytes);
    for (const { socket } of [first, ...others]) socket.destroy();
  }
  await client.close();
});
