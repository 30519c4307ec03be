// The live step limit in sim.status: it follows every change of the scene, and there is a warning near it.
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
  // Limit of its fastest wave: between the bound, 1.59 ms, and that of the undamped infinite grid.
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
  // The limit itself may be told more sharply meanwhile, where a busy machine takes long to search for it.
  assert.ok(Math.abs(half.margin - 0.0005 / half.dt_limit) < 1e-12);
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
  for (let i = 0; i < 3; ++i) {
    // a warning each time, however quickly the scene changes there and back
    const beyond = client.nextNotification("notice", (n) => /beyond/.test(n.text));
    await patch({ solver: { dt: 0.002 } });
    await patch({ solver: { dt: 0.001 } });
    await beyond;
  }
});

test("where nothing can move, nothing limits the step: both are null", async () => {
  await patch([
    {
      op: "add",
      path: "/cloths/0/pins/-",
      value: {
        at: {
          box: [
            [-9, -9, -9],
            [9, 9, 9],
          ],
        },
        motion: null,
      },
    },
  ]);
  const { margin } = await stability((s) => s.dt_limit === null);
  assert.equal(margin, null);
});

test("a large cloth gets an answer at once and a sharper one soon", async () => {
  await client.request("scene.load", {
    scene: { version: 1, cloths: [{ mesh: { grid: { columns: 200, rows: 200 } } }] },
  });
  const first = await client.nextNotification("sim.status");
  assert.ok(first.stability.dt_limit > 1.5e-3 && first.stability.dt_limit < 1.7e-3);
  const sharp = await stability((s) => s.dt_limit > 1.65e-3);
  assert.ok(sharp.dt_limit >= first.stability.dt_limit && sharp.dt_limit < 1.7e-3);
});

function seedCloth() {
  return client.messages.findLast((m) => m.method === "scene").params.document.cloths[0];
}

/// True if a frame shows a hanging cloth and not a flying one: the seed's is 1 m wide at a height of 1 m.
function hangs(frame) {
  return frame.positions.every(([x, y, z]) => Math.abs(x) < 2 && y > -1.5 && y < 1.5 && Math.abs(z) < 2.5);
}

test("a patch past the limit blows up, the remedy's patch alone makes the cloth go on from where it was good", async () => {
  await client.request("stream.subscribe", { encoding: "q16" });
  await client.request("sim.play");
  await client.nextNotification("sim.status", (s) => s.time > 0.2);
  const told = client.nextNotification("sim.diverged");
  await patch({ solver: { dt: 0.0025 } });
  const { reason, remedy } = await told;
  assert.match(reason, /t = [\d.]+ s.*dt = 0\.0025 s is 1\.47 times .*symplectic_euler, 0\.001701 s/);
  assert.deepEqual(remedy.patch, { solver: { dt: 0.0013 } });
  assert.match(remedy.text, /0\.0013/);
  const flagged = await client.frame((frame) => frame.flags & 2);
  assert.ok(flagged.time > 0.2 && hangs(flagged), "the last good state is that of just before");
  const status = await client.nextNotification("sim.status", (s) => s.diverged);
  assert.equal(status.playing, false);
  assert.ok(Math.abs(status.time - flagged.time) < 1e-9);

  const next = client.nextFrame((frame) => frame.flags === 0);
  await patch(remedy.patch);
  assert.ok((await next).time >= flagged.time);
  const later = await client.nextFrame((frame) => frame.time > flagged.time + 1);
  assert.ok(hangs(later) && later.flags === 0);
  const going = await client.nextNotification("sim.status", (s) => s.step > 0);
  assert.equal(going.diverged, false);
  assert.equal(going.playing, true);
  assert.ok(going.stability.margin < 0.8);
});

test("a paused session that diverges by sim.step stays paused after the remedy, at the last good step", async () => {
  const told = client.nextNotification("sim.diverged");
  await patch({ solver: { dt: 0.0025 } });
  await client.request("sim.step", { steps: 100 }).catch((error) => assert.equal(error.code, -32004));
  const { remedy } = await told;
  assert.equal((await client.refusal("sim.step", { steps: 1 })).code, -32004);
  await patch({ name: "renamed" });
  assert.equal((await client.refusal("sim.play")).code, -32004, "a name cures nothing");
  await patch(remedy.patch);
  const { playing, step } = await client.request("sim.step", { steps: 1 });
  assert.equal(playing, false);
  assert.ok(step < 30, `${step}`);
});

test("explicit Euler without damping blows up, and its remedy is another method", async () => {
  await patch({ cloths: [{ ...seedCloth(), material: { structural: 20000, shear: 10000, bend: 2000, damping: 0 } }] });
  const told = client.nextNotification("sim.diverged");
  const warned = client.nextNotification("notice", (n) => /explicit_euler/.test(n.text));
  await patch({ solver: { method: "explicit_euler", dt: 0.0005 } });
  assert.match((await warned).text, /stable at no step/);
  assert.equal((await stability((s) => s.dt_limit === 0)).margin, null);
  await client.request("sim.play");
  const { reason, remedy } = await told;
  assert.match(reason, /explicit_euler/);
  assert.deepEqual(remedy.patch, { solver: { dt: 0.0005, method: "symplectic_euler" } });
  await patch(remedy.patch);
  await client.nextNotification("sim.status", (s) => s.playing && !s.diverged && s.time > 0.5);
});

test("far beyond the limit the remedy is a method without one, and the cloth goes on with it", async () => {
  await patch({ solver: { dt: 0.016 } });
  const told = client.nextNotification("sim.diverged");
  await client.request("sim.play");
  const { remedy } = await told;
  assert.deepEqual(remedy.patch, { solver: { dt: 0.016, method: "implicit_euler" } });
  await patch(remedy.patch);
  const status = await client.nextNotification("sim.status", (s) => s.playing && !s.diverged && s.time > 0.5);
  assert.deepEqual(status.stability, { dt_limit: null, margin: null });
});

test("a second blow-up after the same remedy is reported again", async () => {
  await patch({ solver: { dt: 0.004 } });
  await client.request("sim.play");
  await client.notification("sim.diverged", ({ reason }) => /0\.004 s/.test(reason));
  const again = client.nextNotification("sim.diverged");
  await patch({ solver: { dt: 0.003 } });
  assert.match((await again).reason, /0\.003 s/);
});
