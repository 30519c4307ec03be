import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { Client, Server } from "./harness.mjs";

let server, client;
before(async () => (server = await Server.start()));
after(() => server.stop());
beforeEach(async () => {
  client = await Client.connect(server);
  await client.notification("scene");
  await client.request("scene.load", { preset: "seed" });
  await client.request("sim.play");
});
afterEach(() => client.close());

/// Whether so many frames have taken as long as they must at this rate. Of those in flight one may have been due
/// before, and none is sooner than nine tenths of an interval after the one before it; how much later they are is the
/// machine's.
const notFaster = ({ frames, seconds }, rate) =>
  assert.ok(
    seconds > (0.9 * (frames.length - 2)) / rate,
    `${frames.length} frames in ${seconds} s at ${rate} a second`,
  );

test("nothing binary comes before stream.subscribe", async () => {
  await client.statuses(4);
  assert.equal(client.binary.length, 0);
});

test("subscribe answers what was agreed, with defaults", async () => {
  assert.deepEqual(await client.request("stream.subscribe"), { encoding: "q16", rate: 60, in_flight: 2 });
  assert.deepEqual(await client.request("stream.subscribe", { encoding: "f32", rate: 30, in_flight: 8 }), {
    encoding: "f32",
    rate: 30,
    in_flight: 8,
  });
});

test("the topology comes before the first frame and fits it and the scene", async () => {
  await client.request("stream.subscribe");
  const frame = await client.frame();
  assert.equal(client.binary[0].kind, 1);
  const [topology] = client.topologies;
  assert.equal(topology.vertexCount, 625);
  assert.equal(topology.topologyRevision, frame.topologyRevision);
  assert.equal(topology.triangles.length, 2 * 24 * 24);
  assert.deepEqual(topology.cloths, [{ firstVertex: 0, vertexCount: 625 }]);
  // Cell (0, 0): (c,r) (c,r+1) (c+1,r+1) and (c,r) (c+1,r+1) (c+1,r), vertex = row * columns + column.
  assert.deepEqual(topology.triangles.slice(0, 2), [
    [0, 25, 26],
    [0, 26, 1],
  ]);
  assert.ok(topology.texture.flat().every((t) => t >= 0 && t <= 1));
  assert.equal(frame.range, 0);
});

test("the rest shape arrives as the scene describes it, in both encodings", async () => {
  await client.request("sim.pause");
  await client.request("sim.reset");
  for (const encoding of ["f32", "q16"]) {
    await client.request("stream.subscribe", { encoding });
    const frame = await client.frame((f) => f.encoding === (encoding === "f32" ? 0 : 1));
    assert.equal(frame.step, 0);
    assert.equal(frame.time, 0);
    // q16 rounds to 1/65535 of the box; half a step, and as much again for float32.
    const bound = encoding === "f32" ? 1e-6 : Math.max(...frame.boxExtent) / 65535;
    for (let row = 0; row < 25; ++row) {
      for (let column = 0; column < 25; ++column) {
        const [x, y, z] = frame.positions[row * 25 + column];
        assert.ok(
          Math.abs(x - (-0.5 + column / 24)) <= bound && Math.abs(y - 1) <= bound && Math.abs(z - row / 24) <= bound,
        );
      }
    }
    // A flat cloth, counter-clockwise seen from above: every normal points up. q16 has 127 steps per half axis.
    for (const [x, y, z] of frame.normals) assert.ok(y > 0.999 && Math.hypot(x, z) < 0.02, `${x} ${y} ${z}`);
  }
});

test("both encodings show the same state", async () => {
  await client.request("sim.step", { steps: 250 });
  await client.request("stream.subscribe", { encoding: "f32" });
  const exact = await client.frame((frame) => frame.encoding === 0);
  await client.request("stream.subscribe", { encoding: "q16" });
  const rounded = await client.frame((frame) => frame.encoding === 1);
  assert.equal(rounded.step, exact.step);
  assert.equal(rounded.topologyRevision, exact.topologyRevision);
  for (let i = 0; i < exact.vertexCount; ++i) {
    for (let axis = 0; axis < 3; ++axis) {
      // Half a quantum, and the rounding of float32 in min and extent.
      const bound = (rounded.boxExtent[axis] / 65535) * 0.51 + 1e-6;
      assert.ok(Math.abs(rounded.positions[i][axis] - exact.positions[i][axis]) <= bound);
    }
    const cosine = exact.normals[i].reduce((sum, n, axis) => sum + n * rounded.normals[i][axis], 0);
    assert.ok(cosine > 0.999, `normal ${i}: ${cosine}`);
  }
});

test("c16 has the positions of q16 in the same step, bit for bit, and the same field; it is compressed", async () => {
  // A grid, and the triangles of a file; at rest, and after steps that have bent it.
  for (const preset of ["seed", "poncho"])
    for (const steps of [0, 40]) {
      await client.request("stream.unsubscribe");
      client.binary = [];
      await client.request("scene.load", { preset });
      await client.request("sim.pause");
      await client.request("sim.reset");
      if (steps > 0) await client.request("sim.step", { steps });
      for (const field of ["none", "strain"]) {
        const frames = {};
        for (const encoding of ["q16", "c16"]) {
          await client.request("stream.subscribe", { encoding, field });
          frames[encoding] = await client.frame(
            (frame) => frame.encoding === (encoding === "q16" ? 1 : 2) && frame.range > 0 === (field !== "none"),
          );
        }
        const { q16, c16 } = frames;
        assert.deepEqual(c16.quantised, q16.quantised);
        for (const key of [
          "step",
          "time",
          "boxMinimum",
          "boxExtent",
          "topologyRevision",
          "vertexCount",
          "flags",
          "range",
        ])
          assert.deepEqual(c16[key], q16[key], key);
        assert.deepEqual(c16.field, q16.field);
        assert.ok(c16.payloadBytes < 0.8 * q16.payloadBytes, `${c16.payloadBytes} of ${q16.payloadBytes} bytes`);
      }
    }
});

test("c16 frames come at the rate that was asked for, beside other encodings, and their time goes on", async () => {
  const other = await Client.connect(server);
  await other.request("stream.subscribe", { encoding: "q16", rate: 30 });
  await client.request("stream.subscribe", { encoding: "c16", rate: 30 });
  await client.frame();
  const taken = await client.nextFrames(45);
  notFaster(taken, 30);
  const { frames } = taken;
  for (let i = 1; i < frames.length; ++i) assert.ok(frames[i].step > frames[i - 1].step);
  await other.nextFrames(20);
  await other.close();
});

test("sequence numbers, steps and time rise from frame to frame", async () => {
  await client.request("stream.subscribe");
  await client.until(
    () => client.frames.slice(20),
    () => true,
    "20 frames",
  );
  const { frames } = client;
  for (let i = 1; i < frames.length; ++i) {
    assert.ok(frames[i].sequence > frames[i - 1].sequence);
    assert.ok(frames[i].step > frames[i - 1].step);
    assert.ok(Math.abs(frames[i].time - frames[i].step * 0.001) < 1e-9);
  }
});

test("a viewer gets frames at the rate it asked for, no faster", async () => {
  await client.request("stream.subscribe", { rate: 10, in_flight: 8 });
  await client.frame();
  notFaster(await client.nextFrames(20), 10);
});

test("while paused nothing is sent, unless something changes or somebody subscribes", async () => {
  await client.request("stream.subscribe");
  await client.frame();
  const { step } = await client.request("sim.pause");
  await client.frame((frame) => frame.step === step);
  await client.statuses(3); // a second frame of the same step may be on its way
  const count = client.frames.length;
  await client.statuses(5);
  assert.equal(client.frames.length, count);
  const other = await Client.connect(server);
  await other.request("stream.subscribe");
  assert.equal((await other.frame()).step, step);
  const next = client.nextFrame();
  await client.request("scene.patch", { patch: { gravity: [0, -1, 0] } });
  assert.equal((await next).step, step);
  await other.close();
});

test("unsubscribe stops frames; subscribing again brings the topology and frames again", async () => {
  await client.request("stream.subscribe");
  await client.frame();
  assert.deepEqual(await client.request("stream.unsubscribe"), {});
  const count = client.binary.length;
  await client.statuses(4);
  assert.equal(client.binary.length, count);
  const next = client.nextFrame();
  await client.request("stream.subscribe");
  await next;
  assert.equal(client.binary[count].kind, 1);
});

test("a rebuilt cloth sends its topology before the first frame that needs it", async () => {
  await client.request("stream.subscribe");
  const before = await client.frame();
  await client.request("scene.patch", { patch: [{ op: "replace", path: "/cloths/0/mesh/grid/rows", value: 30 }] });
  await client.frame((frame) => frame.vertexCount === 750);
  const first = client.binary.findIndex((message) => message.vertexCount === 750);
  assert.equal(client.binary[first].kind, 1);
  assert.notEqual(client.binary[first].topologyRevision, before.topologyRevision);
  let current;
  for (const message of client.binary) {
    if (message.kind === 1) current = message.topologyRevision;
    else assert.equal(message.topologyRevision, current);
  }
});

test("without acknowledgements only in_flight frames come; one acknowledges all before it", async () => {
  client.acknowledge = false;
  await client.request("stream.subscribe", { in_flight: 3 });
  await client.until(
    () => client.frames.slice(2),
    () => true,
    "3 frames",
  );
  await client.statuses(4);
  assert.equal(client.frames.length, 3);
  client.notify("stream.ack", { frame: client.frames[2].sequence });
  await client.until(
    () => client.frames.slice(5),
    () => true,
    "3 more frames",
  );
  await client.statuses(4);
  assert.equal(client.frames.length, 6);
  client.notify("stream.ack", { frame: client.frames[4].sequence });
  await client.until(
    () => client.frames.slice(7),
    () => true,
    "2 more frames",
  );
  client.notify("stream.ack", { frame: 4_000_000_000 }); // never sent: acknowledges nothing
  await client.statuses(4);
  assert.equal(client.frames.length, 8);
});

test("a viewer that stops acknowledging costs the others nothing, and resumes with a fresh frame", async () => {
  const stuck = await Client.connect(server, { acknowledge: false });
  await stuck.request("stream.subscribe", { in_flight: 2 });
  await stuck.until(
    () => stuck.frames.slice(1),
    () => true,
    "2 frames",
  );
  await client.request("stream.subscribe", { rate: 60, in_flight: 4 });
  await client.nextFrames(150);
  assert.equal(stuck.frames.length, 2);
  const newest = client.frames.at(-1);
  const resumed = stuck.nextFrame();
  stuck.notify("stream.ack", { frame: stuck.frames[1].sequence });
  assert.ok((await resumed).step >= newest.step, "the frame is older than what the others already had");
  assert.ok((await resumed).step > stuck.frames[1].step + 100);
  await stuck.close();
});

test("a viewer that stops reading is cut off or catches up, and the others go on", async () => {
  const deaf = await Client.connect(server);
  await deaf.request("stream.subscribe", { rate: 120, in_flight: 8 });
  await deaf.frame();
  deaf.socket.pause();
  await client.request("stream.subscribe");
  await client.nextFrames(100);
  deaf.socket.resume();
  const { step } = client.frames.at(-1);
  await deaf.frame((frame) => frame.step >= step);
  await deaf.close();
});
