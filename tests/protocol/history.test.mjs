// Undo and redo of every change of a session's scene, by anybody in it.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Client, Server, sleep } from "./harness.mjs";
import { strip } from "./strip.mjs";

let server;
before(async () => (server = await Server.start("--max-sessions", "16", "--scene", "hanging-strip")));
after(() => server.stop());

let sessions = 0;
/// Clients of a session of their own, with an empty history.
async function enter(count = 1, scene = strip(5)) {
  const session = `history-${++sessions}`;
  const clients = [];
  for (let i = 0; i < count; ++i) {
    const client = await Client.connect(server, { session });
    await client.notification("scene.history");
    client.number = (await client.notification("hello")).client;
    clients.push(client);
  }
  await clients[0].request("sim.pause");
  if (scene) await clients[0].request("scene.load", { scene });
  return clients;
}
const documentOf = async (client) => (await client.request("scene.get")).document;
const leave = (clients) => Promise.all(clients.map((client) => client.close()));
const gravity = (y) => ({ gravity: [0, y, 0] });
/// What the client was told of the history last.
async function told(client) {
  await client.request("scene.get"); // it is told after the answer to the change
  return client.messages.findLast(({ method }) => method === "scene.history").params;
}

test("what one client changes, another undoes and redoes, and a script that listens sees every document", async () => {
  const [a, b, script] = await enter(3);
  const { document: first } = await a.request("scene.get");
  const heard = script.nextNotification("scene.history", ({ undo }) => undo === "Gravity");
  const { revision } = await a.request("scene.patch", { patch: gravity(-5) });
  assert.deepEqual(await heard, {
    undo: "Gravity",
    undo_by: a.number,
    redo: null,
    redo_by: null,
    undos: 2,
    redos: 0,
    last: { what: "change", name: "Gravity", by: a.number },
  });
  const changed = script.nextNotification("scene.changed");
  const undone = script.nextNotification("scene.history");
  assert.deepEqual(await b.request("scene.undo", { revision }), {
    revision: revision + 1,
    name: "Gravity",
    applies: "uniform",
  });
  const { patch, by } = await changed;
  assert.deepEqual(
    { patch, by },
    { patch: [{ op: "replace", path: "/gravity/1", value: first.gravity[1] }], by: b.number },
  );
  const after = await undone;
  assert.deepEqual([after.undo, after.redo, after.redo_by], ["Load strip", "Gravity", a.number]);
  assert.deepEqual(after.last, { what: "undo", name: "Gravity", by: b.number });
  assert.deepEqual(await documentOf(a), first);
  assert.equal((await a.request("scene.redo")).revision, revision + 2);
  assert.equal((await documentOf(b)).gravity[1], -5);
  await leave([a, b, script]);
});

test("who joins is told of the history after the scene", async () => {
  const [a] = await enter();
  await a.request("scene.patch", { patch: gravity(-3) });
  await a.notification("scene.history", ({ undo }) => undo === "Gravity"); // it comes after the answer
  const late = await Client.connect(server, { session: `history-${sessions}` });
  assert.equal((await late.notification("scene.history")).undo, "Gravity");
  const order = late.messages.map(({ method }) => method).filter((method) => /^(hello|scene)/.test(method));
  assert.deepEqual(order.slice(0, 3), ["hello", "scene", "scene.history"]);
  await leave([a, late]);
});

test("changes have names: of what they touch, of pins, of things that come and go, or the one they are given", async () => {
  const [a] = await enter();
  const ball = { name: "ball", sphere: { center: [0, -9, 0], radius: 0.25 } };
  const operate = (op, path, value) => [{ op, path, value }];
  for (const [patch, name, given] of [
    [{ colliders: [ball] }, "Add ball"],
    [operate("replace", "/colliders/0/sphere/radius", 0.3), "ball: radius"],
    [operate("replace", "/colliders/0/friction", 0.4), "ball: friction"],
    [operate("remove", "/colliders/0"), "Remove ball"],
    [operate("replace", "/solver/dt", 0.0005), "Time step"],
    [{ solver: { method: "verlet", dt: 0.0004 } }, "Time step, Method"],
    [{ gravity: [0, -1, 0], air_drag: 1, solver: { dt: 0.0003 } }, "Air drag and 2 more"],
    [operate("add", "/cloths/0/pins/-", { at: "vertex:7", place: [0, 0, 0] }), "Pin a vertex"],
    [operate("remove", "/cloths/0/pins/0"), "Take a pin off"],
    [{ wind: { velocity: [1, 0, 0] } }, "Wind"],
    [{ wind: { gust: 0.5 } }, "Wind: gust"],
    [{ self_collision: { thickness: 0.01 } }, "Self-collision"],
    [operate("replace", "/cloths/0/material/structural", 100), `${strip(5).cloths[0].name ?? "cloth"}: structural`],
    [gravity(-7), "the moon, almost", "the moon, almost"],
  ]) {
    await a.request("scene.patch", given ? { patch, name: given } : { patch });
    assert.equal((await told(a)).undo, name, JSON.stringify(patch));
  }
  const long = await a.refusal("scene.patch", { patch: gravity(-2), name: "x".repeat(81) });
  assert.deepEqual([long.code, long.data.path], [-32602, "/name"]);
  assert.equal((await a.refusal("scene.patch", { patch: gravity(-2), name: "a\nb" })).data.path, "/name");
  await leave([a]);
});

test("every change is undone to the same document, back to the first, and made again to the last", async () => {
  const [a] = await enter();
  const documents = [await documentOf(a)];
  const patches = [
    { colliders: [{ name: "floor", plane: { point: [0, -9, 0], normal: [0, 1, 0] } }] },
    { solver: { method: "xpbd", dt: 0.002 } },
    [{ op: "add", path: "/cloths/0/pins/-", value: { at: "vertex:7" } }],
    [{ op: "remove", path: "/cloths/0/pins/0" }],
    { wind: { velocity: [1, 0, 0] } },
    { wind: null },
    [{ op: "replace", path: "/cloths/0/material", value: { model: "springs", fabric: "cotton" } }],
    [{ op: "replace", path: "/cloths/0/mesh/grid/rows", value: 7 }],
    { name: "last" },
  ];
  for (const patch of patches) {
    await a.request("scene.patch", { patch });
    documents.push(await documentOf(a));
  }
  for (const document of documents.slice(0, -1).reverse()) {
    await a.request("scene.undo");
    assert.deepEqual(await documentOf(a), document);
  }
  for (const document of documents.slice(1)) {
    await a.request("scene.redo");
    assert.deepEqual(await documentOf(a), document);
  }
  assert.equal((await a.refusal("scene.redo")).code, -32005);
  await leave([a]);
});

test("a loaded scene is undone as a whole, and the cloth starts at its beginning", async () => {
  const [a, b] = await enter(2);
  const first = await documentOf(a);
  await a.request("scene.load", { preset: "cantilever" });
  await a.request("sim.step", { steps: 5 });
  const scene = b.nextNotification("scene");
  const { name, applies } = await b.request("scene.undo");
  assert.deepEqual([name, applies], ["Load cantilever", "cloth"]);
  assert.deepEqual((await scene).document, first);
  await b.nextNotification("sim.status", ({ step }) => step === 0);
  await b.request("scene.redo");
  assert.equal((await documentOf(b)).name, "cantilever");
  await leave([a, b]);
});

test("a slider that one client drags is one change; a pause, another client or another place begins a new one", async () => {
  const [a, b] = await enter(2);
  const start = (await documentOf(a)).gravity[1];
  const drag = async (client, from) => {
    for (let i = 0; i < 5; ++i) await client.request("scene.patch", { patch: gravity(from - i / 8) });
  };
  await drag(a, -1);
  assert.equal((await told(a)).undos, 2); // after the load
  await drag(b, -2);
  assert.equal((await told(b)).undos, 3);
  await a.request("scene.patch", { patch: { air_drag: 0.5 } });
  await sleep(1200);
  await a.request("scene.patch", { patch: { air_drag: 0.6 } });
  assert.equal((await told(a)).undos, 5);
  for (const expected of [-2.5, -2.5, -1.5, start]) {
    await b.request("scene.undo");
    assert.equal((await documentOf(b)).gravity[1], expected);
  }
  await b.request("scene.redo");
  assert.equal((await documentOf(b)).gravity[1], -1.5);
  // back where the drag began: nothing has changed
  const { undos } = await told(b);
  await a.request("scene.patch", { patch: { air_drag: 0.5 } });
  await a.request("scene.patch", { patch: { air_drag: 0 } });
  assert.equal((await told(a)).undos, undos);
  await leave([a, b]);
});

test("a change after an undo drops what could be redone, and one that changes nothing drops nothing", async () => {
  const [a] = await enter();
  await a.request("scene.patch", { patch: gravity(-5) });
  await a.request("scene.undo");
  await a.request("scene.patch", { patch: {} });
  assert.equal((await told(a)).redo, "Gravity");
  await a.request("scene.patch", { patch: { air_drag: 1 } });
  const { redo, redos } = await told(a);
  assert.deepEqual([redo, redos], [null, 0]);
  assert.equal((await a.refusal("scene.redo")).code, -32005);
  await leave([a]);
});

test("with nothing to undo the answer says so, and another revision is refused", async () => {
  const [a] = await enter(1, null);
  const { code, message } = await a.refusal("scene.undo");
  assert.equal(code, -32005);
  assert.match(message, /nothing to undo/);
  const { revision } = await a.request("scene.patch", { patch: gravity(-5) });
  const conflict = await a.refusal("scene.undo", { revision: revision - 1 });
  assert.deepEqual([conflict.code, conflict.data.revision], [-32003, revision]);
  assert.equal((await documentOf(a)).gravity[1], -5);
  await leave([a]);
});

test("the oldest changes are forgotten beyond the limit that hello tells", async () => {
  const [a] = await enter();
  const { changes } = (await a.notification("hello")).limits.history;
  for (let i = 0; i < changes + 3; ++i)
    await a.request("scene.patch", { patch: i % 2 ? { air_drag: 1 + i } : gravity(-1 - i / 100) });
  assert.equal((await told(a)).undos, changes);
  for (let i = 0; i < changes; ++i) await a.request("scene.undo");
  assert.equal((await a.refusal("scene.undo")).code, -32005);
  await leave([a]);
});

test("a mesh that replaced one of the scene is undone; one that is forgotten is told, and nothing is lost", async () => {
  const mesh = (size) => `v 0 0 0\nv ${size} 0 0\nv 0 ${size} 0\nf 1 2 3\n`;
  const [a] = await enter();
  await a.request("mesh.upload", { name: "leaf", obj: mesh(1) });
  const cloth = { ...strip(5).cloths[0], mesh: { obj: "leaf" }, pins: [] };
  await a.request("scene.patch", { patch: { cloths: [cloth] } });
  const shows = async (size, what) => {
    const seen = a.frames.at(-1)?.sequence ?? 0;
    await what?.();
    await a.frame(({ sequence, boxExtent }) => sequence > seen && Math.abs(boxExtent[0] - size) < 1e-3);
  };
  await shows(1, () => a.request("stream.subscribe", { encoding: "f32" }));
  await shows(2, () => a.request("mesh.upload", { name: "leaf", obj: mesh(2) }));
  assert.equal((await told(a)).undo, "Replace mesh leaf");
  await shows(1, () => a.request("scene.undo"));
  await shows(2, () => a.request("scene.redo"));
  // the scene without it lets the mesh be forgotten
  await a.request("scene.load", { scene: strip(5) });
  const { count } = (await a.notification("hello")).limits.meshes;
  for (let i = 0; i < count; ++i) await a.request("mesh.upload", { name: `other-${i}`, obj: mesh(1) });
  const before = await documentOf(a);
  const refused = await a.refusal("scene.undo");
  assert.deepEqual([refused.code, refused.data.path], [-32602, "/cloths/0/mesh/obj"]);
  assert.match(refused.message, /cannot undo Load strip: .*leaf/);
  assert.deepEqual(await documentOf(a), before);
  await a.request("mesh.upload", { name: "leaf", obj: mesh(2) });
  await a.request("scene.undo");
  assert.equal((await documentOf(a)).cloths[0].mesh.obj, "leaf");
  await leave([a]);
});

test("the remedy of a blow-up can be undone like any other change, and the undo of its cause lets the cloth go on", async () => {
  const [a] = await enter();
  await a.request("sim.play");
  const diverged = a.nextNotification("sim.diverged");
  await a.request("scene.patch", { patch: { solver: { dt: 0.5 } } });
  await diverged;
  await a.request("scene.undo");
  await a.nextNotification("sim.status", ({ diverged, playing }) => !diverged && playing);
  await leave([a]);
});

test("a viewer hears of the history, and may not undo", async (t) => {
  const guarded = await Server.start("--token", "secret", "--view-token", "look");
  t.after(() => guarded.child.kill());
  const [owner, viewer] = await Promise.all([1, 2].map(() => Client.connect(guarded)));
  await owner.request("auth", { token: "secret" });
  await viewer.request("auth", { token: "look" });
  await viewer.notification("scene.history");
  const heard = viewer.nextNotification("scene.history");
  await owner.request("scene.patch", { patch: gravity(-5) });
  assert.equal((await heard).undo, "Gravity");
  for (const method of ["scene.undo", "scene.redo"]) assert.equal((await viewer.refusal(method)).code, -32001);
  await guarded.stop();
});
