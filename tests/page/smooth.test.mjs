// The finer mesh that the page draws: it meets the simulated vertices, has no gaps, and is as fine as the device
// allows.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { refine, stepsFor, interpolate, onEdge } = await load("view/refinement");
const { Patches } = await load("view/patches");
const { Hem, around } = await load("view/hem");
const { FoldShade } = await load("view/fold_shade");

/// A grid of squares of side `size` [m], each of two triangles, with `height(x, y)` for its third coordinate.
function grid(columns, rows, size, height) {
  const places = [];
  const texture = [];
  const triangles = [];
  for (let r = 0; r < rows; ++r)
    for (let c = 0; c < columns; ++c) {
      places.push(c * size, r * size, height(c * size, r * size));
      texture.push(c / (columns - 1), r / (rows - 1));
      if (r + 1 === rows || c + 1 === columns) continue;
      const at = r * columns + c;
      triangles.push(at, at + 1, at + columns + 1, at, at + columns + 1, at + columns);
    }
  return {
    vertexCount: columns * rows,
    places: Float32Array.from(places),
    triangles: Uint32Array.from(triangles),
    textureCoordinates: Float32Array.from(texture),
  };
}

/// The finer mesh of a grid, with room for a hem.
function smooth(mesh, steps) {
  const of = refine(mesh, steps);
  const hem = new Hem(of);
  const places = new Float32Array(3 * (of.vertexCount + around * hem.vertices.length));
  const normals = new Float32Array(places.length);
  places.set(mesh.places);
  new Patches(of).place(places, normals);
  return { of, hem, places, normals };
}

const wave = (x, y) => 0.1 * Math.sin(6 * x) * Math.cos(5 * y);

test("the simulated vertices stay where they are, and every triangle becomes steps squared of the same winding", () => {
  const mesh = grid(9, 7, 0.1, wave);
  for (const steps of [1, 2, 3, 4]) {
    const { of, places, normals } = smooth(mesh, steps);
    assert.deepEqual(places.slice(0, mesh.places.length), mesh.places);
    assert.equal(of.fine.length, mesh.triangles.length * steps ** 2);
    assert.equal(new Set(of.fine).size, of.vertexCount, "every vertex belongs to a triangle");
    for (let t = 0; t < of.fine.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => 3 * of.fine[t + k]);
      const area =
        (places[b] - places[a]) * (places[c + 1] - places[a + 1]) -
        (places[b + 1] - places[a + 1]) * (places[c] - places[a]);
      assert.ok(area > 0, `triangle ${t / 3} of ${steps} steps is turned over`);
    }
    for (let i = 0; i < of.vertexCount; ++i)
      assert.ok(Math.abs(Math.hypot(...normals.subarray(3 * i, 3 * i + 3)) - 1) < 1e-5);
  }
});

test("neighbours meet along their edges: inside the outline each finer edge has two triangles, on it one", () => {
  const { of } = smooth(grid(6, 5, 0.1, wave), 4);
  const uses = new Map();
  for (let t = 0; t < of.fine.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const [a, b] = [of.fine[t + k], of.fine[t + ((k + 1) % 3)]];
      const key = `${Math.min(a, b)}-${Math.max(a, b)}`;
      uses.set(key, (uses.get(key) ?? 0) + 1);
    }
  const outline = new Set(of.rim.map(([a, b]) => `${Math.min(a, b)}-${Math.max(a, b)}`));
  assert.equal(outline.size, 4 * 2 * (5 + 4));
  for (const [edge, count] of uses) assert.equal(count, outline.has(edge) ? 1 : 2, edge);
});

test("a curved sheet is met four times as closely as by its triangles", () => {
  const mesh = grid(17, 17, 0.0625, wave);
  const error = (places, count) => {
    let most = 0;
    for (let i = 0; i < count; ++i) {
      const [x, y, z] = places.subarray(3 * i, 3 * i + 3);
      if (Math.min(x, y, 1 - x, 1 - y) < 0.07) continue; // at the outline a normal is the mean of one side alone
      most = Math.max(most, Math.abs(z - wave(x, y)));
    }
    return most;
  };
  const { of, places } = smooth(mesh, 4);
  const straight = new Float32Array(3 * of.vertexCount);
  straight.set(mesh.places);
  interpolate(of, straight, 3);
  const [curved, flat] = [error(places, of.vertexCount), error(straight, of.vertexCount)];
  assert.ok(curved < flat / 4, `${curved} and ${flat} m`);
});

test("a flat sheet stays flat, with straight sides and its corners", () => {
  const { of, places } = smooth(
    grid(5, 5, 0.25, () => 0),
    3,
  );
  for (let i = 0; i < of.vertexCount; ++i) {
    const [x, y, z] = places.subarray(3 * i, 3 * i + 3);
    assert.ok(Math.abs(z) < 1e-7 && x > -1e-7 && x < 1 + 1e-6 && y > -1e-7 && y < 1 + 1e-6, `${x}, ${y}, ${z}`);
  }
  for (const vertex of new Set(of.rim.flat())) {
    const [x, y] = places.subarray(3 * vertex, 3 * vertex + 2);
    assert.ok(Math.min(x, y, 1 - x, 1 - y) < 1e-6, `${x}, ${y} is not on a side`);
  }
});

test("a round outline is met by a curve, where its polygon cuts corners", () => {
  const sides = 16;
  const places = [0, 0, 0];
  const triangles = [];
  for (let i = 0; i < sides; ++i) {
    const angle = (2 * Math.PI * i) / sides;
    places.push(Math.cos(angle), Math.sin(angle), 0);
    triangles.push(0, 1 + i, 1 + ((i + 1) % sides));
  }
  const mesh = {
    vertexCount: sides + 1,
    places: Float32Array.from(places),
    triangles: Uint32Array.from(triangles),
    textureCoordinates: Float32Array.from({ length: 2 * (sides + 1) }, (_, i) => places[3 * (i >> 1) + (i & 1)]),
  };
  const { of, places: fine } = smooth(mesh, 4);
  const cut = 1 - Math.cos(Math.PI / sides); // of the polygon, in the middle of a side
  for (const [vertex] of of.rim) {
    const off = Math.abs(1 - Math.hypot(fine[3 * vertex], fine[3 * vertex + 1]));
    assert.ok(off < cut / 5, `${off} from the circle, the polygon ${cut}`);
  }
});

test("a value between vertices is that of the straight line, of bytes, too", () => {
  const mesh = grid(2, 2, 1, () => 0);
  const of = refine(mesh, 4);
  const values = new Uint8Array(of.vertexCount);
  values.set([0, 100, 0, 100]);
  interpolate(of, values, 1);
  const edge = [...Array(of.edges.length / 2).keys()].find((e) => of.edges[2 * e] === 0 && of.edges[2 * e + 1] === 1);
  assert.deepEqual([...values.subarray(onEdge(of, edge), onEdge(of, edge) + 3)], [25, 50, 75]);
});

test("large meshes are not cut: there are never more triangles than the device can draw", () => {
  assert.equal(stepsFor(1152, 40_000), 4);
  assert.equal(stepsFor(1152, 13_000), 3);
  assert.equal(stepsFor(12_000, 13_000), 1);
  assert.equal(stepsFor(130_050, 40_000), 0, "drawn as it came");
  for (const most of [5_000, 13_000, 40_000])
    for (let triangles = 1; triangles < 200_000; triangles = Math.ceil(triangles * 1.3))
      assert.ok(stepsFor(triangles, most) ** 2 * triangles <= most);
});

test("the hem is a closed tube as thick as it should be, around the whole outline, with its faces outwards", () => {
  const mesh = grid(5, 4, 0.2, wave);
  const { of, hem, places, normals } = smooth(mesh, 3);
  const radius = 0.00135; // of denim folded twice
  hem.place(places, normals, of.vertexCount, () => radius);
  assert.equal(hem.vertices.length, 3 * 2 * (4 + 3));
  hem.vertices.forEach((vertex, ring) => {
    for (let k = 0; k < around; ++k) {
      const at = 3 * (of.vertexCount + around * ring + k);
      const away = Math.hypot(...[0, 1, 2].map((axis) => places[at + axis] - places[3 * vertex + axis]));
      assert.ok(Math.abs(away - radius) < 1e-6, `${away} m`);
    }
  });
  const edges = new Map();
  for (let t = 0; t < hem.triangles.length; t += 3) {
    const corners = [0, 1, 2].map((k) => hem.triangles[t + k]);
    corners.forEach((a, k) => {
      const b = corners[(k + 1) % 3];
      const key = `${Math.min(a, b)}-${Math.max(a, b)}`;
      edges.set(key, (edges.get(key) ?? 0) + 1);
    });
    const [a, b, c] = corners.map((v) => [0, 1, 2].map((axis) => places[3 * v + axis]));
    const [u, v] = [b, c].map((point) => point.map((value, axis) => value - a[axis]));
    const face = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const outwards = [0, 1, 2].reduce((sum, axis) => sum + face[axis] * normals[3 * corners[0] + axis], 0);
    assert.ok(outwards > 0, `triangle ${t / 3} of the hem faces inwards`);
  }
  assert.deepEqual(new Set(edges.values()), new Set([2]), "closed");
});

test("a valley is dark on the side that it opens to, a flat sheet on neither, and layers between themselves", () => {
  const shadeOf = (mesh) => {
    const { normals } = smooth(mesh, 1);
    const shade = new Uint8Array(4 * mesh.vertexCount);
    new FoldShade(mesh).measure(mesh.places, normals, shade, 4);
    return (v) => [shade[4 * v], shade[4 * v + 1]];
  };
  const middle = 5 * 11 + 5;
  assert.deepEqual(shadeOf(grid(11, 11, 0.1, () => 0))(middle), [0, 0]);
  const [front, back] = shadeOf(grid(11, 11, 0.1, (x) => 1.2 * Math.abs(x - 0.5)))(middle);
  assert.ok(front > 60 && back === 0, `${front} of 255 in front, ${back} at the back`);
  const [lower, upper] = [grid(11, 11, 0.1, () => 0), grid(11, 11, 0.1, () => 0.05)];
  const both = {
    vertexCount: 2 * 121,
    places: Float32Array.of(...lower.places, ...upper.places),
    triangles: Uint32Array.of(...lower.triangles, ...upper.triangles.map((v) => v + 121)),
    textureCoordinates: Float32Array.of(...lower.textureCoordinates, ...upper.textureCoordinates),
  };
  const of = shadeOf(both);
  assert.ok(of(middle)[0] > 100 && of(middle)[1] === 0, `${of(middle)} below`);
  assert.ok(of(middle + 121)[0] === 0 && of(middle + 121)[1] > 100, `${of(middle + 121)} above`);
});
