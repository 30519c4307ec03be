// A cloth at rest: no steps and no frames until something changes, and every client is told.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { after, before, test } from "node:test";
import { some } from "../thorough.mjs";
import { Client, Server, sleep } from "./harness.mjs";

// A cloth that hangs straight down from the start: the motion by its own weight is damped away within a second.
const hanging = {
  version: 1,
  name: "hanging",
  cloths: [
    {
      mesh: { grid: { columns: 3, rows: 6, width: 0.1, height: 0.25 } },
      transform: { translate: [0, 1, 0], rotate: [90, 0, 0] },
      mass: { per_vertex: 0.01 },
      material: { structural: 2000, shear: 500, bend: 50, damping: 0.5 },
      pins: [{ at: "edge:row:0" }],
    },
  ],
  air_drag: 5,
  solver: { method: "symplectic_euler", dt: 0.001 },
};

let server;
before(async () => (server = await Server.start("--max-sessions", "32")));
after(() => server.stop());

let sessions = 0;
async function enter(scene, session = `sleep-${++sessions}`) {
  const client = await Client.connect(server, { session });
  await client.notification("scene");
  if (scene) await client.request("scene.load", { scene });
  client.session = session;
  return client;
}
const asleep = (client) => client.nextNotification("sim.status", (s) => s.asleep);
const awake = (client) => client.nextNotification("sim.status", (s) => !s.asleep);

test("a cloth at rest falls asleep: it plays, time stands still, no pass runs, and the last frame says so", async () => {
  const client = await enter(hanging);
  await client.request("stream.subscribe", { rate: 60 });
  const running = await client.nextNotification("sim.status", (s) => s.passes.length > 0);
  const status = await asleep(client);
  assert.equal(status.playing, true);
  assert.deepEqual(status.passes, []);
  assert.deepEqual(status.terms, []);
  const all = [...running.passes, ...running.terms];
  for (const pass of all)
    assert.deepEqual(
      status.skipped.find(({ name }) => name === pass),
      { name: pass, reason: "asleep: the cloth is at rest" },
    );
  assert.equal(status.skipped.length, all.length + running.skipped.length);
  await client.frame((frame) => frame.flags & 1);
  const frames = client.frames.length;
  const before = await client.nextNotification("sim.status");
  await client.statuses(5);
  assert.equal(client.frames.length, frames);
  const later = await client.nextNotification("sim.status");
  assert.equal(later.step, before.step);
  assert.equal(later.time, before.time);
  assert.ok((await server.metric("clothlab_sessions_asleep")) >= 1);
  // A client that connects now still gets the cloth.
  const late = await Client.connect(server, { session: client.session });
  await late.notification("scene");
  await late.request("stream.subscribe", { rate: 60 });
  const frame = await late.frame();
  assert.equal(frame.flags & 1, 1);
  assert.equal(frame.step, later.step);
  await client.close();
  await late.close();
});

test("any change wakes a cloth that sleeps: a patch, reset, play, speed, another scene", async () => {
  const client = await enter(hanging);
  await client.request("stream.subscribe", { rate: 30 });
  const changes = [
    ["scene.patch", { patch: { gravity: [1, -9, 0] } }],
    ...some([["scene.patch", { patch: { wind: { velocity: [0, 0, 4] } } }]], 0),
    ["sim.reset", {}],
    ["sim.play", {}],
    ["sim.speed", { factor: 2 }],
    ["scene.load", { scene: hanging }],
  ];
  for (const [method, params] of changes) {
    const { step } = await asleep(client);
    const moves = client.nextFrame((frame) => (frame.flags & 1) === 0 && frame.step !== step);
    await client.request(method, params);
    await moves;
    const status = await awake(client);
    assert.equal(status.playing, true, method);
    assert.ok(status.passes.length > 0, method);
  }
  await client.close();
});

test("pause and steps by hand wake it too, and it stays where they leave it", async () => {
  const client = await enter(hanging);
  const { step } = await asleep(client);
  assert.equal((await client.request("sim.step", { steps: 5 })).step, step + 5);
  let status = await client.nextNotification("sim.status", (s) => s.step === step + 5);
  assert.equal(status.asleep, false);
  assert.equal(status.playing, false);
  await client.request("sim.play");
  await asleep(client);
  await client.request("sim.pause");
  status = await client.nextNotification("sim.status", (s) => !s.playing);
  assert.equal(status.asleep, false);
  await client.close();
});

test("a cloth that swings undamped never falls asleep, nor one whose pins move", async () => {
  const swinging = structuredClone(hanging);
  swinging.cloths[0].material.damping = swinging.air_drag = 0;
  swinging.cloths[0].transform.rotate = [80, 0, 0];
  const held = structuredClone(hanging);
  held.cloths[0].pins[0].motion = { oscillate: { axis: [1, 0, 0], amplitude: 1e-6, frequency: 0.1 } };
  const clients = await Promise.all([enter(swinging), enter(held)]);
  await Promise.all(clients.map((client) => client.request("sim.speed", { factor: 3 })));
  for (const client of clients) await client.nextNotification("sim.status", (s) => s.time > 8);
  for (const client of clients) {
    assert.ok(!client.messages.some((m) => m.method === "sim.status" && m.params.asleep));
    await client.close();
  }
});

test("a server whose cloth sleeps uses next to no processor time", async (t) => {
  const own = await Server.start();
  const client = await Client.connect(own);
  await client.notification("scene");
  await client.request("scene.load", { scene: hanging });
  await client.request("stream.subscribe", { rate: 60 });
  const used = async () => {
    // of user and system time [s]; the kernel counts in hundredths
    const fields = (await readFile(`/proc/${own.child.pid}/stat`, "utf8")).split(") ")[1].split(" ");
    return (Number(fields[11]) + Number(fields[12])) / 100;
  };
  const share = async () => {
    const [begun, before] = [performance.now(), await used()];
    await sleep(2000);
    return ((await used()) - before) / ((performance.now() - begun) / 1000);
  };
  await client.nextNotification("sim.status", (s) => s.step > 0);
  const busy = await share();
  await asleep(client);
  const idle = await share();
  t.diagnostic(`${(100 * busy).toFixed(1)} % of a core while it moves, ${(100 * idle).toFixed(1)} % while it sleeps`);
  assert.ok(idle < 0.05, `${idle}`);
  await client.close();
  await own.stop();
});
