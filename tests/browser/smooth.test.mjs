// The cloth is drawn rounder than its triangles, from the same frames; a key shows the triangles.
import assert from "node:assert/strict";
import { browserTest, eventually, withServer } from "./browser.mjs";

const here = withServer();
const segments = 6;
const rows = 4;

/// Half a pipe of radius 1 m along z, of so few sides that its outline is a polygon.
function pipe() {
  const vertices = [];
  const triangles = [];
  for (let r = 0; r <= rows; ++r)
    for (let s = 0; s <= segments; ++s) {
      const angle = (Math.PI * s) / segments;
      vertices.push([Math.cos(angle), Math.sin(angle), 0.4 * r]);
      if (r === rows || s === segments) continue;
      const at = r * (segments + 1) + s;
      triangles.push([at, at + 1, at + segments + 2], [at, at + segments + 2, at + segments + 1]);
    }
  return { vertices, triangles };
}
const scene = {
  version: 1,
  name: "pipe",
  cloths: [{ name: "cloth", mesh: pipe(), transform: { translate: [0, 1, 0] }, color: "#204080", texture: "plain" }],
};

/// How far the outline of the picture along the pipe is from a circle, at most [pixels, of a radius of 150].
const offCircle = () => {
  const { stage } = window.clothlab;
  const { camera, renderer, scene } = stage;
  const size = 400;
  const gl = renderer.getContext();
  stage.colliders.object.visible = false;
  camera.clearViewOffset();
  camera.aspect = 1;
  camera.near = 1;
  camera.far = 2000;
  camera.position.set(0, 1, 500); // so far away that both ends of the pipe look alike
  camera.lookAt(0, 1, 0);
  camera.fov = (360 / Math.PI) * Math.atan(size / 2 / 150 / 500);
  camera.updateProjectionMatrix();
  renderer.setPixelRatio(1);
  renderer.setSize(size, size, false);
  renderer.render(scene, camera);
  const bytes = new Uint8Array(4 * size * size);
  gl.readPixels(0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  stage.resize(stage.area);
  let most = 0;
  for (let degrees = 8; degrees <= 172; ++degrees) {
    const [x, y] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
    let out = 190;
    const drawn = (r) => bytes[4 * (Math.floor(size / 2 + r * y) * size + Math.floor(size / 2 + r * x)) + 3] > 127;
    while (out > 0 && !drawn(out)) out -= 0.25;
    most = Math.max(most, Math.abs(out - 150));
  }
  return most;
};

browserTest("the outline is a curve where the mesh is a polygon, and M shows the mesh", async () => {
  const { viewer, client } = await here.both("smooth", { drawn: 1 });
  await client.request("sim.pause", {});
  await client.request("scene.load", { scene });
  await viewer.until(() => window.clothlab.document?.name === "pipe");
  await viewer.until((count) => window.clothlab.lastFrame.header.vertexCount === count, (segments + 1) * (rows + 1));
  const before = await viewer.positions();
  // The middle of a side of the polygon is 1 - cos(15 degrees) of the radius inside the circle: 5.1 pixels. Two pixels
  // and the hem's thickness of another are the curve's.
  const round = (most) => most < 3;
  const cornered = (most) => most > 4;
  await eventually("a round outline", () => viewer.page.evaluate(offCircle), round);
  assert.deepEqual(await viewer.positions(), before, "the simulated vertices stay where they are");

  await viewer.page.keyboard.press("m");
  await eventually("the mesh's outline", () => viewer.page.evaluate(offCircle), cornered);
  await viewer.page.keyboard.press("m");
  await eventually("a round outline again", () => viewer.page.evaluate(offCircle), round);

  // Lines over the simulated triangles are seen on them, not below a finer mesh.
  await viewer.page.keyboard.press("i");
  const wireframe = viewer.page.getByRole("checkbox", { name: "wireframe" });
  await wireframe.check();
  await eventually("the mesh below its wireframe", () => viewer.page.evaluate(offCircle), cornered);
  await wireframe.uncheck();
  await eventually("a round outline at last", () => viewer.page.evaluate(offCircle), round);
  assert.deepEqual(
    viewer.complaints.filter((text) => !/GPU stall|GL Driver Message/.test(text)),
    [],
  );
  await client.close();
});
