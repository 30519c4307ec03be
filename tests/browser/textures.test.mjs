// Patterns far away: a picture with one sample a pixel is near the mean of many, so nothing flickers as the cloth
// moves.
import assert from "node:assert/strict";
import { browserTest, withServer } from "./browser.mjs";

const here = withServer();
const flat = (texture) => ({
  version: 1,
  name: texture,
  cloths: [
    {
      name: "cloth",
      mesh: { grid: { columns: 25, rows: 25, width: 1, height: 1 } },
      transform: { translate: [0, 1, 0] },
      pins: [
        {
          at: {
            box: [
              [-1, -1, -1],
              [1, 2, 2],
            ],
          },
        },
      ],
      color: "#202020",
      texture,
    },
  ],
});

/// The cloth's picture from above, once with one sample a pixel and once with `finer`^2, averaged as light: the root of
/// the mean square of their differences, over what is cloth in both, of 255.
const differs = ({ distance, finer }) => {
  const { stage } = window.clothlab;
  const { camera, renderer, scene } = stage;
  const [width, height] = [160, 120];
  const gl = renderer.getContext();
  camera.clearViewOffset();
  camera.aspect = width / height;
  camera.position.set(0.31 * distance, 1 + 0.8 * distance, 0.5 + 0.51 * distance);
  camera.lookAt(0, 1, 0.5);
  camera.near = 0.01;
  camera.far = 100;
  camera.updateProjectionMatrix();
  stage.colliders.object.visible = false;
  const draw = (scale) => {
    renderer.setPixelRatio(1);
    renderer.setSize(width * scale, height * scale, false);
    renderer.render(scene, camera);
    const bytes = new Uint8Array(4 * width * height * scale * scale);
    gl.readPixels(0, 0, width * scale, height * scale, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return bytes;
  };
  const once = draw(1).slice();
  const fine = draw(finer);
  const light = (byte) => (byte <= 10.31 ? byte / 3294.6 : ((byte / 255 + 0.055) / 1.055) ** 2.4);
  const byte = (linear) => 255 * (linear <= 0.00313 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);
  let sum = 0;
  let count = 0;
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const mean = [0, 0, 0, 0];
      for (let j = 0; j < finer; ++j)
        for (let i = 0; i < finer; ++i) {
          const at = 4 * ((y * finer + j) * width * finer + x * finer + i);
          for (let c = 0; c < 4; ++c) mean[c] += (c < 3 ? light(fine[at + c]) : fine[at + c]) / (finer * finer);
        }
      const at = 4 * (y * width + x);
      if (once[at + 3] < 255 || mean[3] < 254.5) continue; // the edge of the cloth, or beside it
      for (let c = 0; c < 3; ++c) sum += (once[at + c] - byte(mean[c])) ** 2 / 3;
      ++count;
    }
  return { error: Math.sqrt(sum / count), count };
};

browserTest("a pattern shows in each pixel the mean over it, near and far", async () => {
  const { viewer, client } = await here.both("textures", { drawn: 1 });
  await client.request("sim.pause", {});
  const found = {};
  for (const texture of ["weave", "checker", "stripes", "plain"]) {
    await client.request("scene.load", { scene: flat(texture) });
    await viewer.until((name) => window.clothlab.document?.name === name, texture);
    await viewer.page.waitForTimeout(500);
    for (const distance of [3, 9]) {
      const { error, count } = await viewer.page.evaluate(differs, { distance, finer: 6 });
      found[`${texture} from ${distance} m`] = `${error.toFixed(2)} of ${count}`;
    }
  }
  for (const [what, text] of Object.entries(found)) {
    const [error, , count] = text.split(" ").map(Number);
    assert.ok(count > 50, `${what}: ${count} pixels`);
    // What is left comes from fwidth(), which takes a pixel for wider than it is across a slanted pattern. Edges that
    // were blurred by smoothstep over two pixels had 19 and 28.
    assert.ok(error < 17, `${what}: ${error}`);
  }
  await client.close();
});
