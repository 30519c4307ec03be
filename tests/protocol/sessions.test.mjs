import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Client, Server, sleep } from "./harness.mjs";

let server;
before(async () => (server = await Server.start()));
after(() => server.stop());

async function enter(session) {
  const client = await Client.connect(server, { session });
  await client.notification("scene");
  return client;
}

test("two viewers of one session see each other's edits, and who made them", async () => {
  const [first, second] = [await enter(), await enter()];
  const [one, two] = [await first.notification("hello"), await second.notification("hello")];
  assert.notEqual(one.client, two.client);
  const patch = { solver: { dt: 0.0004 } };
  const seen = [first, second].map((client) => client.nextNotification("scene.changed"));
  const { revision } = await first.request("scene.patch", { patch });
  for (const change of await Promise.all(seen)) assert.deepEqual(change, { revision, patch, by: one.client });
  const back = first.nextNotification("scene.changed");
  await second.request("scene.patch", { patch: { solver: { dt: 0.001 } } });
  assert.equal((await back).by, two.client);
  await first.close();
  await second.close();
});

test("play and pause of one viewer reach the other", async () => {
  const [first, second] = [await enter(), await enter()];
  await first.request("sim.pause");
  await second.nextNotification("sim.status", (s) => !s.playing);
  await second.request("sim.play");
  await first.nextNotification("sim.status", (s) => s.playing);
  await first.close();
  await second.close();
});

test("viewers counts who is in the session, as they come and go", async () => {
  const first = await enter("count");
  await first.notification("viewers", ({ count }) => count === 1);
  const second = await enter("count");
  await first.notification("viewers", ({ count }) => count === 2);
  await second.notification("viewers", ({ count }) => count === 2);
  const fewer = first.nextNotification("viewers");
  await second.close();
  assert.deepEqual(await fewer, { count: 1 });
  await first.close();
});

test("two sessions share nothing", async () => {
  const [left, right] = [await enter("left"), await enter("right")];
  await left.request("sim.pause");
  await left.request("scene.patch", { patch: { name: "left", gravity: [0, 0, 0] } });
  const { document } = await right.request("scene.get");
  assert.equal(document.name, "seed");
  assert.deepEqual(document.gravity, [0, -9.8, 0]);
  await right.nextNotification("sim.status", (s) => s.playing && s.step > 10);
  assert.ok(!right.messages.some((message) => message.method === "scene.changed"));
  await left.close();
  await right.close();
});

test("a session keeps its state while nobody is there", async () => {
  const first = await enter("kept");
  const { step: before } = await first.request("sim.step", { steps: 40 }); // it plays until this pauses it
  await first.request("scene.patch", { patch: { name: "kept" } });
  await first.close();
  const again = await enter("kept");
  assert.equal((await again.notification("scene")).document.name, "kept");
  const { step, playing } = await again.request("sim.step", { steps: 1 });
  assert.equal(step, before + 1);
  assert.equal(playing, false);
  await again.close();
});

test("a crowd that connects, asks and vanishes leaves the server as it was", async () => {
  const crowd = await Promise.all(Array.from({ length: 20 }, () => enter("crowd")));
  await Promise.all(crowd.map((client) => client.request("stream.subscribe", { rate: 30 })));
  await Promise.all(crowd.map((client) => client.frame()));
  for (const client of crowd) client.socket.terminate();
  const last = await enter("crowd");
  await last.notification("viewers", ({ count }) => count === 1);
  await last.close();
});

test("edits of two viewers at once end in one scene that both know", async () => {
  const [first, second] = [await enter("race"), await enter("race")];
  const edits = [];
  for (let i = 0; i < 20; ++i) {
    edits.push(first.request("scene.patch", { patch: { gravity: [0, -i, 0] } }));
    edits.push(second.request("scene.patch", { patch: { air_drag: i } }));
  }
  const revisions = (await Promise.all(edits)).map((answer) => answer.revision);
  assert.equal(new Set(revisions).size, 40);
  const last = Math.max(...revisions);
  for (const client of [first, second])
    await client.notification("scene.changed", (change) => change.revision === last);
  const order = (client) => client.messages.filter((m) => m.method === "scene.changed").map((m) => m.params);
  assert.deepEqual(order(first), order(second));
  await sleep(50);
  await first.close();
  await second.close();
});
