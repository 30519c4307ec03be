// server/net/asyncapi.yaml against sessions that use every method: every message, sent or received, must match it, and
// every message that it describes must occur.
import assert from "node:assert/strict";
import { after, afterEach, before, test } from "node:test";
import { document, messages, operations } from "./asyncapi.mjs";
import { Audit } from "./audit.mjs";
import { candidates, resolved } from "./candidates.mjs";
import { Client, labPatience, Server, withTimeout } from "./harness.mjs";
import { strip as stripOf } from "./strip.mjs";

const strip = stripOf(5);
/// A cloth that is almost at rest from the start.
const plumb = {
  ...strip,
  name: "plumb",
  air_drag: 5,
  cloths: [{ ...strip.cloths[0], transform: { rotate: [90, 0, 0] } }],
};

const audit = new Audit();
let server;
before(async () => {
  audit.begin();
  server = await Server.start("--max-sessions", "16", "--scene", "hanging-strip");
  await leave(await enter(null, { session: "main" }));
});
after(() => server.stop());
afterEach(() => assert.deepEqual(audit.faults.splice(0).slice(0, 5), []));

let sessions = 0;
async function enter(scene, { session = `said-${++sessions}`, at = server } = {}) {
  const client = await Client.connect(at, { session });
  await client.notification("scene");
  if (scene) await client.request("scene.load", { scene });
  return client;
}
/// Leaves without a cloth that goes on stepping and keeps the lab waiting.
async function leave(client) {
  await client.request("sim.pause");
  await client.close();
}
const answerTo = (client, id) =>
  client.until(
    () => client.messages,
    (message) => message.id === id,
    `the answer to ${id}`,
  );
const there = operations.filter(({ action }) => action === "receive");
const paramsOf = (name) => resolved(messages[name].payload.properties.params);

test("the document's methods are those that hello names", async () => {
  const client = await enter();
  const { requests } = await client.notification("hello");
  assert.deepEqual(there.map(({ name }) => name).sort(), [...requests].sort());
  assert.deepEqual([...document.components.schemas.requests.items.enum].sort(), [...requests].sort());
  await leave(client);
});

test("the limits that hello tells are the document's", async () => {
  const client = await enter();
  const { limits, encodings, methods } = await client.notification("hello");
  const range = (name, parameter) =>
    (({ minimum, maximum }) => [minimum, maximum])(resolved(paramsOf(name).properties[parameter]));
  assert.equal(range("stream.subscribe", "rate")[1], limits.rate);
  assert.equal(range("stream.subscribe", "in_flight")[1], limits.in_flight);
  assert.equal(range("sim.step", "steps")[1], limits.steps);
  assert.deepEqual(range("sim.speed", "factor"), limits.speed);
  assert.deepEqual(range("record.start", "rate"), limits.recording.rate);
  assert.deepEqual(range("lab.chart", "time"), limits.lab.time);
  assert.deepEqual(range("lab.chart", "budget"), limits.lab.budget);
  assert.deepEqual(range("lab.compare", "time"), limits.lab.time);
  assert.deepEqual(range("lab.compare", "rate"), limits.lab.comparison.rate);
  assert.deepEqual(paramsOf("stream.subscribe").properties.encoding.enum, encodings);
  assert.deepEqual([...resolved(resolved(paramsOf("lab.chart").properties.methods).items).enum, "auto"], methods);
  await leave(client);
});

// A request's error names its first fault. So if a valid parameter stands before an unknown one, the error shows that
// the parameter was accepted, and the request has no effect.
test("the server takes each parameter up to the limits that the document gives, and refuses it beyond", async (t) => {
  const client = await enter();
  let taken = 0,
    refused = 0;
  for (const { name } of there) {
    const { properties = {}, required = [] } = paramsOf(name) ?? {};
    const least = Object.fromEntries(
      required.map((parameter) => [parameter, candidates(properties[parameter]).good[0]]),
    );
    const pathFor = async (params) => {
      const { code, data } = await client.refusal(name, { ...least, ...params, surplus: 1 });
      assert.equal(code, -32602, `${name} ${JSON.stringify(params)}`);
      return data.path;
    };
    // Sets of parameters, of which a message has one, are tried one by one below.
    if (!paramsOf(name)?.oneOf) assert.equal(await pathFor({}), "/surplus", name);
    for (const [parameter, schema] of Object.entries(properties)) {
      if (parameter === "scene") continue; // tests/schema/scene.test.mjs tests it
      const { good, bad } = candidates(schema);
      for (const value of good)
        assert.equal(
          await pathFor({ [parameter]: value }),
          "/surplus",
          `${name} ${parameter} ${JSON.stringify(value)}`,
        );
      for (const value of bad)
        assert.equal(
          await pathFor({ [parameter]: value }),
          `/${parameter}`,
          `${name} ${parameter} ${JSON.stringify(value)}`,
        );
      taken += good.length;
      refused += bad.length;
    }
    for (const parameter of required)
      assert.equal(await pathFor({ [parameter]: undefined }), `/${parameter}`, `${name} without ${parameter}`);
  }
  t.diagnostic(`${taken} taken, ${refused} refused`);
  await leave(client);
});

test("where what moves is, is told as it says, before a frame", async () => {
  const client = await enter();
  await client.request("scene.load", { preset: "curtain" });
  await client.request("stream.subscribe", {});
  await client.nextNotification("colliders");
  await client.frame();
  const { document } = await client.request("scene.get", {});
  const mesh = { obj: "presets/torso.obj" };
  const spin = { axis: [0, 1, 0], center: [0, 0, 0], degrees_per_second: 10 };
  const body = { mesh, transform: { translate: [9, 9, 9] }, motion: { spin } };
  await client.request("scene.patch", { patch: { colliders: [...document.colliders, body] } });
  await client.nextNotification("colliders", ({ moving }) => moving.some(({ transform }) => transform));
  const vertices = [
    [-9, 1, -9],
    [9, 1.1, -9],
    [0, 1.2, 9],
  ];
  const there = { mesh: { vertices, triangles: [[0, 1, 2]] } };
  assert.ok((await client.refusal("scene.patch", { patch: { colliders: [there] } })).data.crossings);
  await leave(client);
});

test("requests and their answers are as it says, with and without parameters, for every kind of id", async () => {
  const client = await enter(strip);
  const { revision } = await client.request("scene.get", {});
  const asked = [
    ["ping"],
    ["ping", { t: [1, { deep: null }] }],
    ["scene.get"],
    ["scene.presets", {}],
    ["sim.pause"],
    ["sim.play"],
    ["sim.pause", {}],
    ["sim.step"],
    ["sim.step", { steps: 3 }],
    ["sim.reset"],
    ["sim.speed", { factor: 0.5 }],
    ["auth", { token: "any" }],
    ["scene.patch", { patch: {} }],
    ["scene.patch", { patch: { gravity: [0, -1, 0] }, revision: revision + 1 }],
    ["scene.patch", { patch: { self_collision: {} } }],
    ["scene.patch", { patch: [{ op: "replace", path: "/cloths/0/mesh/grid/rows", value: 6 }] }],
    ["scene.patch", { patch: { solver: { method: "pbd" } } }],
    ["scene.patch", { patch: { gravity: [0, -2, 0] }, name: "lighter" }],
    ["scene.patch", { patch: { solver: { method: "verlet", dt: 0.5 } }, keep_stable: true }],
    ["scene.undo"],
    ["scene.redo", {}],
    ["scene.load", { preset: "curtain" }],
    ["scene.undo", { revision: revision + 10 }],
    ["scene.load", { scene: strip }],
    ["stream.subscribe"],
    ["stream.ack", { frame: 0 }],
    ["stream.unsubscribe"],
    ["stream.subscribe", { encoding: "c16", field: "speed" }],
    ["stream.subscribe", { encoding: "f32", rate: 120, in_flight: 8 }],
    ["grab.start", { cloth: 0, vertex: 4, target: [0, 1, 0] }],
    ["grab.start", { cloth: 0, vertex: 5, target: [0, 1, 0], hand: 9 }],
    ["grab.move", { target: [0.1, 1, 0] }],
    ["grab.move", { target: [0.1, 1, 0], hand: 9 }],
    ["grab.end"],
    ["grab.end", { hand: 9 }],
    ["inspect.springs"],
    ["inspect.springs", { first: 3 }],
    ["inspect.elements"],
    ["inspect.vertices"],
    ["inspect.vertices", { cloth: 0, first: 3 }],
    ["inspect.contacts"],
    ["inspect.contacts", { most: 0 }],
    ["timeline.get"],
    ["timeline.resume", { step: 0 }],
    ["timeline.resume", { undo: true }],
    ["lab.jobs"],
    ["record.get"],
    ["record.start", { rate: 60 }],
    ["record.stop"],
    ["record.get"],
    ["mesh.upload", { name: "leaf", obj: "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" }],
  ];
  for (const [method, params] of asked) await client.request(method, params);
  await client.frame((frame) => frame.encoding === 0);
  await client.request("grab.start", { cloth: 0, vertex: 4, target: [0, 1, 0] });
  await client.nextNotification("sim.status", ({ hands }) => hands.length === 1);
  await client.request("grab.end");
  for (const id of ["a", "", null, 0.5, -3]) {
    client.send(JSON.stringify({ jsonrpc: "2.0", id, method: "ping", params: { t: id } }));
    assert.deepEqual((await answerTo(client, id)).result, { t: id });
  }
  assert.equal((await client.refusal("scene.patch", { patch: {}, revision })).code, -32003);
  assert.equal((await client.refusal("scene.undo", { revision })).code, -32003);
  assert.equal((await client.refusal("scene.redo")).code, -32005);
  assert.equal((await client.refusal("grab.start", { cloth: 1, vertex: 0, target: [0, 0, 0] })).data.path, "/cloth");
  assert.equal((await client.refusal("grab.move", { target: [0, 0, 0] })).data.path, "/hand");
  assert.equal((await client.refusal("scene.load", { preset: "no-such" })).code, -32602);
  assert.equal((await client.refusal("scene.load", { scene: { ...strip, gravity: 5 } })).data.path, "/gravity");
  assert.equal((await client.refusal("scene.load", { scene: strip, preset: "seed" })).code, -32602);
  assert.equal((await client.refusal("scene.patch", { patch: { gravity: "down" } })).code, -32602);
  await leave(client);
});

test("a message that is no request is answered as the document says", async () => {
  const client = await enter();
  const cases = [
    ["{", -32700],
    ["[".repeat(50), -32700],
    ["[]", -32600],
    ["5", -32600],
    ['{"id":1}', -32600],
    [Buffer.from("{}"), -32600],
    ['{"jsonrpc":"2.0","id":null,"method":"ping","params":[1]}', -32602],
  ];
  for (const [text, code] of cases) {
    const from = client.messages.length;
    client.send(text);
    const { error } = await client.until(
      () => client.messages.slice(from),
      (message) => message.error,
      `an error for ${text}`,
    );
    assert.equal(error.code, code, String(text));
  }
  assert.equal((await client.refusal("no.such")).code, -32601);
  await leave(client);
});

test("a second viewer, edits and their notices are told as it says", async () => {
  const client = await enter(strip);
  const other = await enter(null, { session: `said-${sessions}` });
  await client.notification("viewers", ({ count }) => count === 2);
  const [mine, theirs] = [client, other].map((each) => each.nextNotification("scene.changed"));
  const notice = other.nextNotification("notice");
  const patch = { cloths: [{ ...strip.cloths[0], mesh: { grid: { columns: 4, rows: 4 } } }] };
  assert.equal((await client.request("scene.patch", { patch })).applies, "cloth");
  assert.deepEqual(await mine, await theirs);
  await notice;
  const status = client.nextNotification("sim.status", ({ solver }) => solver.pbd_stiffness);
  await other.request("scene.patch", { patch: { solver: { method: "pbd" } } });
  await status;
  await other.close();
  await client.notification("viewers", ({ count }) => count === 1);
  await leave(client);
});

test("a blow-up, its remedy and a cloth at rest are told as it says", async () => {
  const client = await enter();
  await client.request("stream.subscribe", {});
  for (const method of ["symplectic_euler", "explicit_euler"]) {
    await client.request("sim.pause"); // otherwise it would blow up before anybody listens
    await client.request("scene.load", { preset: "blowup" });
    const {
      document: {
        cloths: [cloth],
      },
    } = await client.request("scene.get");
    if (method === "explicit_euler")
      // here the remedy is another method
      await client.request("scene.patch", {
        patch: { solver: { method }, cloths: [{ ...cloth, material: { ...cloth.material, damping: 0 } }] },
      });
    const told = client.nextNotification("sim.diverged");
    await client.request("sim.play");
    const { remedy } = await told;
    await client.frame((frame) => frame.flags & 2);
    await client.nextNotification("sim.status", ({ diverged }) => diverged);
    for (const moves of ["sim.play", "sim.step"]) assert.equal((await client.refusal(moves)).code, -32004);
    assert.equal("method" in remedy.patch.solver, method === "explicit_euler");
    await client.request("scene.patch", { patch: remedy.patch });
    await client.nextNotification("sim.status", ({ diverged }) => !diverged);
  }
  await client.request("scene.load", { scene: plumb });
  await client.nextNotification("sim.status", ({ asleep }) => asleep);
  await client.frame((frame) => frame.flags & 1);
  await leave(client);
});

test("the five jobs of the lab, cancelled, failed, waiting and exported, tell of themselves as it says", async () => {
  const client = await enter(strip);
  const quick = { time: 0.05, pause: true };
  const jobs = [
    [
      "lab.chart",
      { ...quick, methods: ["verlet", "xpbd", "implicit_euler"], iterations: [1, 2], budget: 3, fresh: true },
    ],
    ["lab.stability", { methods: ["verlet", "vbd"], columns: 2, from: 1, to: 4 }],
    ["lab.choose", { ...quick, tolerance: 0.1, methods: ["verlet", "xpbd"] }],
    ["lab.simplify", { ...quick, tolerance: 0.1 }],
    ["lab.compare", { ...quick, patch: { solver: { dt: 0.0004 } }, rate: 60, truth: false, fresh: false }],
  ];
  for (const [method, params] of jobs) {
    const { job } = await client.request(method, params);
    const { state, kind, result, error } = await client.labResult(job);
    assert.equal(state, "finished", `${method}: ${JSON.stringify(error)}`);
    assert.equal(`lab.${kind}`, method);
    assert.equal(result.kind, kind);
    for (const format of method === "lab.compare" ? ["json", "csv"] : ["json", "csv", "svg"]) {
      const { text } = await client.request("lab.export", { job, format, axis: "energy" });
      if (format === "json") assert.deepEqual(JSON.parse(text), result);
    }
  }
  const { jobs: own } = await client.request("lab.jobs");
  assert.equal((await client.request("lab.moments", { job: own.at(-1).job, from: 1 })).from, 1);
  const { cached, job: known } = await client.request(...jobs[2]);
  assert.equal(cached, true);
  await client.labResult(known);
  const { job: failing } = await client.request("lab.stability", { field: "/no/such" });
  const { state, error } = await client.labResult(failing);
  assert.equal(state, "failed");
  assert.ok(error.path && error.found && error.allowed);

  const long = { methods: ["rk4"], time: 20, budget: 600, fresh: true };
  const waiting = [];
  for (let i = 0; i < 3; ++i) {
    waiting.push((await client.request("lab.chart", long)).job);
    if (i === 0)
      await client.notification("lab.progress", ({ job, state }) => job === waiting[0] && state === "running");
  }
  assert.equal((await client.refusal("lab.chart", long)).code, -32002);
  assert.equal((await client.request("lab.jobs")).jobs.length, jobs.length + 2 + waiting.length);
  assert.equal((await client.refusal("lab.export", { job: waiting[2], format: "csv" })).code, -32602);
  for (const job of waiting) assert.equal((await client.request("lab.cancel", { job })).cancelled, true);
  for (const job of waiting) assert.equal((await client.labResult(job)).state, "cancelled");
  assert.equal((await client.request("lab.cancel", { job: waiting[0] })).cancelled, false);
  await leave(client);
});

test("the method auto tells what it measures, what it chose, and why where it cannot, as it says", async () => {
  const automatic = { ...strip, solver: { method: "auto", tolerance: 0.05 } };
  const client = await enter(automatic);
  const auto = (state) => client.notification("sim.status", ({ solver }) => solver.auto?.state === state, labPatience);
  await auto("measuring");
  await auto("chosen");
  await leave(client);
});

test("with a token, who may do what is as it says, and why connections are closed", async (t) => {
  const guarded = await Server.start("--token", "secret", "--view-token", "look", "--max-sessions", "2");
  t.after(() => guarded.child.kill());
  const [viewer, stranger, owner] = await Promise.all([1, 2, 3].map(() => Client.connect(guarded)));
  assert.equal((await viewer.request("auth", { token: "look" })).role, "viewer");
  assert.equal((await owner.request("auth", { token: "secret" })).role, "operator");
  await viewer.notification("hello");
  const forbidden = [];
  for (const { name } of there.filter(({ name }) => name !== "auth")) {
    const { required = [], properties } = paramsOf(name) ?? {};
    const params = Object.fromEntries(
      required.map((parameter) => [parameter, candidates(properties[parameter]).good[0]]),
    );
    if (name === "scene.load") params.preset = "seed";
    assert.equal((await stranger.refusal(name, params)).code, -32001, name);
    await viewer.request(name, params).catch(({ code }) => {
      assert.equal(code, -32001, name);
      forbidden.push(name);
    });
  }
  assert.deepEqual(
    forbidden,
    there.filter((asked) => asked["x-role"] === "operator").map(({ name }) => name),
  );
  assert.equal((await stranger.refusal("auth", { token: "wrong" })).code, -32001);
  const crowd = await Promise.all(["a", "b"].map((session) => Client.connect(guarded, { session })));
  await crowd[0].request("auth", { token: "secret" });
  assert.equal((await crowd[1].refusal("auth", { token: "secret" })).code, -32002);
  owner.send(" ".repeat(70_000));
  assert.equal((await withTimeout(owner.closed, "the close")).code, 1009);
  assert.equal((await withTimeout(stranger.closed, "the close")).code, 1008);
  await guarded.stop();
  assert.equal((await viewer.closed).code, 1001);
});

test("a request that the server cannot serve is refused as the document says", async () => {
  process.env.CLOTHLAB_FAULT = "change-fails::1";
  const poor = await Server.start().finally(() => delete process.env.CLOTHLAB_FAULT);
  const client = await enter(null, { session: "main", at: poor });
  await client.notification("sim.status", ({ step }) => step > 1);
  assert.equal((await client.refusal("scene.patch", { patch: { gravity: [0, -1, 0] } })).code, -32603);
  await client.close();
  await poor.stop();
});

test("a change that is undone while it is built is given up", async () => {
  const client = await Client.connect(server, { session: "large" });
  const side = { columns: 500, rows: 500, width: 1, height: 1 }; // more than a second of building, less than 2 GB
  const large = { cloths: [{ mesh: { grid: side } }], self_collision: { kind: "surface", thickness: 0.0004 } };
  const given = client.refusal("scene.patch", { patch: large, name: "large" });
  const { name, applies } = await client.request("scene.undo");
  assert.deepEqual([name, applies, (await given).code], ["large", "none", -32006]);
  await client.close();
});

test("a session's name is what the document takes for one", async () => {
  const { pattern } = document.channels.session.bindings.ws.query.properties.session;
  for (const session of ["a", "A-z_0", "x".repeat(64), "x".repeat(65), "a.b", "a b", "a/b", "é", "%00"]) {
    const asked = Client.connect(server, { session: encodeURIComponent(session) });
    if (new RegExp(pattern).test(session)) await (await asked).close();
    else await assert.rejects(asked, ({ status }) => status === 400, session);
  }
});

test("everything that the document describes has been seen", async () => {
  assert.deepEqual(
    Object.keys(messages).filter((name) => !audit.seen.has(name)),
    [],
  );
  for (const code of [1001, 1008, 1009]) assert.ok(audit.closeCodes.has(code), `closed with ${code}`);
});
