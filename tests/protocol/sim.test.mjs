import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { Client, Server, sleep } from "./harness.mjs";

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

test("sim.status has every field of the contract, with the passes that run and those that do not", async () => {
  await client.request("sim.play");
  const status = await client.nextNotification("sim.status", (s) => s.playing && s.step > 0);
  for (const field of ["time", "step", "real_time_factor", "speed", "max_strain", "max_speed", "contacts"])
    assert.ok(Number.isFinite(status[field]), field);
  for (const field of ["kinetic", "elastic", "gravitational"]) assert.ok(Number.isFinite(status.energy[field]), field);
  assert.deepEqual(status.passes, ["neighbour_search", "symplectic_euler"]);
  assert.ok(["structural_springs", "self_contacts", "moving_poses", "spheres"].every((t) => status.terms.includes(t)));
  assert.ok(status.skipped.every(({ name, reason }) => name && reason));
  assert.ok(status.stability.dt_limit > 0 && status.stability.margin > 0);
  const { thickness_that_holds: holds, ...solver } = status.solver;
  assert.deepEqual(solver, { pbd_stiffness: null, auto: null, from_fabrics: [null] });
  // a vertex in the middle of a cell, and a fifth more
  assert.ok(Math.abs(holds - 1.2 / 24 / Math.SQRT2) < 1e-9, `${holds}`);
  assert.equal(status.surface, null);
  assert.equal(status.convergence, null);
  assert.equal(status.asleep, false);
  assert.equal(status.diverged, false);
});

test("sim.status tells how far steps are from solved, under methods that iterate, and a notice what helps", async () => {
  await client.request("scene.patch", { patch: { solver: { method: "xpbd", dt: 1 / 60, iterations: 3 } } });
  const told = client.nextNotification("notice", (n) => n.text.includes("far from solved"));
  await client.request("sim.step", { steps: 400 });
  const unsolved = ({ convergence: of }) => of?.error_m > of?.tolerance_m;
  const { convergence } = await client.nextNotification("sim.status", unsolved);
  assert.deepEqual(Object.keys(convergence).sort(), ["error_m", "residual", "tolerance_m"]);
  assert.ok(convergence.residual > 0.1 && convergence.residual < 2, JSON.stringify(convergence));
  assert.match((await told).text, /3 sweeps of xpbd.* mm.*more iterations/);
  await client.request("scene.patch", { patch: { solver: { method: "verlet", dt: 0.001 } } });
  await client.nextNotification("sim.status", (s) => s.convergence === null);
});

test("sim.status counts what contact between surfaces does", async () => {
  await client.request("scene.patch", { patch: { self_collision: { kind: "surface" } } });
  await client.request("sim.play");
  const { surface } = await client.nextNotification("sim.status", (s) => s.step > 20 && s.surface?.searches > 0);
  for (const count of ["pairs", "cuts"]) assert.ok(Number.isInteger(surface[count]), count);
  await client.request("scene.patch", { patch: { self_collision: { kind: "points" } } });
  const { step } = await client.nextNotification("sim.status");
  const after = await client.nextNotification("sim.status", (s) => s.step > step + 20);
  assert.equal(after.surface, null);
});

test("sim.status comes about 10 times a second, playing or not", async () => {
  for (const method of ["sim.play", "sim.pause"]) {
    await client.request(method);
    const from = performance.now();
    await client.statuses(20);
    const seconds = (performance.now() - from) / 1000;
    // As the machine may slow them, but not hasten them: the first at once, 19 intervals, and a fifth less.
    assert.ok(seconds > 0.8 * 1.9, `20 in ${seconds} s after ${method}`);
  }
});

test("under PBD alone sim.status tells for each cloth what it makes of N/m at this dt and these iterations", async () => {
  const stiffness = async (predicate) =>
    (await client.nextNotification("sim.status", ({ solver }) => predicate(solver.pbd_stiffness))).solver.pbd_stiffness;
  const {
    document: {
      cloths: [cloth],
    },
  } = await client.request("scene.get", {});
  const material = { ...cloth.material, damping: 0, bend: 0 };
  await client.request("scene.patch", {
    patch: { cloths: [{ ...cloth, material }], solver: { method: "pbd", dt: 0.002, iterations: 3 } },
  });
  const [{ structural, shear, bend }] = await stiffness((shares) => shares);
  // A single spring between two vertices of 0.1 kg ends, after three visits, where one solve of implicit Euler would
  // put it.
  for (const [share, k] of [
    [structural, material.structural],
    [shear, material.shear],
  ])
    assert.ok(Math.abs((1 - share) ** 3 - 1 / (1 + (2 / 0.1) * k * 0.002 ** 2)) < 1e-12);
  assert.equal(bend, null);
  await client.request("scene.patch", { patch: { solver: { method: "xpbd" } } });
  await stiffness((shares) => shares === null);
});

test("what is skipped follows the scene", async () => {
  const patched = await client.request("scene.patch", { patch: { self_collision: null, colliders: [] } });
  assert.equal(patched.applies, "kernel");
  const status = await client.nextNotification("sim.status", (s) => s.skipped.some((pass) => /self/.test(pass.name)));
  assert.ok(!status.terms.some((name) => /self|sphere/.test(name)));
});

test("play moves time, pause holds it", async () => {
  await client.request("sim.play");
  await client.nextNotification("sim.status", (s) => s.step > 20);
  const { step, playing } = await client.request("sim.pause");
  assert.equal(playing, false);
  assert.ok(step > 20);
  await client.statuses(3);
  assert.equal((await client.request("sim.pause")).step, step);
  const status = await client.nextNotification("sim.status", (s) => s.step === step);
  assert.equal(status.playing, false);
});

test("the first status of a paused session is of the step at which it stopped", async () => {
  for (let i = 0; i < 10; ++i) {
    await client.request("sim.play");
    await sleep(50 + 37 * i);
    const status = client.nextNotification("sim.status", ({ playing }) => !playing);
    const { step } = await client.request("sim.pause");
    assert.equal((await status).step, step);
  }
});

test("sim.step pauses first and answers when exactly that many steps are done", async () => {
  await client.request("sim.play");
  const first = await client.request("sim.step", { steps: 7 });
  assert.equal(first.playing, false);
  const second = await client.request("sim.step", { steps: 500 });
  assert.equal(second.step, first.step + 500);
  assert.ok(Math.abs(second.time - first.time - 0.5) < 1e-9);
  assert.equal((await client.request("sim.step")).step, second.step + 1);
});

test("several sim.step in a row are all done", async () => {
  const answers = await Promise.all([10, 20, 30].map((steps) => client.request("sim.step", { steps })));
  assert.deepEqual(
    answers.map((answer) => answer.step),
    [10, 30, 60],
  );
});

test("sim.reset goes back to the rest shape at time 0 and keeps playing or pausing", async () => {
  await client.request("stream.subscribe", { encoding: "f32" });
  const rest = await client.frame((frame) => frame.step === 0);
  await client.request("sim.step", { steps: 50 });
  const moved = await client.frame((frame) => frame.step === 50);
  assert.notDeepEqual(moved.positions, rest.positions);
  const next = client.nextFrame((frame) => frame.step !== 50);
  assert.deepEqual(await client.request("sim.reset"), { playing: false, time: 0, step: 0 });
  const again = await next;
  assert.equal(again.step, 0);
  assert.deepEqual(again.positions, rest.positions);
  await client.request("sim.play");
  assert.equal((await client.request("sim.reset")).playing, true);
});

test("a step has the same positions whoever watches, and however it was reached", async () => {
  await client.request("stream.subscribe", { encoding: "f32", rate: 120, in_flight: 8 });
  await client.request("sim.step", { steps: 300 });
  const atOnce = await client.frame((frame) => frame.step === 300);

  const alone = await Client.connect(server, { session: "other" });
  await alone.request("sim.pause");
  await alone.request("sim.reset");
  for (let i = 0; i < 10; ++i) await alone.request("sim.step", { steps: 30 });
  await alone.request("stream.subscribe", { encoding: "f32" });
  const inPieces = await alone.frame((frame) => frame.step === 300);
  assert.deepEqual(inPieces.positions, atOnce.positions);

  await alone.request("sim.reset");
  await alone.request("sim.play");
  const playing = await alone.frame((frame) => frame.step > 300);
  await alone.request("sim.pause");
  await client.request("sim.step", { steps: playing.step - 300 });
  const stepped = await client.frame((frame) => frame.step === playing.step);
  assert.deepEqual(stepped.positions, playing.positions);
  await alone.close();
});

test("sim.speed slows time down and answers the factor", async () => {
  assert.deepEqual(await client.request("sim.speed", { factor: 0.1 }), { factor: 0.1 });
  await client.request("sim.reset");
  const from = performance.now();
  await client.request("sim.play");
  await client.nextNotification("sim.status", ({ time }) => time > 0.15);
  const { time } = await client.request("sim.pause");
  const seconds = (performance.now() - from) / 1000;
  // At most what was due, and a step and a turn of the loop ahead of it; a machine may be slower.
  assert.ok(time < 0.1 * seconds + 0.05, `${time} s simulated in ${seconds} s at a tenth of the speed`);
  await client.request("sim.speed", { factor: 1 });
});

test("a speed beyond the machine slows time but answers commands at once", async () => {
  await client.request("sim.speed", { factor: 100 });
  await client.request("sim.play");
  for (let i = 0; i < 20; ++i) {
    await client.request("scene.get"); // which would wait for ever behind steps that fall behind
  }
  const status = await client.nextNotification("sim.status", (s) => s.real_time_factor > 0);
  assert.equal(status.speed, 100);
  await client.request("sim.speed", { factor: 1 });
});

test("a blow-up is a state with a remedy: told, stopped, the last good frame kept, and left by a reset", async () => {
  await client.request("scene.load", { preset: "blowup" });
  await client.request("stream.subscribe", { encoding: "q16" });
  const told = client.nextNotification("sim.diverged");
  await client.request("sim.play");
  const { reason, remedy, energy } = await told;
  assert.ok(energy.elastic && energy.found > energy.allowed && energy.time > 0, JSON.stringify(energy));
  assert.ok(reason.length > 0 && remedy.text.length > 0);
  const flagged = await client.frame((frame) => (frame.flags & 2) !== 0);
  assert.ok(
    flagged.positions.flat().every((x) => Math.abs(x) < 100),
    "that is no good frame",
  );
  assert.ok(client.frames.every((frame) => frame.positions.flat().every(Number.isFinite)));
  for (const method of ["sim.play", "sim.step"]) assert.equal((await client.refusal(method)).code, -32004);
  const status = await client.nextNotification("sim.status", (s) => s.diverged);
  assert.equal(status.playing, false);

  const late = await Client.connect(server);
  await late.request("stream.subscribe", { encoding: "q16" });
  assert.equal((await late.frame()).flags & 2, 2);
  await late.close();

  const next = client.nextFrame((frame) => frame.flags === 0);
  assert.equal((await client.request("sim.reset")).step, 0);
  assert.equal((await next).step, 0);
  assert.equal((await client.nextNotification("sim.status", (s) => s.step === 0)).diverged, false);
});

test("another scene ends a blow-up too, and plays again if it played before", async () => {
  await client.request("scene.load", { preset: "blowup" });
  const told = client.nextNotification("sim.diverged");
  await client.request("sim.play");
  await told;
  await client.request("scene.load", { preset: "seed" });
  const status = await client.nextNotification("sim.status", (s) => s.step > 0 && !s.diverged);
  assert.equal(status.playing, true);
});

test("a patch that rebuilds the cloth ends a blow-up as any other does: it plays again if it played before", async () => {
  await client.request("scene.load", { preset: "blowup" });
  const told = client.nextNotification("sim.diverged");
  await client.request("sim.play");
  const { remedy } = await told;
  const grid = { columns: 5, rows: 5, width: 0.5, height: 0.5 };
  const cloth = (await client.request("scene.get")).document.cloths[0];
  const patch = { ...remedy.patch, cloths: [{ ...cloth, mesh: { grid }, pins: [] }] };
  assert.equal((await client.request("scene.patch", { patch })).applies, "cloth");
  const status = await client.nextNotification("sim.status", (s) => s.step > 0 && !s.diverged);
  assert.equal(status.playing, true);
});
