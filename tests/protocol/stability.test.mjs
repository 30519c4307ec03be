// The live step limit: in sim.status, after every change of the scene, with a warning near it.
import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { Client, Server } from "./harness.mjs";

let server, client;
before(async () => (server = await Server.start()));
after(() => server.stop());
beforeEach(async () => {
  client = await Client.connect(server);
  await client.notification("scene");
  await client.request("sim.pause");
  await client.request("scene.load", { preset: "seed" });
});
afterEach(() => client.close());

const patch = (value) => client.request("scene.patch", { patch: value });
const stability = async (predicate) =>
  (await client.nextNotification("sim.status", (status) => predicate(status.stability))).stability;

test("sim.status tells the seed's limit, and margin is dt over it", async () => {
  const { dt_limit, margin } = await stability((s) => s.dt_limit !== null);
  // Its fastest wave: omega^2 between that of the bound, 2 / 1.59 ms, and of the undamped infinite grid.
  assert.ok(dt_limit > 1.59e-3 && dt_limit < 1.75e-3, `${dt_limit}`);
  assert.ok(Math.abs(margin - 0.001 / dt_limit) < 1e-12);
});

test("the limit follows stiffness, mass and damping; margin follows dt", async () => {
  const { dt_limit } = await stability((s) => s.dt_limit !== null);
  await patch({ cloths: [{ ...seedCloth(), mass: { per_vertex: 0.4 } }] });
  const heavy = await stability((s) => s.dt_limit > 1.2 * dt_limit);
  assert.ok(Math.abs(heavy.dt_limit / dt_limit - 2) < 0.1, "about sqrt(m/k), less the damping");
  await patch({ solver: { dt: 0.0005 } });
  const half = await stability((s) => s.margin < 0.6 * heavy.margin);
  assert.ok(Math.abs(half.margin - heavy.margin / 2) < 1e-9);
});

test("a patch that moves the margin above 0.9 warns, once, with the limit in numbers", async () => {
  const warned = client.nextNotification("notice", (n) => n.level === "warning");
  await patch({ solver: { dt: 0.0016 } });
  assert.match((await warned).text, /0\.0016 s is 94 % of 0\.001701 s.*symplectic_euler/);
  const before = client.messages.length;
  await patch({ solver: { dt: 0.00161 } });
  await stability((s) => s.margin > 0.945);
  await stability((s) => s.margin > 0.945);
  assert.ok(!client.messages.slice(before).some((m) => m.method === "notice"), "told twice");
  const beyond = client.nextNotification("notice", (n) => /beyond/.test(n.text));
  await patch({ solver: { dt: 0.002 } });
  await beyond;
});

test("where nothing can move, nothing limits the step: both are null", async () => {
  await patch([{ op: "add", path: "/cloths/0/pins/-", value: { at: { box: [[-9, -9, -9], [9, 9, 9]] }, motion: null } }]);
  const { margin } = await stability((s) => s.dt_limit === null);
  assert.equal(margin, null);
});

test("a large cloth gets an answer at once and a sharper one soon", async () => {
  await client.request("scene.load", { scene: { version: 1, cloths: [{ mesh: { grid: { columns: 200, rows: 200 } } }] } });
  const first = await client.nextNotification("sim.status");
  assert.ok(first.stability.dt_limit > 1.5e-3 && first.stability.dt_limit < 1.7e-3);
  const sharp = await stability((s) => s.dt_limit > 1.65e-3);
  assert.ok(sharp.dt_limit >= first.stability.dt_limit && sharp.dt_limit < 1.7e-3);
});

function seedCloth() {
  return client.messages.findLast((m) => m.method === "scene").params.document.cloths[0];
}
