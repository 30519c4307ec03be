// See inside, the parts that need no browser: strain, the most strained, edges, contact pairs, curves, what is kept.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before, test } from "node:test";
import { load } from "./module.mjs";

let strain, edges, contacts, curves, choices, shown, protocol, arrays, log;
before(async () => {
  [strain, edges, contacts, curves, choices, shown, protocol, arrays, log] = await Promise.all(
    [
      "inside/strain",
      "inside/mesh_edges",
      "inside/contact_pairs",
      "inside/curve_data",
      "inside/choices",
      "inside/shown_places",
      "link/protocol",
      "link/arrays",
      "panel/status_log",
    ].map(load),
  );
});
const places = (...points) => Float32Array.from(points.flat());
const near = (value, expected) => assert.ok(Math.abs(value - expected) < 1e-6, `${value} instead of ${expected}`);

test("a spring's strain is its length over its rest length, less 1", () => {
  const springs = {
    corners: 2,
    vertices: Uint32Array.of(0, 1, 1, 2, 0, 2),
    restLength: Float32Array.of(1, 2, 5),
    kind: Uint8Array.of(0, 1, 2),
    strain: new Float32Array(3),
  };
  strain.strainSprings(springs, places([0, 0, 0], [3, 0, 0], [3, 1, 0]));
  [2, -0.5, Math.sqrt(10) / 5 - 1].forEach((expected, i) => near(springs.strain[i], expected));
});

test("an element's strain is that along warp or weft, whichever is more", () => {
  const elements = {
    corners: 3,
    vertices: Uint32Array.of(0, 1, 2),
    shares: Float32Array.of(1, 0, 0, 1),
    strain: new Float32Array(1),
  };
  const of = (...points) => {
    strain.strainElements(elements, places(...points));
    return elements.strain[0];
  };
  near(of([0, 0, 0], [1, 0, 0], [0, 1, 0]), 0);
  near(of([0, 0, 0], [1.2, 0, 0], [0, 1.1, 0]), 0.2);
  near(of([5, 5, 5], [6.2, 5, 5], [5, 5.5, 5]), -0.5);
  near(of([0, 0, 0], [0, 0, 1], [3, 0, 4]), 4);
});

test("the worst are those of the largest strain of either sign, the largest first, of those that count", () => {
  const values = Array.from({ length: 500 }, (_, i) => Math.sin(17 * i) * (1 + (i % 7)));
  const item = { strain: Float32Array.from(values) };
  const even = (i) => i % 2 === 0;
  const expected = (count, counts) =>
    [...item.strain.keys()]
      .filter(counts)
      .sort((a, b) => Math.abs(item.strain[b]) - Math.abs(item.strain[a]))
      .slice(0, count);
  for (const count of [1, 10, 100]) {
    assert.deepEqual(strain.worst(item, count, even), expected(count, even));
    assert.deepEqual(
      strain.worst(item, count, () => true),
      expected(count, () => true),
    );
  }
  assert.deepEqual(strain.worst(item, 0, even), []);
  assert.deepEqual(
    strain.worst({ strain: Float32Array.of(NaN, 1) }, 5, () => true),
    [1],
  );
});

test("a strain is told with its sign, and the rounding of places bounds its error", () => {
  assert.equal(strain.strainText(0.1234), "+12.3 %");
  assert.equal(strain.strainText(-0.00567), "−0.57 %");
  const extent = [2, 1, 2],
    rest = 0.04;
  const bound = strain.strainRounding(extent, rest);
  near(bound, 3 / 65535 / 0.04);
  for (let i = 0; i < 2000; ++i) {
    const ends = [0, 1].map((end) =>
      extent.map((size, axis) => size * (0.5 + 0.5 * Math.sin(i * 7.1 + axis + 3 * end))),
    );
    const rounded = ends.map((at) =>
      at.map((x, axis) => (Math.round((x / extent[axis]) * 65535) / 65535) * extent[axis]),
    );
    const length = ([a, b]) => Math.hypot(...a.map((x, axis) => x - b[axis]));
    assert.ok(Math.abs(length(ends) - length(rounded)) / rest <= bound);
  }
});

test("a mesh has each edge once", () => {
  const triangles = Uint32Array.of(0, 1, 2, 2, 1, 3, 3, 70000, 2);
  assert.deepEqual([...edges.meshEdges(triangles, 70001)], [0, 1, 0, 2, 1, 2, 1, 3, 2, 3, 2, 70000, 3, 70000]);
  near(edges.meanLength(Uint32Array.of(0, 1, 1, 2), places([0, 0, 0], [1, 0, 0], [1, 3, 0])), 2);
  assert.equal(edges.meanLength(new Uint32Array(0), places()), 0);
});

test("a frame's places and normals are those that the shader decodes", () => {
  const bytes = readFileSync(new URL("../golden/frame-q16.bin", import.meta.url));
  const told = JSON.parse(readFileSync(new URL("../golden/frame-q16.json", import.meta.url), "utf8"));
  const { frame } = protocol.decode(new Uint8Array(bytes).slice().buffer);
  const at = new shown.ShownPlaces(frame.header.vertexCount);
  at.take(frame);
  const normals = shown.normalsOf(frame, frame.header.vertexCount);
  told.vertices.forEach(({ position, normal }, i) =>
    [0, 1, 2].forEach((axis) => {
      near(at.places[3 * i + axis], position[axis]);
      near(normals[3 * i + axis], normal[axis]);
    }),
  );
  assert.deepEqual([...at.attribute.array], [...at.places]);
});

test("arrays come out of base64 as they went in", () => {
  const numbers = Float32Array.of(1.5, -2, 1e9);
  const text = Buffer.from(numbers.buffer).toString("base64");
  assert.deepEqual(arrays.floats(text), numbers);
  assert.deepEqual(
    arrays.joined([Uint8Array.of(1), Uint8Array.of(), Uint8Array.of(2, 3)], Uint8Array),
    Uint8Array.of(1, 2, 3),
  );
});

const none = 0xffffffff;
const told = {
  count: 4,
  kind: Uint8Array.of(0, 1, 2, 3),
  vertices: Uint32Array.of(0, 1, none, none, 0, 1, 2, 90, 0, 1, 2, 3, 3, 0, none, none),
  shares: Float32Array.of(1, 1, 0, 0, 1, 0.5, 0.5, 0, 0.25, 0.75, 0.5, 0.5, 1, 0, 0, 0),
  gap: Float32Array.of(0.001, 0.002, 0.003, 0.004),
  keep: Float32Array.of(0.004, 0.004, 0.004, 0.004),
  nearest: Float32Array.from({ length: 24 }, (_, i) => i),
};
test("contact pairs go with the cloth of the frame; points on bodies stay", () => {
  const [from, to] = [new Float32Array(12), new Float32Array(12)];
  contacts.followPairs(told, places([0, 0, 0], [4, 0, 0], [0, 8, 0], [0, 0, 2]), from, to);
  assert.deepEqual([...from], [0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 2]);
  assert.deepEqual([...to], [4, 0, 0, 2, 4, 0, 0, 4, 1, 21, 22, 23]);
  const body = { ...told, vertices: told.vertices.map((vertex) => (vertex === 2 ? 7 : vertex)) };
  contacts.followPairs(body, places([0, 0, 0], [4, 0, 0], [0, 8, 0], [0, 0, 2]), from, to);
  assert.deepEqual([...to.subarray(3, 9)], [9, 10, 11, 15, 16, 17]);
});

test("gaps are coloured by their share of what is kept, and pairs are told in words", () => {
  const hex = (share) => contacts.gapColour(share).map((value) => Math.round(255 * value));
  assert.deepEqual([0.5, 1, 1.5, -3, 9].map(hex), [
    [255, 74, 54],
    [255, 201, 40],
    [74, 168, 255],
    [255, 74, 54],
    [74, 168, 255],
  ]);
  const say = (answer, pairs = told) =>
    contacts.contactsText({ searched: true, total: pairs.count, count: pairs.count, ...answer }, pairs);
  assert.equal(
    say({}),
    "4 pairs: 1 vertex–vertex, 1 vertex–triangle, 1 edge–edge, 1 on solids. Nearest: 1 mm of 4 mm.",
  );
  assert.match(say({ total: 9 }), /^The nearest 4 of 9 pairs: /);
  const one = { ...told, count: 1, kind: Uint8Array.of(3) };
  assert.equal(say({}, one), "1 pair, on solids. Nearest: 1 mm of 4 mm.");
  assert.match(say({ searched: false }, one), /Cloth near cloth is told after the next step\.$/);
  assert.equal(say({ total: 0 }), "No pair is near.");
  assert.equal(say({ total: 0, searched: false }), "Told after the next step.");
});

const status = (time, more = {}) => ({
  time,
  playing: true,
  real_time_factor: 1,
  energy: { kinetic: 1, elastic: 2, gravitational: -4 },
  max_strain: 0.1,
  ...more,
});
test("curves have the last minute; a pause, a reset and a lost link are gaps where they must be", () => {
  const list = [
    { at: 0, status: status(0) },
    { at: 50_000, status: status(1) },
    { at: 50_100, status: status(1.1, { playing: false }) },
    { at: 50_200, status: status(0) },
    { at: 60_200, status: status(3) },
  ];
  const data = curves.curveData(list, 70_000);
  assert.deepEqual(
    data.ago.map((ago) => Number(ago.toFixed(2))),
    [-20, -19.9, -19.85, -19.8, -14.8, -9.8],
  );
  assert.deepEqual(data.rate, [1, null, null, 1, null, 1]);
  assert.deepEqual(data.strain, [10, 10, null, 10, null, 10]);
  assert.deepEqual(data.total, [-1, -1, null, -1, null, -1]);
  assert.deepEqual(data.resets, [-19.8]);
  assert.deepEqual(curves.curveData([{ at: 0, status: {} }], 0).total, [null]);
});

test("the log keeps a minute", () => {
  const kept = new log.StatusLog();
  for (let at = 0; at <= 100_000; at += 100) kept.take(status(at / 1000, { passes: ["x"] }), at);
  assert.equal(kept.told.length, 601);
  assert.equal(kept.told[0].at, 40_000);
  assert.deepEqual(Object.keys(kept.told[0].status).sort(), [
    "energy",
    "max_strain",
    "playing",
    "real_time_factor",
    "time",
  ]);
});

test("values have three figures, a prefix and a unit", () => {
  const { valueText, summary } = curves;
  assert.deepEqual(
    [1234, -0.01234, 0.9996, 2.5e-6, 4e-9, 0, 1e-12].map((value) => valueText(value, "J")),
    ["1.23 kJ", "−12.3 mJ", "1 J", "2.5 µJ", "4 nJ", "0 J", "0 J"],
  );
  assert.deepEqual(
    [valueText(12.345, "%"), valueText(0.0001, "%"), valueText(0.004, "×"), valueText(null, "J")],
    ["12.3 %", "0 %", "×0.004", "–"],
  );
  assert.deepEqual(summary([null, 3, 1, null]), { last: null, least: 1, most: 3 });
  assert.equal(summary([null, NaN]), null);
});

test("what is kept is read back, and nonsense is the default", () => {
  const { readChoices, worstFrom } = choices;
  const defaults = readChoices(null);
  assert.deepEqual([defaults.worst, defaults.curves, defaults.wireframe], [10, true, false]);
  const mine = { ...defaults, wireframe: true, worst: 3, curves: false };
  assert.deepEqual(readChoices(JSON.stringify(mine)), mine);
  for (const nonsense of ["", "{", "null", "[]", '"x"', '{"wireframe":"yes","worst":1.5}'])
    assert.deepEqual(readChoices(nonsense), defaults, nonsense);
  assert.deepEqual(
    ["7", " ", "x", "1e9", "-4", "2.5"].map((typed) => worstFrom(typed, 5)),
    [7, 5, 5, 100, 0, 5],
  );
});
