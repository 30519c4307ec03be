// The place of a moving collider comes with each frame, by the closed forms of server/scene/README.md: a client need
// not compute motions itself.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Client, Server } from "./harness.mjs";

let server;
before(async () => {
  server = await Server.start();
});
after(() => server.stop());

const spin = { axis: [0, 0, 2], center: [0, 1, 0], degrees_per_second: 90 };
const colliders = [
  { name: "still", sphere: { center: [0, -1, 0], radius: 0.2 } },
  { name: "wheel", plane: { point: [0.5, 1, 0], normal: [0, 3, 0] }, motion: { spin } },
  {
    name: "pendulum",
    sphere: { center: [1, 0, 0], radius: 0.1 },
    motion: { oscillate: { axis: [0, 0, 1], amplitude: 0.2, frequency: 0.5 } },
  },
  { name: "cart", sphere: { center: [2, 0, 0], radius: 0.1 }, motion: { linear: { velocity: [0.5, 0, -0.25] } } },
  { name: "arm", capsule: { a: [0, 1, 0], b: [0.5, 1, 0.2], radius: 0.1 }, motion: { spin } },
  {
    name: "kite",
    mesh: {
      vertices: [
        [9, 0, 0],
        [10, 0, 0],
        [9, 0, 1],
      ],
      triangles: [[0, 1, 2]],
    },
    transform: { translate: [0, 5, 0], rotate: [0, 0, 10], scale: 2 },
    motion: { spin },
  },
  { name: "plank", box: { center: [1, 1, 0], half: [0.3, 0.1, 0.2], rotate: [30, 0, 10] }, motion: { spin } },
];
const near = (found, wanted, what) =>
  found.forEach((value, axis) =>
    assert.ok(Math.abs(value - wanted[axis]) < 1e-9, `${what}: ${found} is not ${wanted}`),
  );

for (const encoding of ["f32", "q16"])
  test(`before each ${encoding} frame the session tells where what moves is: what spins has turned, too`, async () => {
    const client = await Client.connect(server, { session: encoding });
    // A cloth of few vertices: what moves goes through it.
    const grid = { columns: 4, rows: 4, width: 1, height: 1 };
    const few = [
      { op: "replace", path: "/cloths/0/pins", value: [{ at: "corner:0,0" }] },
      { op: "replace", path: "/cloths/0/mesh", value: { grid } },
    ];
    await client.request("scene.patch", { patch: few });
    await client.request("scene.patch", { patch: { colliders } });
    await client.request("stream.subscribe", { encoding, rate: 60, in_flight: 2 });
    const frame = await client.frame(({ time }) => time > 0.4);
    const told = client.messages.filter(({ method }) => method === "colliders").map(({ params }) => params);
    const { time, step, moving } = told.find((each) => each.step === frame.step);
    assert.equal(time, frame.time);
    assert.deepEqual(
      moving.map(({ index }) => index),
      [1, 2, 3, 4, 5, 6],
    ); // a still collider stays where the scene places it
    const angle = (Math.PI / 2) * time;
    near(
      moving[0].plane.point,
      [0.5 * Math.cos(angle), 1 + 0.5 * Math.sin(angle), 0],
      `the wheel's point after ${step} steps`,
    );
    near(moving[0].plane.normal, [-Math.sin(angle), Math.cos(angle), 0], "the wheel's normal");
    near(moving[1].sphere.center, [1, 0, 0.2 * Math.sin(Math.PI * time)], "the pendulum");
    near(moving[2].sphere.center, [2 + 0.5 * time, 0, -0.25 * time], "the cart");
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    near(moving[3].capsule.a, [0, 1, 0], "the arm's end on the axis");
    near(moving[3].capsule.b, [0.5 * cos, 1 + 0.5 * sin, 0.2], "the arm's other end");
    near([moving[3].capsule.radius], [0.1], "the arm's radius");
    const kite = moving[4];
    assert.deepEqual(Object.keys(kite).sort(), ["index", "transform"]); // its triangles are not told again
    near(kite.transform.translate, [-4 * sin, 1 + 4 * cos, 0], "the kite's place");
    const away = kite.transform.rotate.map((value, axis) => (value - [0, 0, 10 + 90 * time][axis]) * (Math.PI / 180));
    near(away.map(Math.cos), [1, 1, 1], "the kite's turn");
    near([kite.transform.scale], [2], "the kite's scale");
    near(moving[5].box.center, [cos, 1 + sin, 0], "the plank's center");
    near(moving[5].box.half, [0.3, 0.1, 0.2], "the plank's edges");
    // It spins about the axis that it is turned about last.
    const turned = moving[5].box.rotate;
    near([turned[0], turned[1], Math.cos(((turned[2] - 10) * Math.PI) / 180)], [30, 0, cos], "the plank's turn");
    await client.close();
  });

test("a scene in which no collider moves has no such message", async () => {
  const client = await Client.connect(server, { session: "still" });
  await client.request("scene.patch", { patch: { colliders: colliders.slice(0, 1) } });
  await client.request("stream.subscribe", { encoding: "q16", rate: 60, in_flight: 2 });
  const { step } = await client.frame();
  await client.nextFrame((frame) => frame.step > step);
  assert.deepEqual(
    client.messages.filter(({ method }) => method === "colliders"),
    [],
  );
  await client.close();
});
