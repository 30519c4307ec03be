import assert from "node:assert/strict";
import { browserTest, withServer } from "./browser.mjs";

const { open } = withServer();

browserTest("the cloth is on the screen: a large, shaded, red surface where the seed scene hangs", async () => {
  const viewer = await open({ session: "drawn", sharp: true });
  await viewer.until(() => window.clothlab.simTime > 0.7);
  await viewer.page.waitForTimeout(400); // past the fade-in
  const seen = await viewer.cloth();
  assert.ok(seen.share > 0.03 && seen.share < 0.9, `the cloth covers ${(100 * seen.share).toFixed(1)} % of the middle`);
  assert.ok(seen.shades > 50, `light, weave and folds give many shades; there are ${seen.shades}`);
});

browserTest("the cloth moves: two screenshots a moment apart differ, and it has fallen", async () => {
  const viewer = await open({ session: "moves", sharp: true });
  await viewer.page.waitForTimeout(400);
  const before = await viewer.cloth();
  const time = await viewer.read("simTime");
  await viewer.until((from) => window.clothlab.simTime > from + 0.3, time);
  const after = await viewer.cloth();
  assert.notEqual(before.checksum, after.checksum);
  const lowest = Math.min(...(await viewer.positions()).map(([, y]) => y));
  assert.ok(lowest < 0.6, `it started at y = 1 m, its lowest vertex is at ${lowest} m`);
});

browserTest("the cloth hits the sphere and lies on it: vertices touch its surface, none is inside", async () => {
  const viewer = await open({ session: "sphere" });
  // Pins swing with a period of 2 s: at 3 s the pinned edge has gone over to the far side of the ball.
  await viewer.until(() => window.clothlab.simTime > 2.9);
  const { center, radius } = (await viewer.read("document")).colliders[0].sphere;
  const distances = (await viewer.positions()).map((p) => Math.hypot(...p.map((v, axis) => v - center[axis])) - radius);
  const quantum = 2 / 65535; // of a box two metres wide, the coarsest this scene can have
  assert.ok(Math.min(...distances) > -0.002 - quantum, `the deepest vertex is at ${Math.min(...distances)} m`);
  const touching = distances.filter((d) => d < 0.02).length;
  assert.ok(touching >= 8, `${touching} vertices are within 2 cm of the ball`);
});

browserTest("the picture follows the scene: a change of colour shows on the screen", async () => {
  const viewer = await open({ session: "colour", sharp: true });
  await viewer.until(() => window.clothlab.simTime > 0.5);
  const red = await viewer.cloth();
  assert.ok(red.share > 0.03);
  const color = viewer.page.locator(".lil-color input[type=text]").first();
  await color.fill("#1e7a4c");
  await color.press("Enter");
  await viewer.until(() => window.clothlab.document.cloths[0].color === "#1e7a4c");
  await viewer.page.waitForTimeout(300);
  const green = await viewer.cloth();
  assert.ok(green.count < red.count / 20, `${green.count} red pixels are left of ${red.count}`);
});
