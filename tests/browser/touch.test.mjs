// The camera by touch, as three.js has it: one finger beside the cloth orbits, two pinch and move.
import assert from "node:assert/strict";
import { browserTest, eventually, withServer } from "./browser.mjs";

const here = withServer();
const [width, height] = [390, 844];

/// A phone's page, paused, with a function that draws fingers along lines.
async function phone(session) {
  const { viewer, client } = await here.both(session, { width, height, hasTouch: true });
  await client.request("sim.pause", {});
  await viewer.until(() => !document.getElementById("play").disabled);
  await viewer.page.waitForTimeout(300);
  const cdp = await viewer.page.context().newCDPSession(viewer.page);
  const touch = (type, points) =>
    cdp.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const drag = async (from, to, steps = 10) => {
    await touch("touchStart", from);
    for (let i = 1; i <= steps; ++i) {
      const between = (finger, axis) => from[finger][axis] + ((to[finger][axis] - from[finger][axis]) * i) / steps;
      await touch(
        "touchMove",
        from.map((_, finger) => [between(finger, 0), between(finger, 1)]),
      );
      await viewer.page.waitForTimeout(20);
    }
    await touch("touchEnd", []);
  };
  return { viewer, client, drag };
}

/// The camera, once it has stopped; `along` is where the point that was its target at first is now seen [px].
async function still({ page }, target = null) {
  const read = () =>
    page.evaluate(async (point) => {
      for (let frame = 0; frame < 3; ++frame) await new Promise(requestAnimationFrame);
      const { controls, camera } = window.clothlab.stage;
      camera.updateMatrixWorld();
      const seen = controls.target.clone();
      if (point) seen.fromArray(point);
      seen.project(camera);
      return {
        azimuth: controls.getAzimuthalAngle(),
        polar: controls.getPolarAngle(),
        distance: controls.getDistance(),
        target: controls.target.toArray(),
        at: [((seen.x + 1) / 2) * innerWidth, ((1 - seen.y) / 2) * innerHeight],
      };
    }, target);
  let last = await read();
  return eventually("the camera at rest", read, (now) => {
    const rests = JSON.stringify(now) === JSON.stringify(last);
    last = now;
    return rests;
  });
}
const near = (a, b, most) => assert.ok(Math.abs(a - b) <= most, `${a} is not within ${most} of ${b}`);

browserTest("one finger orbits: a drag over the whole height is a full turn", async () => {
  const { viewer, client, drag } = await phone("orbit");
  const before = await still(viewer);
  await drag([[40, 110]], [[120, 140]]);
  const after = await still(viewer);
  near(after.azimuth, before.azimuth - (2 * Math.PI * 80) / height, 0.01);
  near(after.polar, before.polar - (2 * Math.PI * 30) / height, 0.01);
  near(after.distance / before.distance, 1, 1e-3);
  await client.close();
});

browserTest("two fingers that part come nearer, in proportion", async () => {
  const { viewer, client, drag } = await phone("pinch");
  const before = await still(viewer);
  await drag(
    [
      [170, 300],
      [220, 300],
    ],
    [
      [145, 300],
      [245, 300],
    ],
  );
  const after = await still(viewer);
  near(after.distance / before.distance, 0.5, 0.02);
  near(after.azimuth, before.azimuth, 0.01);
  await client.close();
});

browserTest("two fingers that go together take the picture along", async () => {
  const { viewer, client, drag } = await phone("pan");
  const before = await still(viewer);
  await drag(
    [
      [170, 300],
      [220, 300],
    ],
    [
      [210, 330],
      [260, 330],
    ],
  );
  const after = await still(viewer, before.target);
  near(after.distance / before.distance, 1, 0.01);
  near(after.at[0], before.at[0] + 40, 2);
  near(after.at[1], before.at[1] + 30, 2);
  await client.close();
});
