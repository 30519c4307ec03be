// The JavaScript client as a server serves it, against that server.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import http from "node:http";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { runProgram, Server, sleep } from "./harness.mjs";

// Below tests/, so that Node 18 and 20 find `ws`.
const folder = mkdtempSync(join(dirname(fileURLToPath(import.meta.url)), "client-"));
let server, clothlab;
before(async () => {
  server = await Server.start("--max-sessions", "100");
  const path = join(folder, "clothlab.mjs");
  writeFileSync(path, (await server.get("/clothlab.mjs")).body);
  clothlab = await import(path);
});
after(() => {
  rmSync(folder, { recursive: true });
  return server.stop();
});

async function opened(t, session) {
  const cloth = await clothlab.connect(server.host, { session });
  t.after(() => cloth.close());
  return cloth;
}

/// The error of this class that a promise ends with.
async function error(kind, promise) {
  const caught = await promise.then(
    () => null,
    (thrown) => thrown,
  );
  assert.ok(caught instanceof kind, `${kind.name} was expected, and came: ${caught}`);
  return caught;
}

test("keys of the scene are read, set together and added", async (t) => {
  const cloth = await opened(t, "keys");
  assert.deepEqual(await cloth.get("/gravity"), [0, -9.8, 0]);
  assert.equal((await cloth.get()).name, "seed");
  assert.equal(await cloth.get("/colliders/7"), undefined);
  const { revision, applies } = await cloth.set({ "/gravity/1": -1.6, "/cloths/0/pins/-": { at: "vertex:12" } });
  assert.deepEqual([revision, applies], [2, "cloth"]);
  assert.equal(await cloth.get("/gravity/1"), -1.6);
  await cloth.load("flag");
  assert.equal(await cloth.get("/name"), "flag");
  await cloth.load({ version: 1, name: "mine", cloths: [{ mesh: { grid: { columns: 3, rows: 3 } } }] });
  assert.equal(await cloth.get("/name"), "mine");
  assert.ok((await cloth.presets()).includes("seed"));
  assert.ok((await cloth.fabrics()).some(({ name }) => name === "cotton"));
  await error(clothlab.ClothlabError, cloth.get("gravity"));
});

test("a wrong value says where, what and what is allowed; any method can be called", async (t) => {
  const cloth = await opened(t, "wrong");
  const wrong = await error(clothlab.Refused, cloth.set({ "/air_drag": 0.5, "/solver/dt": -1 }));
  assert.deepEqual([wrong.code, wrong.path, wrong.found], [-32602, "/solver/dt", "-1"]);
  assert.match(wrong.allowed, /1e-09/);
  assert.equal(await cloth.get("/air_drag"), 0);
  const late = await error(clothlab.Refused, cloth.patch({ air_drag: 1 }, 99));
  assert.deepEqual([late.code, late.data.revision], [-32003, 1]);
  assert.deepEqual(await cloth.request("ping", { t: "ä" }), { t: "ä" });
  assert.equal((await error(clothlab.Refused, cloth.request("no.such"))).code, -32601);
  await error(clothlab.Timeout, cloth.wait("no.such", undefined, { timeout: 0.05 }));
  assert.ok(cloth.connected);
});

/// A WebSocket whose server says hello, then answers each request by the next of these; `sends` comes unasked.
function hostile(answers, sends = []) {
  return class {
    constructor() {
      queueMicrotask(() => {
        this.onopen();
        this.say({ method: "hello", params: { role: "operator" } });
        for (const data of sends) this.onmessage({ data });
      });
    }
    say(message) {
      this.onmessage({ data: JSON.stringify({ jsonrpc: "2.0", ...message }) });
    }
    send(text) {
      const { id } = JSON.parse(text);
      if (id !== undefined && answers.length > 0) queueMicrotask(() => this.say({ id, ...answers.shift() }));
    }
    close() {}
  };
}
const pong = { result: { t: null } };

test("what a server sends that is none of the protocol ends the connection with an error of the client's own", async () => {
  const binary = (bytes, write) => {
    const view = new DataView(new ArrayBuffer(bytes));
    write(view);
    return view.buffer;
  };
  const sends = [
    "no JSON",
    "null",
    "[]",
    '{"method": 5}',
    '{"method": "notice", "params": "text"}',
    new ArrayBuffer(0),
    binary(72, (view) => {
      view.setUint8(0, 1);
      view.setUint32(64, 5, true); // triangles
      view.setUint32(68, 0xffffffff, true); // cloths
    }),
    " ".repeat(64 * 1024 * 1024 + 1),
  ];
  for (const data of sends) {
    const refused = clothlab.connect("hostile", { WebSocket: hostile([], [data]), timeout: 20 });
    const { code } = await error(clothlab.ConnectionLost, refused);
    assert.equal(code, 1002);
  }
});

test("answers that lack what they should have say so", async () => {
  for (const [ask, result] of [
    [(cloth) => cloth.get(), null],
    [(cloth) => cloth.get("/name"), { document: 5 }],
    [(cloth) => cloth.presets(), []],
    [(cloth) => cloth.fabrics(), { fabrics: "many" }],
    [(cloth) => cloth.export(1, "csv"), {}],
    [(cloth) => cloth.chart(), { job: null }],
  ]) {
    const cloth = await clothlab.connect("hostile", { WebSocket: hostile([pong, { result }]), timeout: 20 });
    const { message } = await error(clothlab.ClothlabError, ask(cloth));
    assert.match(message, /^the answer to \S+ has no '/);
  }
  const cloth = await clothlab.connect("hostile", { WebSocket: hostile([pong, { error: "no" }]), timeout: 20 });
  assert.equal((await error(clothlab.Refused, cloth.request("ping"))).message, "no");
});

test("of an answer over HTTP that has no end no more than a few kilobytes are read where it tells an error", async (t) => {
  let sent = 0;
  const endless = http.createServer((_, response) => {
    response.writeHead(500);
    const more = () => {
      while (!response.destroyed && sent < 1 << 28 && response.write(" ".repeat(65536))) sent += 65536;
    };
    response.on("drain", more);
    more();
  });
  await new Promise((resolve) => endless.listen(0, "127.0.0.1", resolve));
  t.after(() => endless.close());
  t.after(() => endless.closeAllConnections());
  const host = `127.0.0.1:${endless.address().port}`;
  const cloth = await clothlab.connect(host, { WebSocket: hostile([pong]), timeout: 20 });
  assert.equal((await error(clothlab.ConnectionLost, cloth.mesh())).code, 500);
  assert.ok(sent < 1 << 27, `${sent} bytes were taken`);
  endless.closeAllConnections();
  endless.close();
  const { code } = await error(clothlab.ConnectionLost, cloth.picture());
  assert.equal(code, 0, "nobody answers");
});

test("a patch may ask that the cloth stays stable", async (t) => {
  const cloth = await opened(t, "stiff");
  const stiff = { "/cloths/0/material/structural": 1e5 };
  const patch = Object.entries(stiff).map(([path, value]) => ({ op: "replace", path, value }));
  assert.ok((await cloth.patch(patch, undefined, { keepStable: true })).solver.dt > 0);
});

test("a frame is that of now, in both encodings", async (t) => {
  const cloth = await opened(t, "frames");
  await cloth.pause();
  await cloth.reset();
  const moment = await cloth.step(100);
  const exact = await cloth.frame();
  assert.deepEqual([exact.step, exact.time], [moment.step, moment.time]);
  assert.deepEqual([exact.vertices, exact.triangles.length, exact.field], [625, 3 * 1152, null]);
  assert.deepEqual(exact.topology.cloths, [{ first: 0, vertices: 625 }]);
  assert.equal(exact.topology.texture.length, 2 * 625);
  const packed = await cloth.frame({ encoding: "q16", field: "strain" });
  assert.deepEqual([packed.step, packed.encoding, packed.field.length], [100, "q16", 625]);
  const far = exact.positions.map((value, i) => Math.abs(value - packed.positions[i]));
  assert.ok(Math.max(...far) < 1 / 65535, `${Math.max(...far)} m of a cloth of 1 m`);
  for (let i = 0; i < 3 * 625; i += 3) {
    const cosine = [0, 1, 2].reduce((sum, axis) => sum + exact.normals[i + axis] * packed.normals[i + axis], 0);
    assert.ok(cosine > 0.9998, `normal ${i / 3} is more than a degree off`);
  }
  const vertices = (await cloth.mesh()).match(/^v .*$/gm).map((line) => line.split(" ").slice(1).map(Number));
  vertices.flat().forEach((value, i) => assert.ok(Math.abs(value - exact.positions[i]) < 1e-5));
  assert.deepEqual(
    [...(await cloth.picture(64, 64)).subarray(1, 4)],
    [..."PNG"].map((c) => c.charCodeAt(0)),
  );
});

test("frames come in order, a slow loop sees the newest, and they stop with the loop", async (t) => {
  const cloth = await opened(t, "stream");
  const steps = [];
  let before; // the second frame
  for await (const frame of cloth.frames({ encoding: "q16" })) {
    steps.push(frame.step);
    if (steps.length === 2) break;
    ({ step: before } = await cloth.wait("sim.status", ({ step }) => step > steps[0] + 1000));
  }
  // One that had waited during the sleep would be as old as the first.
  assert.ok(steps[1] > (steps[0] + before) / 2, `${steps}, in between at ${before}`);
  let heard = 0;
  cloth._take = () => ++heard;
  await cloth.request("ping");
  await sleep(200);
  assert.equal(heard, 0, "no frame comes after the loop");
});

test("controls, hands and notifications", async (t) => {
  const cloth = await opened(t, "hands");
  await cloth.pause();
  assert.equal((await cloth.reset()).step, 0);
  assert.deepEqual(await cloth.speed(2), { factor: 2 });
  assert.equal((await cloth.play()).playing, true);
  const hand = await cloth.grab(300, [0, 1.2, 0.5]);
  await hand.move([0, 1.3, 0.5]);
  assert.deepEqual(
    (await cloth.status()).hands.map(({ vertex }) => vertex),
    [300],
  );
  await hand.release();
  await cloth.wait("sim.status", (status) => !status.hands?.length);
  assert.equal((await error(clothlab.Refused, cloth.grab(1e5, [0, 0, 0]))).path, "/vertex");
  const mesh = await cloth.uploadMesh("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  assert.equal(mesh.triangles, 1);
  await cloth.load("blowup");
  assert.equal((await error(clothlab.Refused, cloth.step(100000))).code, -32004);
  assert.equal((await cloth.frame()).diverged, true);
});

test("the lab tells its progress and its result, and can be cancelled", async (t) => {
  const cloth = await opened(t, "lab");
  await cloth.load({ version: 1, cloths: [{ mesh: { grid: { columns: 5, rows: 5 } }, pins: [{ at: "edge:row:0" }] }] });
  const told = [];
  const progress = (...of) => told.push(of);
  const { state, result, job } = await cloth.choose(0.1, { time: 0.05, methods: ["symplectic_euler"], progress });
  assert.deepEqual([state, result.chosen.method], ["finished", "symplectic_euler"]);
  assert.ok(told.length > 0 && told.every(([done, total]) => done <= total));
  assert.match(await cloth.export(job, "csv"), /symplectic_euler/);
  const control = new AbortController();
  const chart = cloth.chart({ budget: 600, signal: control.signal, progress: () => control.abort() });
  assert.equal((await chart).state, "cancelled");
  await error(clothlab.Refused, cloth.chart({ methods: ["nosuch"] }));
});

test("no server, a refusal, a closed connection, and one made anew", async () => {
  assert.match((await error(clothlab.ConnectionLost, clothlab.connect("127.0.0.1:1"))).message, /127\.0\.0\.1:1/);
  await error(clothlab.ConnectionLost, clothlab.connect(server.host, { session: "no name!" }));
  for (const wrong of ["ftp://host", "http://", "//"])
    assert.match((await error(clothlab.ClothlabError, clothlab.connect(wrong))).message, /no address of a server/);
  const cloth = await clothlab.connect(`http://${server.host}/?session=fromurl`);
  assert.equal(cloth.hello.session, "fromurl");
  const waiting = error(clothlab.ConnectionLost, cloth.wait("no.such"));
  cloth.close();
  cloth.close();
  assert.equal((await waiting).code, 1000);
  assert.equal((await error(clothlab.ConnectionLost, cloth.get())).code, 1000);
  await cloth.reconnect();
  assert.equal((await cloth.frame()).vertices, 625);
  const tooLong = await error(clothlab.ConnectionLost, cloth.request("ping", { t: "x".repeat(70000) }));
  assert.equal(tooLong.code, 1009);
  cloth.close();
});

test("the end of a server ends what waits, and another one is found", async (t) => {
  const passing = await Server.start();
  const cloth = await clothlab.connect(passing.host);
  const waiting = error(clothlab.ConnectionLost, cloth.wait("no.such"));
  await passing.stop();
  assert.equal((await waiting).code, 1001);
  await error(clothlab.ConnectionLost, cloth.reconnect());
  const found = cloth.reconnect(60);
  await sleep(1000);
  const another = await Server.start("--port", new URL(`http://${passing.host}`).port);
  t.after(() => another.stop());
  await found;
  assert.equal(await cloth.get("/name"), "seed");
  cloth.close();
});

test("tokens make operators and viewers", async (t) => {
  const guarded = await Server.start("--token", "secret", "--view-token", "public");
  t.after(() => guarded.stop());
  const join = (token) => clothlab.connect(guarded.host, { token });
  for (const token of [undefined, "wrong"]) assert.equal((await error(clothlab.Refused, join(token))).code, -32001);
  const operator = await join("secret");
  const viewer = await join("public");
  const { stdout } = await runProgram(["--version"]);
  assert.deepEqual([operator.role, viewer.role], ["operator", "viewer"]);
  assert.deepEqual([`clothlab ${operator.version}\n`, viewer.version], [stdout, operator.version]);
  await operator.set({ "/air_drag": 0.5 });
  assert.equal(await viewer.get("/air_drag"), 0.5);
  assert.equal((await viewer.frame()).positions.length, 3 * 625);
  assert.equal((await viewer.picture(64, 64))[0], 0x89);
  for (const change of [viewer.play(), viewer.patch({}), viewer.choose(0.1)])
    assert.equal((await error(clothlab.Refused, change)).code, -32001);
  operator.close();
  viewer.close();
});
