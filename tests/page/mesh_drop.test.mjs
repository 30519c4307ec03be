// What the page makes of a mesh that was dropped on it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { content, hung } = await load("link/mesh_upload");

const values = (box) =>
  Object.fromEntries(
    hung({ name: "a.obj", vertices: 3, triangles: 1, box }).map(({ op, path, value }) => {
      assert.equal(op, "replace");
      return [path.replace("/cloths/0/", ""), value];
    }),
  );
/// Where a point of the file comes to lie.
function placed([x, y, z], { translate, rotate, scale }) {
  const turned = rotate[0] === -90 ? [x, z, -y] : [x, y, z];
  return turned.map((value, axis) => scale * value + translate[axis]);
}

test("a mesh hangs upright above the floor, in the middle, by its top alone", () => {
  const boxes = [
    [
      [-0.3, 0.8, -0.1],
      [0.3, 1.5, 0.1],
    ], // a shirt in metres
    [
      [-30, 80, -10],
      [30, 150, 10],
    ], // in centimetres
    [
      [0, 0, 0],
      [1, 0, 1],
    ], // a sheet in the x-z plane
    [
      [2, 0, 0],
      [3, 0.01, 2],
    ],
    [
      [-500, -20, 0],
      [500, 20, 1],
    ], // of no usual unit
  ];
  for (const box of boxes) {
    const { mesh, transform, pins } = values(box);
    assert.deepEqual(mesh, { file: "a.obj", pattern: null });
    const corners = [box[0], box[1]].map((corner) => placed(corner, transform));
    const low = [0, 1, 2].map((axis) => Math.min(corners[0][axis], corners[1][axis]));
    const high = [0, 1, 2].map((axis) => Math.max(corners[0][axis], corners[1][axis]));
    const size = Math.max(...high.map((top, axis) => top - low[axis]));
    assert.ok(size >= 0.2 && size <= 5, `${size} m`);
    assert.ok(Math.abs(low[0] + high[0]) < 1e-3 * size && Math.abs(low[2] + high[2]) < 1e-3 * size);
    assert.ok(low[1] > 0.15 && low[1] < 0.25, `its lowest point is at ${low[1]}`);
    const [from, to] = pins[0].at.box;
    assert.ok(from[1] < high[1] && to[1] > high[1], "its top is held");
    assert.ok(high[1] - low[1] < 1e-6 || from[1] > low[1] + 0.9 * (high[1] - low[1]), "and not its lower parts");
  }
});

test("a binary .ply or a .glb file goes as base64, everything else as text", () => {
  const bytes = (text) => new TextEncoder().encode(text);
  assert.deepEqual(content(bytes("v 0 0 0\n")), { obj: "v 0 0 0\n", encoding: "text" });
  assert.equal(content(bytes("ply\nformat ascii 1.0\n")).encoding, "text");
  assert.equal(content(new Uint8Array([...bytes("glTF"), 2, 0, 0, 0])).encoding, "base64");
  const binary = new Uint8Array([...bytes("ply\nformat binary_little_endian 1.0\n"), 0, 255, 128]);
  const { obj, encoding } = content(binary);
  assert.equal(encoding, "base64");
  assert.deepEqual([...Buffer.from(obj, "base64")], [...binary]);
});
