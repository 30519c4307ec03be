// The camera's place: the whole outline is inside the free part of the window, and the camera is no farther than
// needed.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { Outline, place, standFor, centerIn } = await load("view/framing");
const { sweep } = await load("view/motion");
const three = await import("../../web/node_modules/three/build/three.module.js");

const cloud = (size, at) =>
  Array.from({ length: 300 }, (_, i) => {
    const turn = 2.399963 * i; // the golden angle spreads points over a ball
    const height = 1 - (2 * i + 1) / 300;
    const around = Math.sqrt(1 - height * height);
    return new three.Vector3(
      at[0] + size * around * Math.cos(turn),
      at[1] + size * height,
      at[2] + size * around * Math.sin(turn),
    );
  });

for (const [name, width, height, area] of [
  ["a phone", 390, 844, { left: 0, top: 70, width: 390, height: 660 }],
  ["a phone on its side", 844, 390, { left: 0, top: 60, width: 520, height: 260 }],
  ["a screen", 1920, 1080, { left: 320, top: 0, width: 1280, height: 1080 }],
])
  for (const size of [0.02, 1, 300])
    test(`a ball of ${size} m fills the free part of ${name}, and nothing of it is outside`, () => {
      const points = cloud(size, [3 * size, size, -2 * size]);
      const outline = new Outline();
      outline.add(points);
      const camera = new three.PerspectiveCamera(40);
      centerIn(camera, area, width, height);
      const target = place(camera, standFor(outline, area, height, camera.fov));
      camera.lookAt(target.x, target.y, target.z);
      camera.updateMatrixWorld();
      const seen = points.map((point) => {
        const at = point.clone().project(camera);
        return [((at.x + 1) / 2) * width, ((1 - at.y) / 2) * height];
      });
      const [left, right] = [0, 0].map((_, i) => Math[i ? "max" : "min"](...seen.map(([x]) => x)));
      const [top, bottom] = [0, 0].map((_, i) => Math[i ? "max" : "min"](...seen.map(([, y]) => y)));
      assert.ok(left >= area.left && right <= area.left + area.width, `${left} to ${right} in ${JSON.stringify(area)}`);
      assert.ok(top >= area.top && bottom <= area.top + area.height, `${top} to ${bottom} in ${JSON.stringify(area)}`);
      // The outline knows a ball's farthest points to a tenth, and some padding remains.
      const fill = Math.max((right - left) / area.width, (bottom - top) / area.height);
      assert.ok(fill > 0.75, `it fills ${fill} of the longer side`);
    });

test("a motion's sweep has its farthest points, whatever the time", () => {
  const far = (points) => Math.max(...points.map(({ x }) => x));
  const oscillate = { axis: [2, 0, 0], amplitude: 0.3, frequency: 0.7 };
  assert.ok(Math.abs(far(sweep([1, 0, 0], { oscillate })) - 1.3) < 1e-12);
  const spin = { axis: [0, 1, 0], center: [0, 0, 0], degrees_per_second: -10 };
  assert.ok(Math.abs(far(sweep([0, 0, 2], { spin })) - 2) < 1e-12);
  assert.deepEqual(
    sweep([1, 2, 3], null).map((point) => point.toArray()),
    [[1, 2, 3]],
  );
});
