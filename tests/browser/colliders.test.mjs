// Moving colliders are drawn where the session places them at the time of the frame on screen.
import assert from "node:assert/strict";
import { browserTest, eventually, withServer } from "./browser.mjs";

const { both } = withServer();

/// Starts anew, pauses half a second of the scene's time later, and waits until the page shows the last frame.
async function stopAfterHalfASecond(viewer, client) {
  await client.request("sim.reset", {});
  await eventually(
    "half a second",
    () => viewer.read("simTime"),
    (time) => time > 0.5 && time < 5,
  );
  await client.request("sim.pause", {});
  await viewer.page.waitForTimeout(500);
}

browserTest(
  "a capsule and a box that spin are on the screen where the session says, and turned as it says",
  async () => {
    const { viewer, client } = await both("bodies");
    const spin = { axis: [0, 1, 0], center: [0, 0.2, 0], degrees_per_second: 60 };
    await client.request("scene.patch", {
      patch: {
        colliders: [
          { capsule: { a: [0.2, 0.2, 0], b: [0.6, 0.4, 0], radius: 0.1 }, motion: { spin } },
          { box: { center: [0, 0.2, 0], half: [0.2, 0.1, 0.15], rotate: [20, 30, 40] }, motion: { spin } },
          { box: { center: [0, -0.4, 0], half: [0.2, 0.1, 0.15], rotate: [20, 30, 40] } },
        ],
      },
    });
    await viewer.until(() => window.clothlab.document?.colliders.length === 3);
    await stopAfterHalfASecond(viewer, client);
    const seen = await viewer.page.evaluate(() => {
      const { stage, simTime } = window.clothlab;
      const at = (mesh, ...point) => mesh.localToWorld(mesh.position.clone().set(...point)).toArray();
      const [capsule, box, still] = stage.colliders.shown.map(({ mesh }) => mesh);
      for (const mesh of [capsule, box, still]) mesh.updateMatrixWorld();
      // A capsule's geometry is along its own y axis, in radii; a box's edges are along its own axes.
      const half = Math.hypot(0.4, 0.2) / 2 / capsule.scale.y;
      return {
        time: simTime,
        ends: [at(capsule, 0, -half, 0), at(capsule, 0, half, 0)],
        length: capsule.geometry.parameters.height * capsule.scale.y,
        corner: at(box, 0.2, 0.1, 0.15),
        still: at(still, 0.2, 0.1, 0.15),
      };
    });
    const near = (found, wanted, what) =>
      assert.ok(
        Math.hypot(...found.map((value, axis) => value - wanted[axis])) < 1e-6,
        `${what} at ${seen.time} s: ${found}, not ${wanted}`,
      );
    const about = (axis, degrees) => (v) => {
      const [p, q] = [(axis + 1) % 3, (axis + 2) % 3];
      const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
      const turned = [...v];
      [turned[p], turned[q]] = [c * v[p] - s * v[q], s * v[p] + c * v[q]];
      return turned;
    };
    const spun = about(1, 60 * seen.time);
    near([seen.length], [Math.hypot(0.4, 0.2)], "the capsule's length");
    near(seen.ends[0], spun([0.2, 0.2, 0]), "the capsule's one end");
    near(seen.ends[1], spun([0.6, 0.4, 0]), "the capsule's other end");
    const corner = about(2, 40)(about(1, 30)(about(0, 20)([0.2, 0.1, 0.15])));
    near(
      seen.corner,
      spun(corner).map((value, axis) => value + [0, 0.2, 0][axis]),
      "the box's corner",
    );
    near(
      seen.still,
      corner.map((value, axis) => value + [0, -0.4, 0][axis]),
      "the still box's corner",
    );
  },
);

browserTest(
  "a plane that spins turns on the screen, and a sphere that swings is where it is in the frame",
  async () => {
    const { viewer, client } = await both("spinning");
    const spin = { axis: [0, 0, 1], center: [0, 0.2, 0], degrees_per_second: 60 };
    const oscillate = { axis: [1, 0, 0], amplitude: 0.3, frequency: 0.5 };
    await client.request("scene.patch", {
      patch: {
        colliders: [
          { name: "table", plane: { point: [0.3, 0.2, 0], normal: [0, 1, 0] }, motion: { spin } },
          { name: "ball", sphere: { center: [0, 0.6, 0], radius: 0.2 }, motion: { oscillate } },
        ],
      },
    });
    await viewer.until(() => window.clothlab.document?.colliders.length === 2);
    await stopAfterHalfASecond(viewer, client);
    const { time, normal, table, ball } = await viewer.page.evaluate(() => {
      const { stage, simTime } = window.clothlab;
      const [table, ball] = stage.colliders.shown.map(({ mesh }) => mesh);
      // A disc faces along its own z axis.
      const normal = table.position.clone().set(0, 0, 1).applyQuaternion(table.quaternion).toArray();
      return { time: simTime, normal, table: table.position.toArray(), ball: ball.position.toArray() };
    });
    const near = (found, wanted, what) =>
      assert.ok(
        Math.hypot(...found.map((value, axis) => value - wanted[axis])) < 1e-6,
        `${what} at ${time} s: ${found}, not ${wanted}`,
      );
    const angle = (Math.PI / 3) * time;
    near(normal, [-Math.sin(angle), Math.cos(angle), 0], "the table's normal");
    near(table, [0.3 * Math.cos(angle), 0.2 + 0.3 * Math.sin(angle), 0], "the table's point");
    near(ball, [0.3 * Math.sin(Math.PI * time), 0.6, 0], "the ball");
  },
);
