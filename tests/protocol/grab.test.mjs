// Hands on the cloth, and pins where a hand has put it.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { hanging } from "./hanging.mjs";
import { Client, Server, withTimeout } from "./harness.mjs";

let server;
before(async () => (server = await Server.start("--max-sessions", "32")));
after(() => server.stop());

// A small sheet that hangs from its upper edge at rest.
const columns = 9;
const sheet = hanging(columns, 0.4, ["edge:row:0"]);
const vertex = 8 * columns + 4; // the middle of the lower edge, at (0, 0.6, 0)
const target = [0.1, 0.75, 0.2];

let sessions = 0;
async function enter(session = `grab-${++sessions}`) {
  const client = await Client.connect(server, { session });
  client.session = session;
  await client.notification("scene");
  return client;
}
async function hang(scene = sheet) {
  const client = await enter();
  await client.request("scene.load", { scene });
  await client.request("stream.subscribe", { encoding: "f32", rate: 60 });
  return client;
}
const placeOf = (frame, i) => frame.positions[i];
const distance = (a, b) => Math.hypot(...a.map((value, axis) => value - b[axis]));
const near = (client, i, place, tolerance = 0.04) =>
  client.nextFrame((frame) => distance(placeOf(frame, i), place) < tolerance);
const hands = (client, fits) => client.nextNotification("sim.status", (status) => fits(status.hands));

test("a grabbed vertex comes near its target and follows it, and falls when it is let go", async () => {
  const client = await hang();
  client.notify("grab.start", { cloth: 0, vertex, target });
  await near(client, vertex, target);
  client.notify("grab.move", { target: [-0.1, 0.7, 0.1] });
  await near(client, vertex, [-0.1, 0.7, 0.1]);
  client.notify("grab.end");
  await near(client, vertex, [0, 0.6, 0], 0.02);
  await client.close();
});

test("hands of two clients and two of one client hold at once, and everybody is told", async () => {
  const client = await hang();
  const other = await enter(client.session);
  const corners = [8 * columns, 8 * columns + 8];
  client.notify("grab.start", { cloth: 0, vertex: corners[0], target: [-0.3, 0.7, 0.1] });
  client.notify("grab.start", { cloth: 0, vertex: corners[1], target: [0.3, 0.7, 0.1], hand: 1 });
  other.notify("grab.start", { cloth: 0, vertex, target: [0, 0.75, 0.15] });
  const told = await hands(other, (all) => all.length === 3);
  assert.deepEqual(
    told.hands.map(({ hand, vertex }) => [hand, vertex]).sort(),
    [
      [0, corners[0]],
      [1, corners[1]],
      [0, vertex],
    ].sort(),
  );
  assert.equal(new Set(told.hands.map(({ by }) => by)).size, 2);
  await near(client, corners[0], [-0.3, 0.7, 0.1], 0.08);
  await near(client, corners[1], [0.3, 0.7, 0.1], 0.08);
  client.notify("grab.end", { hand: 1 });
  const left = await hands(other, (all) => all.length === 2);
  assert.ok(left.hands.every(({ hand }) => hand === 0));
  await Promise.all([client.close(), other.close()]);
});

test("a hand ends with its connection", async () => {
  const client = await hang();
  const other = await enter(client.session);
  other.notify("grab.start", { cloth: 0, vertex, target });
  await near(client, vertex, target);
  await other.close();
  await hands(client, (all) => all.length === 0);
  await near(client, vertex, [0, 0.6, 0], 0.02);
  await client.close();
});

test("a cloth that sleeps wakes when it is grabbed, and does not sleep while it is held", async () => {
  const client = await hang();
  await client.nextNotification("sim.status", ({ asleep }) => asleep);
  client.notify("grab.start", { cloth: 0, vertex, target });
  await near(client, vertex, target);
  const from = await client.nextNotification("sim.status");
  assert.equal(from.asleep, false);
  await client.nextNotification("sim.status", ({ time }) => time > from.time + 4); // it slept after 1.5 s
  client.notify("grab.move", { target: [0, 0.7, 0.1] });
  await near(client, vertex, [0, 0.7, 0.1]);
  assert.equal((await client.nextNotification("sim.status")).asleep, false);
  client.notify("grab.end");
  await client.nextNotification("sim.status", ({ asleep }) => asleep);
  await client.close();
});

test("while paused a target is kept: a step and playing on move the cloth to it", async () => {
  const client = await hang();
  await client.request("sim.pause");
  const { step } = await client.nextNotification("sim.status");
  const before = placeOf(await client.frame((frame) => frame.step === step), vertex);
  client.notify("grab.start", { cloth: 0, vertex, target: [0, 0.9, 0] });
  client.notify("grab.move", { target });
  const { hands: kept } = await hands(client, (all) => all.length === 1);
  assert.deepEqual(kept[0].target, target);
  await client.request("sim.step", { steps: 40 });
  const stepped = placeOf(await client.frame((frame) => frame.step === step + 40), vertex); // may come before the answer
  assert.ok(distance(stepped, target) < distance(before, target) - 0.02, `${before} -> ${stepped}`);
  await client.request("sim.play");
  await near(client, vertex, target);
  await client.close();
});

test("a reset, another scene and another mesh end hands; other changes do not", async () => {
  const client = await hang();
  const hold = async () => {
    await client.request("grab.start", { cloth: 0, vertex, target });
    await hands(client, (all) => all.length === 1);
  };
  for (const [method, params] of [
    ["sim.reset", {}],
    ["scene.load", { scene: sheet }],
    ["scene.patch", { patch: [{ op: "replace", path: "/cloths/0/mesh/grid/width", value: 0.41 }] }],
  ]) {
    await hold();
    await client.request(method, params);
    await hands(client, (all) => all.length === 0);
    client.notify("grab.move", { target }); // of a page that has not heard of it yet
  }
  await hold();
  for (const solver of [{ method: "xpbd" }, { method: "implicit_euler", dt: 0.004 }, { method: "vbd" }]) {
    await client.request("scene.patch", { patch: { solver } });
    await near(client, vertex, target);
  }
  await client.request("scene.patch", { patch: [{ op: "replace", path: "/cloths/0/mass/per_vertex", value: 0.004 }] });
  assert.equal((await client.nextNotification("sim.status")).hands.length, 1);
  await near(client, vertex, target);
  const warned = ({ method, params }) => method === "notice" && params.level !== "info";
  assert.deepEqual(
    // a busy machine's session may say that it cannot keep up
    client.messages.filter((message) => warned(message) && !/cannot keep up/.test(message.params.text)),
    [],
  );
  await client.close();
});

test("what cannot be grabbed is refused: an error for a request, a notice for a notification", async () => {
  const client = await hang();
  const good = { cloth: 0, vertex, target };
  for (const [params, path] of [
    [{ ...good, cloth: 1 }, "/cloth"],
    [{ ...good, cloth: "cloth" }, "/cloth"],
    [{ ...good, vertex: 81 }, "/vertex"],
    [{ ...good, vertex: -1 }, "/vertex"],
    [{ ...good, vertex: 3 }, "/vertex"], // a pin holds it
    [{ ...good, target: [0, 1] }, "/target"],
    [{ ...good, target: [0, 1, null] }, "/target"],
    [{ ...good, target: [0, 1e7, 0] }, "/target"],
    [{ ...good, target: undefined }, "/target"],
    [{ ...good, hand: 10 }, "/hand"],
    [{ ...good, force: 1 }, "/force"],
  ]) {
    const { code, data } = await client.refusal("grab.start", params);
    assert.deepEqual([code, data.path], [-32602, path], JSON.stringify(params));
    assert.ok(data.found && data.allowed);
  }
  assert.equal((await client.refusal("grab.move", { target })).data.path, "/hand");
  assert.equal((await client.refusal("grab.end")).data.path, "/hand");
  client.notify("grab.start", { ...good, vertex: 3 });
  assert.match((await client.nextNotification("notice")).text, /grab\.start.*\/vertex.*pin/);
  client.notify("grab.start", { ...good, target: "there" });
  assert.match((await client.nextNotification("notice")).text, /\/target/);
  // Many wrong ones are told a few times only.
  const count = () => client.messages.filter(({ method }) => method === "notice").length;
  const told = count();
  for (let i = 0; i < 500; ++i) client.notify("grab.move", { target: i });
  await client.request("ping", {});
  assert.ok(count() <= told + 3, `${count() - told} notices`);
  assert.equal((await client.nextNotification("sim.status")).hands.length, 0);
  await client.close();
});

test("a thousand moves at once are taken, the last one counts, and nobody waits for the others", async () => {
  const client = await hang();
  client.notify("grab.start", { cloth: 0, vertex, target: [0, 0.6, 0] });
  for (let i = 0; i <= 1500; ++i) client.notify("grab.move", { target: target.map((value) => (value * i) / 1500) });
  const asked = performance.now();
  await client.request("scene.get", {});
  assert.ok(performance.now() - asked < 2000);
  await near(client, vertex, target);
  assert.equal((await client.nextNotification("sim.status")).hands[0].target[1], target[1]);
  await client.close();
});

test("more hands than a session takes are refused until one lets go", async () => {
  const crowd = [await hang()];
  while (crowd.length < 7) crowd.push(await enter(crowd[0].session));
  const grab = (client, hand) =>
    client.request("grab.start", { cloth: 0, vertex: 20 + hand, target: [0, 0.7, 0], hand });
  for (let i = 0; i < 64; ++i) await grab(crowd[Math.floor(i / 10)], i % 10);
  await assert.rejects(grab(crowd[6], 9), ({ code, message }) => code === -32002 && /64 hands/.test(message));
  await grab(crowd[0], 3); // one that holds already may hold something else
  await crowd[1].close();
  await hands(crowd[0], (all) => all.length === 54);
  await grab(crowd[6], 9);
  await Promise.all(crowd.filter((client) => !client.over).map((client) => client.close()));
});

test("a viewer may not pull, and an operator who becomes one lets go", async (t) => {
  const guarded = await Server.start("--token", "secret", "--view-token", "look");
  t.after(() => guarded.stop());
  const [viewer, operator] = await Promise.all([1, 2].map(() => Client.connect(guarded)));
  await operator.request("auth", { token: "secret" });
  await viewer.request("auth", { token: "look" });
  const seed = { cloth: 0, vertex: 312, target: [0, 1.2, 0] };
  for (const [method, params] of [
    ["grab.start", seed],
    ["grab.move", { target: [0, 1, 0] }],
    ["grab.end", {}],
  ])
    assert.equal((await viewer.refusal(method, params)).code, -32001, method);
  viewer.notify("grab.start", seed);
  assert.match((await viewer.nextNotification("notice")).text, /a viewer may only look/);
  await operator.request("grab.start", seed);
  await hands(viewer, (all) => all.length === 1);
  await operator.request("auth", { token: "look" });
  await hands(viewer, (all) => all.length === 0);
  await Promise.all([viewer.close(), operator.close()]);
});

test("pinned where a hand holds it, a vertex stays there; time goes on, and unpinned it falls", async () => {
  const client = await hang();
  client.notify("grab.start", { cloth: 0, vertex, target });
  const held = placeOf(await near(client, vertex, target), vertex);
  const { time } = await client.nextNotification("sim.status");
  const pin = { at: `vertex:${vertex}`, place: held };
  const added = await client.request("scene.patch", { patch: [{ op: "add", path: "/cloths/0/pins/-", value: pin }] });
  assert.notEqual(added.applies, "cloth");
  client.notify("grab.end");
  await hands(client, (all) => all.length === 0);
  for (let i = 0; i < 30; ++i) {
    const frame = await client.nextFrame();
    assert.ok(frame.time > time);
    assert.ok(distance(placeOf(frame, vertex), held) < 1e-5, `${placeOf(frame, vertex)}`);
  }
  const { document } = await client.request("scene.get", {});
  assert.deepEqual(document.cloths[0].pins[1], { ...pin, motion: null });
  // After a reset the vertex glides there from where it is at rest, and nothing blows up.
  await client.request("sim.reset");
  const first = await client.nextFrame((frame) => frame.time < 0.1);
  assert.ok(distance(placeOf(first, vertex), [0, 0.6, 0]) < 0.05);
  await near(client, vertex, held, 1e-5);
  const removed = await client.request("scene.patch", { patch: [{ op: "remove", path: "/cloths/0/pins/1" }] });
  assert.notEqual(removed.applies, "cloth");
  await near(client, vertex, [0, 0.6, 0], 0.02);
  assert.equal(client.messages.filter(({ method }) => method === "sim.diverged").length, 0);
  await client.close();
});

test("several vertices cannot be pinned at one place", async () => {
  const client = await hang();
  const pin = { at: "edge:row:8", place: [0, 1, 0] };
  const { data } = await client.refusal("scene.patch", {
    patch: [{ op: "add", path: "/cloths/0/pins/-", value: pin }],
  });
  assert.equal(data.path, "/cloths/0/pins/1/place");
  assert.match(data.allowed, /vertex:N/);
  await client.close();
  await withTimeout(client.closed, "the end");
});
