// Valid patches that are more than the machine can step: what still works beside them. tests/bench/abuse.mjs measures
// the speed.
import assert from "node:assert/strict";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";
import { some } from "../thorough.mjs";
import { Client, Server, sleep } from "./harness.mjs";
import { heavyPatches, tooHeavy } from "./heavy.mjs";

const subscription = { encoding: "q16", rate: 60, in_flight: 2 };

/// One of each kind: many vertices, a solver, a dense search, sweeps in many dispatches, sweeps over many vertices, a
/// limit. Unless all are tried, the first two: one that takes long to build, and steps that take long.
const kinds = [
  "512x512 with self-collision",
  "10,000 Newton steps to 1e-12",
  "100x100 with a thickness of 10 m",
  "10,000 iterations of xpbd",
  "100 iterations of vbd on 300x300",
  "a strain limit that cannot be met on 200x200",
];

for (const name of some(kinds, 2))
  test(`${name}: another session's frames come, this one answers and is undone, and the server ends`, async () => {
    const server = await Server.start();
    try {
      const bystander = await Client.connect(server);
      await bystander.request("stream.subscribe", subscription);
      const heavy = await Client.connect(server, { session: "heavy" });
      await heavy.request("stream.subscribe", subscription);
      const { document } = await heavy.notification("scene");
      const applied = await heavy.request("scene.patch", { patch: heavyPatches[name] });

      // While it steps, the other session's frames keep coming, and this session tells its state, is paused and steps
      // on.
      for (let frame = 0; frame < 60; ++frame) await bystander.nextFrame();
      assert.equal((await heavy.request("scene.get")).revision, applied.revision);
      assert.equal((await heavy.request("sim.pause")).playing, false);
      const { step } = await heavy.request("sim.play");
      await bystander.nextFrame();
      assert.ok((await heavy.request("sim.pause")).step >= step);
      await heavy.request("sim.play");
      assert.equal((await server.get("/healthz")).status, 200);

      await heavy.request("scene.load", { scene: document });
      const moving = await heavy.nextFrame();
      await heavy.nextFrame((frame) => frame.step > moving.step);
      await heavy.request("scene.patch", { patch: heavyPatches[name] });
      assert.equal(await server.stop(), 0);
    } finally {
      await server.stop("SIGKILL").catch(() => {});
    }
  });

test("a scene whose every step would take minutes is refused with what to do, and the one that runs goes on", async () => {
  const server = await Server.start();
  try {
    const client = await Client.connect(server);
    await client.request("stream.subscribe", subscription);
    const refusal = await client.refusal("scene.patch", { patch: tooHeavy });
    assert.equal(refusal.code, -32602);
    assert.equal(refusal.data.path, "/self_collision/thickness");
    assert.match(refusal.data.found, /each of 1048576 vertices with about \d{4} others/);
    assert.match(refusal.data.allowed, /a thickness of about one edge, or a coarser mesh/);
    await client.nextFrame();
    assert.equal((await client.request("scene.get")).document.cloths[0].mesh.grid.columns, 25);
  } finally {
    await server.stop("SIGKILL");
  }
});

test("a change that was acknowledged in the middle of a step that takes seconds is there after kill -9", async () => {
  const folder = await mkdtemp(join(tmpdir(), "clothlab-state-"));
  try {
    const server = await Server.start("--state-dir", folder);
    const client = await Client.connect(server);
    await client.request("scene.patch", { patch: heavyPatches["10,000 iterations of vbd"] });
    const { revision } = await client.request("scene.patch", { patch: { name: "kept" } });
    const saved = () => readFile(join(folder, "main.session")).catch(() => Buffer.alloc(0));
    while (!(await saved()).includes('"kept"')) await sleep(50); // or this test runs out of time
    await server.stop("SIGKILL");
    const again = await Server.start("--state-dir", folder);
    try {
      const { document, revision: found } = await (await Client.connect(again)).request("scene.get");
      assert.equal(document.name, "kept");
      assert.equal(found, revision);
    } finally {
      await again.stop("SIGKILL");
    }
  } finally {
    await rm(folder, { recursive: true, force: true });
  }
});

test("steps asked for by number are made one for one although each takes many turns, and the last is told of", async () => {
  const server = await Server.start();
  try {
    const client = await Client.connect(server);
    await client.request("sim.pause");
    await client.request("scene.patch", { patch: { solver: { method: "xpbd", iterations: 2000 } } });
    const { step } = await client.request("sim.pause");
    const first = client.request("sim.step", { steps: 2 }),
      second = client.request("sim.step", { steps: 1 });
    assert.equal((await client.request("scene.get")).document.solver.iterations, 2000);
    assert.equal((await first).step, step + 2);
    assert.equal((await second).step, step + 3);
  } finally {
    await server.stop("SIGKILL");
  }
});
