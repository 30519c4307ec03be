// Moving colliders are drawn where the session places them at the time of the frame on screen.
import assert from "node:assert/strict";
import { browserTest, eventually, withServer } from "./browser.mjs";

const { both } = withServer();

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
    await client.request("sim.reset", {});
    await eventually(
      "half a second",
      () => viewer.read("simTime"),
      (time) => time > 0.5 && time < 5,
    );
    await client.request("sim.pause", {});
    await viewer.page.waitForTimeout(500);
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
