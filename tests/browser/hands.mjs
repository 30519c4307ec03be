// What the tests of hands on the cloth do and read: pictures drawn, where a vertex is seen, which hands hold.
import { eventually } from "./browser.mjs";

/// Waits until the page has drawn this many pictures.
export const drawn = (viewer, pictures) =>
  viewer.page.evaluate(async (count) => {
    for (let i = 0; i < count; ++i) await new Promise(requestAnimationFrame);
  }, pictures);

/// Where a vertex is on the page [CSS pixels].
export const seen = (viewer, index) =>
  viewer.page.evaluate((i) => {
    const { stage, lastFrame } = window.clothlab;
    const { header, buffer } = lastFrame;
    const words = new Uint16Array(buffer, 64, header.vertexCount * 4);
    const [x, y, z] = [0, 1, 2].map((k) => header.boxMinimum[k] + (header.boxExtent[k] * words[4 * i + k]) / 65535);
    const at = stage.controls.target.clone().set(x, y, z).project(stage.camera);
    return { x: ((at.x + 1) / 2) * innerWidth, y: ((1 - at.y) / 2) * innerHeight };
  }, index);
export const cameraPlace = (viewer) => viewer.page.evaluate(() => window.clothlab.stage.camera.position.toArray());
export const handsOf = (client, fits) => client.nextNotification("sim.status", ({ hands }) => fits(hands));
export const placeOf = async (client, index) => (await client.nextFrame()).positions[index];
export const distance = (a, b) => Math.hypot(...a.map((value, axis) => value - b[axis]));
/// What the browser says to the page's code: not that a screenshot makes the GPU wait.
export const complaints = (viewer) => viewer.complaints.filter((text) => !text.includes("ReadPixels"));
export const pixels = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);
export const hint = (viewer, of = "hand") => viewer.page.locator(`.hand-hint[data-of=${of}]`);

export async function near(viewer, index, goal, what) {
  await eventually(
    what,
    () => seen(viewer, index),
    (at) => pixels(at, goal) < 25,
  );
}

/// A press is aimed at what is seen: waits until neither the cloth nor the camera moves much from one picture to
/// another that is a while later, however slowly the machine draws.
export async function still(viewer, index) {
  let before = { x: -1e3, y: 0 };
  await eventually(
    "a still picture",
    async () => {
      await drawn(viewer, 3);
      await viewer.page.waitForTimeout(200);
      const now = await seen(viewer, index);
      const moved = pixels(before, now);
      before = now;
      return moved;
    },
    (moved) => moved < 1,
  );
}
