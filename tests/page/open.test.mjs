// What the page guesses of files that are opened, and the change of the scene that it makes of them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { content, freeFileName, withBuffers } = await load("link/mesh_upload");
const { guessRole, guessUnit, guessUp, holds, patternScale, sizeText, thicknessFor, turned, turnOf } =
  await load("open/guess");
const { beside, falls, patchFor } = await load("open/scene");

const box = (x, y, z) => [
  [-x / 2, 0, -z / 2],
  [x / 2, y, z / 2],
];

test("the unit is the one in which a mesh has a usual size; a size of metres is taken as it is", () => {
  for (const [size, unit] of [
    [1.7, "m"],
    [0.3, "m"],
    [9, "m"],
    [170, "cm"],
    [25, "cm"],
    [1700, "mm"],
    [700, "mm"],
  ])
    assert.equal(guessUnit(box(size / 3, size, size / 4)).key, unit, `${size}`);
});

test("z is up where a mesh lies flat or is far longer along z; glTF says y", () => {
  assert.equal(guessUp(box(0.5, 1.7, 0.3), "a.obj"), "y");
  assert.equal(guessUp(box(0.5, 0.3, 1.7), "a.obj"), "z");
  assert.equal(guessUp(box(1, 0, 1), "a.ply"), "z");
  assert.equal(guessUp(box(0.5, 0.3, 1.7), "a.glb"), "y");
  assert.equal(guessUp(box(1.8, 0.3, 1.7), "a.obj"), "y");
});

test("a box is turned as the transform turns its points", () => {
  const radians = (degrees) => (degrees * Math.PI) / 180;
  const turn = ([x, y, z], [a, , c]) => {
    const [u, v] = [
      y * Math.cos(radians(a)) - z * Math.sin(radians(a)),
      y * Math.sin(radians(a)) + z * Math.cos(radians(a)),
    ];
    return [
      x * Math.cos(radians(c)) - u * Math.sin(radians(c)),
      x * Math.sin(radians(c)) + u * Math.cos(radians(c)),
      v,
    ];
  };
  const of = [
    [1, 2, 3],
    [4, 6, 8],
  ];
  for (const up of ["x", "y", "z"]) {
    const corners = of.map((corner) => turn(corner, turnOf(up)));
    const [low, high] = [Math.min, Math.max].map((pick) =>
      [0, 1, 2].map((axis) => pick(corners[0][axis], corners[1][axis])),
    );
    const [from, to] = turned(of, up);
    for (const axis of [0, 1, 2])
      assert.ok(Math.abs(from[axis] - low[axis]) < 1e-12 && Math.abs(to[axis] - high[axis]) < 1e-12, up);
    // the axis that is up has become the height
    assert.ok(Math.abs(to[1] - from[1] - { x: 3, y: 4, z: 5 }[up]) < 1e-12);
  }
});

const border = (height, first, count = 3) => ({
  vertices: Array.from({ length: count }, (_, i) => first + i),
  middle: [0, height, 0],
});
const part = (more = {}) => ({
  vertices: 100,
  triangles: 180,
  pattern: false,
  box: box(0.5, 1, 0.3),
  area: 1,
  pattern_area: 0,
  mean_edge: 0.02,
  no_cloth: null,
  borders: [border(0, 0), border(1, 90)],
  ends: [[1], [90, 91, 92, 93], [2]],
  ...more,
});

test("cloth has openings, a body has none; names say it first, and what can be no cloth is a body", () => {
  assert.equal(guessRole(part(), "a.obj"), "cloth");
  assert.equal(guessRole(part({ borders: [] }), "a.obj"), "body");
  assert.equal(guessRole(part(), "torso.obj"), "body");
  assert.equal(guessRole(part({ borders: [] }), "Shirt.obj"), "cloth");
  assert.equal(guessRole(part({ node: "body" }), "shirt.glb"), "body");
  assert.equal(guessRole(part({ no_cloth: "line 3: NaN" }), "shirt.obj"), "body");
});

test("a skirt hangs by its waist, a shirt by neck or shoulders, what lies flat by its outline", () => {
  const names = (of, up = "y") => holds(of, up).map(({ name }) => name);
  assert.deepEqual(names(part()), ["waist", "top"]);
  assert.deepEqual(holds(part(), "y")[0].vertices, [90, 91, 92]);
  assert.deepEqual(names(part({ borders: [border(0, 0), border(0.8, 20), border(0.8, 40), border(1, 90)] })), [
    "neck",
    "shoulders",
  ]);
  assert.deepEqual(names(part({ borders: [border(0.5, 0)] })), ["top"]);
  assert.deepEqual(names(part({ box: box(1, 0.01, 1), borders: [border(0, 0)] })), ["outline"]);
});

test("a pattern's scale makes its area that of the mesh: a power of ten if that is near", () => {
  assert.equal(patternScale(part({ area: 1e6, pattern_area: 0.95 })), 1000);
  assert.equal(patternScale(part({ area: 1, pattern_area: 1.2 })), 1);
  assert.equal(patternScale(part({ area: 2, pattern_area: 0.5 })), 2);
});

test("contact keeps surfaces a tenth of an edge apart, from 0.1 to 3 mm", () => {
  assert.deepEqual([0.0001, 0.0123, 0.1].map(thicknessFor), [0.0001, 0.0012, 0.003]);
  assert.equal(sizeText(box(0.48, 1.7, 0.26)), "1.7 m tall, 48 cm wide, 26 cm deep");
});

const stored = {
  version: 1,
  name: "seed",
  gravity: [0, -9.8, 0],
  cloths: [{ name: "cloth" }],
  colliders: [{ name: "ball" }],
  self_collision: { kind: "points", thickness: 0.01, friction: 0.2 },
};
const item = (file, role, more = {}) => ({
  file,
  role,
  part: part(),
  fabric: "cotton",
  pattern: null,
  held: [],
  ...more,
});
const answers = (more = {}) => ({
  items: [item("shirt.obj", "cloth"), item("figure.obj", "body")],
  factor: 0.001,
  up: "z",
  fresh: true,
  edge: null,
  ...more,
});
const here = { move: [0, 0, 0], points: false };

test("a fresh scene has what was opened and nothing else; another keeps what it has", () => {
  const fresh = patchFor(answers(), stored, here, ["skirt"]);
  assert.equal(fresh.gravity, null, "its default holds");
  const transform = { translate: [0, 0, 0], rotate: [-90, 0, 0], scale: 0.001 };
  assert.deepEqual(
    fresh.cloths.map(({ name, transform }) => [name, transform]),
    [["shirt", transform]],
  );
  assert.deepEqual(fresh.colliders, [{ name: "figure", mesh: { file: "figure.obj" }, transform, friction: 0.3 }]);
  assert.equal(fresh.self_collision.kind, "surface");
  const skirt = answers({ items: [item("skirt.obj", "cloth")] });
  assert.equal(patchFor(skirt, stored, here, ["skirt"]).name, "my skirt", "no preset");
  const added = patchFor(answers({ fresh: false }), stored, here, ["skirt"]);
  assert.deepEqual(
    added.map(({ op, path }) => `${op} ${path}`),
    ["add /cloths/1", "add /colliders/1", "replace /self_collision"],
  );
  assert.equal(patchFor(answers({ items: [item("a.obj", "cloth")] }), stored, here, ["skirt"]).self_collision, null);
});

test("what no body and no pin holds falls; what goes through the body stands beside it", () => {
  assert.equal(falls(answers(), stored, true), false);
  const alone = answers({ items: [item("a.obj", "cloth")] });
  assert.equal(falls(alone, stored, true), true);
  assert.equal(falls(alone, stored, false), false, "the ball may carry it");
  assert.equal(falls(answers({ items: [item("a.obj", "cloth", { held: [1] })] }), stored, true), false);
  // both are 0.5 mm wide about the middle
  assert.deepEqual(beside(answers()), [0.00055, 0, 0]);
});

test("a name that the scene has gets a number, and one that is too long loses its start", () => {
  assert.equal(freeFileName("shirt.obj", new Set()), "shirt.obj");
  assert.equal(freeFileName("shirt.obj", new Set(["shirt.obj", "shirt-2.obj"])), "shirt-3.obj");
  const long = freeFileName(`${"é".repeat(60)}.obj`, new Set());
  assert.ok(new TextEncoder().encode(long).length <= 64 && long.endsWith("é.obj"));
});

test("the buffers beside a .gltf file go into it", () => {
  const gltf = JSON.stringify({ buffers: [{ uri: "my%20mesh.bin", byteLength: 3 }, { uri: "gone.bin" }] });
  const { buffers } = JSON.parse(withBuffers(gltf, new Map([["my mesh.bin", new Uint8Array([1, 2, 3])]])));
  assert.equal(buffers[0].uri, "data:application/octet-stream;base64,AQID");
  assert.equal(buffers[1].uri, "gone.bin");
  assert.equal(withBuffers("no JSON", new Map()), "no JSON");
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
