// A session goes on from an earlier step: with the same bytes as then, through changes and hands.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { thorough } from "../thorough.mjs";
import { Client, Server } from "./harness.mjs";
import { strip } from "./strip.mjs";

let server;
before(async () => (server = await Server.start("--max-sessions", "16", "--scene", "hanging-strip")));
after(() => server.stop());

let sessions = 0;
async function enter(scene) {
  const client = await Client.connect(server, { session: `timeline-${++sessions}` });
  await client.notification("scene");
  await client.request("sim.pause");
  await client.request("scene.load", typeof scene === "string" ? { preset: scene } : { scene });
  await client.request("stream.subscribe", { encoding: "f32", rate: 120, in_flight: 8 });
  return client;
}

const bytesOf = ({ positions, normals }) =>
  Buffer.from(new Float32Array([...positions, ...normals].flat()).buffer).toString("base64");
/// Steps the paused session to a step, and returns the frame there as text.
async function stepTo(client, step) {
  const seen = client.frames.at(-1)?.sequence ?? 0;
  const { step: now } = await client.request("sim.step", { steps: 1 });
  if (step > now) await client.request("sim.step", { steps: step - now });
  return bytesOf(await client.frame((frame) => frame.sequence > seen && frame.step === step));
}
async function resume(client, step) {
  const seen = client.frames.at(-1)?.sequence ?? 0;
  const answer = await client.request("timeline.resume", { step });
  assert.deepEqual([answer.step, answer.playing], [step, false]);
  return bytesOf(await client.frame((frame) => frame.sequence > seen && frame.step === step));
}
const patch = (client, operations) => client.request("scene.patch", { patch: operations });

// The preset with a quarter of the columns and rows: implicit Euler takes its time.
const curtain = JSON.parse(readFileSync(new URL("../../server/scene/presets/curtain.json", import.meta.url)));
Object.assign(curtain.cloths[0].mesh.grid, { columns: 9, rows: 7 });
curtain.cloths[0].pins.length = 3;
const limited = strip(9);
limited.cloths[0].material.strain_limit = 0.1;
const cases = {
  seed: ["seed", {}],
  "verlet, surfaces that touch": [
    { ...strip(9), self_collision: { kind: "surface", thickness: 0.004 } },
    { solver: { method: "verlet", dt: 0.0002 } },
  ],
  "implicit Euler, a curtain that a ball moves": [curtain, { solver: { method: "implicit_euler", dt: 0.004 } }],
  "BDF2, a curtain that a ball moves": [curtain, { solver: { method: "bdf2", dt: 0.004 } }],
  VBD: [strip(9), { solver: { method: "vbd", dt: 0.002 } }],
  "a strain limit": [limited, { solver: { dt: 0.0001 } }],
};
// Unless all are tried, one that searches pairs, one that remembers the step before, and one that sweeps.
const dearest = ["seed", "implicit Euler, a curtain that a ball moves", "a strain limit"];
for (const [name, [scene, start]] of Object.entries(cases).filter(([name]) => thorough || !dearest.includes(name)))
  test(`${name}: a step is reached again with the same bytes, through changes and a hand, and so is what follows`, async () => {
    const client = await enter(scene);
    await patch(client, start);
    const changes = {
      150: () => patch(client, { gravity: [0.5, -6, 0] }),
      230: () =>
        client.request("grab.start", {
          cloth: 0,
          vertex: name.includes("curtain") ? 31 : 12,
          target: [0.1, 0.2, 0.3],
        }),
      260: () => client.request("grab.move", { target: [0.2, 0.4, 0.3] }),
      300: () => client.request("grab.end"),
      320: () =>
        patch(client, [
          {
            op: "add",
            path: "/cloths/0/pins/-",
            value: {
              at: `vertex:${name.includes("curtain") ? 50 : 8}`,
              place: scene.name === "strip" ? [0.05, 0, 0.1] : [0, 0.5, 0],
            },
          },
        ]),
      400: () => patch(client, { solver: { dt: start.solver ? start.solver.dt / 2 : 0.0005 } }),
      470: () => patch(client, { air_drag: 0.5 }),
    };
    const marks = [140, 240, 290, 310, 330, 450, 1020, 1100, 1200];
    const run = async (from, told) => {
      for (const step of [...new Set([...Object.keys(changes).map(Number), ...marks])].sort((a, b) => a - b)) {
        if (step < from) continue;
        if (step > from) told[step] = await stepTo(client, step);
        await changes[step]?.();
      }
    };
    const first = {};
    await run(0, first);
    assert.ok(new Set(Object.values(first)).size > marks.length, "the cloth moves");
    const { oldest, newest, states } = await client.request("timeline.get");
    assert.deepEqual([oldest.step, newest.step], [0, 1200]);
    assert.ok(states >= 2, `${states} states`);
    for (const step of [1200, 1100, 1020, 450, 330, 310, 140])
      assert.equal(await resume(client, step), first[step], `step ${step}`);
    const second = {};
    await run(140, second);
    for (const step of Object.keys(second)) assert.equal(second[step], first[step], `step ${step} the second time`);
    await client.close();
  });

test("a session that plays is brought back to a frame that was seen, with the scene of that moment", async () => {
  const client = await enter("seed");
  await client.request("sim.play");
  await client.frame(({ step }) => step > 300);
  await patch(client, { gravity: [1, -3, 0] });
  await client.frame(({ step }) => step > 600);
  await patch(client, [{ op: "replace", path: "/cloths/0/material/structural", value: 9000 }]);
  await client.frame(({ step }) => step > 1300);
  await client.request("sim.pause");
  const { revision } = await client.request("scene.get");
  const seen = client.frames.filter(({ step }) => step > 0).reverse();
  const at = (step) => seen.find((frame) => frame.step <= step);
  for (const step of [1200, 1010, 620, 310, 100]) {
    const frame = at(step);
    const scene = client.nextNotification("scene");
    assert.equal(await resume(client, frame.step), bytesOf(frame), `step ${frame.step}`);
    await scene;
  }
  const { document, revision: now } = await client.request("scene.get");
  assert.equal(now, revision + 5);
  assert.deepEqual([document.gravity, document.cloths[0].material.structural], [[0, -9.8, 0], 20000]);
  const { undo } = client.messages.findLast(({ method }) => method === "scene.history").params;
  assert.match(undo, /^Go on from 0\.\d\d s$/);
  await client.close();
});

test("a pin that was taken off is back before, and a hand of then holds no longer", async () => {
  const client = await enter(strip(9));
  const pins = async () => (await client.request("scene.get")).document.cloths[0].pins.length;
  await patch(client, [{ op: "add", path: "/cloths/0/pins/-", value: { at: "vertex:13", place: [0, 0, 0.1] } }]);
  await stepTo(client, 50);
  await client.request("grab.start", { cloth: 0, vertex: 20, target: [0, 1, 0] });
  const before = await stepTo(client, 100);
  await client.request("sim.step", { steps: 1 });
  await client.request("grab.end");
  await patch(client, [{ op: "remove", path: "/cloths/0/pins/1" }]);
  const after = await stepTo(client, 300);
  assert.equal(await pins(), 1);
  assert.equal(await resume(client, 300), after);
  assert.equal(await resume(client, 100), before);
  assert.equal(await pins(), 2);
  await client.nextNotification("sim.status", ({ hands, step }) => step === 100 && hands.length === 0);
  assert.equal((await client.refusal("grab.move", { target: [0, 0, 0] })).data.path, "/hand");
  await client.close();
});

test("after a blow-up the timeline goes on from the last good state, and what was before is still reached", async () => {
  const client = await enter(strip(9));
  const early = await stepTo(client, 700);
  await patch(client, { solver: { dt: 0.02 } });
  const diverged = client.nextNotification("sim.diverged");
  await client.request("sim.play");
  await diverged;
  await client.request("sim.pause");
  await patch(client, { solver: { dt: 0.0002 } });
  const { newest } = await client.request("timeline.get");
  const later = await stepTo(client, newest.step + 400);
  assert.equal(await resume(client, newest.step + 400), later);
  assert.equal(await resume(client, 700), early);
  await client.close();
});

test("going back is undone: the run that was left is there again, bit for bit, with all that came in it", async () => {
  const client = await enter(strip(9));
  const nothing = await client.refusal("timeline.resume", { undo: true });
  assert.match(nothing.message, /no run that timeline.resume has left/);
  const early = await stepTo(client, 400);
  await patch(client, { gravity: [0, -3, 0] });
  const middle = await stepTo(client, 1500);
  await patch(client, { gravity: [0, -5, 0] });
  const late = await stepTo(client, 2300);
  const undo = async (step) => {
    const seen = client.frames.at(-1)?.sequence ?? 0;
    const answer = await client.request("timeline.resume", { undo: true });
    assert.deepEqual([answer.step, answer.playing], [step, false]);
    return bytesOf(await client.frame((frame) => frame.sequence > seen && frame.step === step));
  };
  const gravity = async () => (await client.request("scene.get")).document.gravity[1];

  assert.equal(await resume(client, 400), early);
  await patch(client, { gravity: [0, 4, 0] }); // at the step from which the run goes on
  const other = await stepTo(client, 2600); // beyond where it was left
  assert.notEqual(other, late);
  assert.equal(await undo(2300), late);
  assert.equal(await gravity(), -5);
  assert.equal(await resume(client, 1500), middle, "the steps before are those of the run that is back");
  assert.equal(await undo(2300), late);
  assert.equal(await undo(1500), middle, "what is undone is kept in its turn");
  await stepTo(client, 1501);

  await resume(client, 1400);
  await client.request("sim.reset");
  assert.match((await client.refusal("timeline.resume", { undo: true })).message, /no run/);
  await client.close();
});

test("a reset begins the timeline anew, and a step outside of it is refused with what it has", async () => {
  const client = await enter(strip(5));
  await stepTo(client, 90);
  const { code, data } = await client.refusal("timeline.resume", { step: 91 });
  assert.deepEqual([code, data.path, data.found], [-32602, "/step", "91"]);
  assert.match(data.allowed, /0 to 90/);
  await client.request("sim.reset");
  await stepTo(client, 5);
  const { oldest, newest, states, bytes } = await client.request("timeline.get");
  assert.deepEqual([oldest, newest.step, states], [{ step: 0, time: 0 }, 5, 1]);
  const { limits } = await client.notification("hello");
  assert.ok(bytes > 0 && bytes < limits.timeline.bytes && states <= limits.timeline.states);
  await client.close();
});

test("others are told that the scene is as it was, and what they ask meanwhile is done after", async () => {
  const client = await enter("seed");
  const other = await Client.connect(server, { session: `timeline-${sessions}` });
  await other.notification("scene");
  await stepTo(client, 10);
  await patch(client, { gravity: [0, -1, 0] });
  await stepTo(client, 990);
  await patch(client, { gravity: [0, -2, 0] });
  const scene = other.nextNotification("scene");
  const [answer, changed] = await Promise.all([
    client.request("timeline.resume", { step: 989 }),
    client.request("scene.patch", { patch: { air_drag: 1 } }),
  ]);
  assert.equal((await scene).revision, answer.revision);
  assert.equal(changed.revision, answer.revision + 1);
  const { document } = await other.request("scene.get");
  assert.deepEqual([document.gravity[1], document.air_drag], [-1, 1]);
  await Promise.all([client.close(), other.close()]);
});

test("a session that has blown up goes on from before it", async () => {
  const client = await enter(strip(9));
  const early = await stepTo(client, 300);
  await client.request("sim.step", { steps: 1 });
  await patch(client, { solver: { dt: 0.02 } });
  const diverged = client.nextNotification("sim.diverged");
  await client.request("sim.play");
  await diverged;
  assert.equal(await resume(client, 300), early);
  await client.nextNotification("sim.status", (status) => !status.diverged && !status.playing && status.step === 300);
  assert.equal((await client.request("scene.get")).document.solver.dt, 0.0002);
  await client.request("sim.play");
  await client.frame(({ step, flags }) => step > 400 && flags === 0);
  await client.close();
});
