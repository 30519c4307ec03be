// Pins and weights follow their grid to other rows and columns.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { masses, placeIn, withPlaces } = await load("link/grid_places");
const { sessionFault } = await load("link/session_name");

const size = { columns: 25, rows: 25 };

test("corners and edges of a grid stay corners and edges at any number of rows and columns", () => {
  for (const columns of [2, 3, 13, 24, 26, 49, 150]) {
    const after = { columns, rows: columns + 1 };
    assert.equal(placeIn("corner:0,0", size, after), "corner:0,0");
    assert.equal(placeIn("corner:24,0", size, after), `corner:${columns - 1},0`);
    assert.equal(placeIn("corner:24,24", size, after), `corner:${columns - 1},${columns}`);
    assert.equal(placeIn("edge:column:24", size, after), `edge:column:${columns - 1}`);
    assert.equal(placeIn("edge:row:24", size, after), `edge:row:${columns}`);
    assert.equal(placeIn("vertex:624", size, after), `vertex:${columns * (columns + 1) - 1}`);
  }
  assert.equal(placeIn("corner:12,6", size, { columns: 49, rows: 13 }), "corner:24,3", "what lies between, too");
});

test("a change of both numbers of a grid moves its pins and weights once, and those of no other cloth", () => {
  const mesh = { grid: { ...size, width: 1, height: 1 } };
  const box = {
    box: [
      [0, 0, 0],
      [1, 1, 1],
    ],
  };
  const document = {
    cloths: [
      { mesh, pins: [{ at: "corner:24,0" }, { at: box }], weights: [{ at: "corner:24,24" }] },
      { mesh, pins: [{ at: "corner:24,0" }], weights: [] },
    ],
  };
  const resize = ["columns", "rows"].map((key) => ({ op: "replace", path: `/cloths/0/mesh/grid/${key}`, value: 49 }));
  assert.deepEqual(withPlaces(document, resize), [
    ...resize,
    { op: "replace", path: "/cloths/0/pins/0/at", value: "corner:48,0" },
    { op: "replace", path: "/cloths/0/weights/0/at", value: "corner:48,48" },
  ]);
  const other = [{ op: "replace", path: "/gravity/1", value: 0 }];
  assert.deepEqual(withPlaces(document, other), other);
});

test("a grid that gets other rows or columns keeps its mass as a whole, or that of a vertex if the user has said it", () => {
  const of = (columns, rows, per_vertex) => ({
    cloths: [{ mesh: { grid: { columns, rows, width: 1, height: 1 } }, mass: { per_vertex } }],
  });
  const path = "/cloths/0/mass/per_vertex";
  const resize = (columns) => [{ op: "replace", path: "/cloths/0/mesh/grid/columns", value: columns }];
  const loaded = of(25, 25, 0.1);
  const finer = masses(loaded, resize(49), loaded);
  assert.deepEqual(finer.operations, [{ op: "replace", path, value: 0.0510204 }]);
  const { whole, ...change } = finer.changes[0];
  assert.deepEqual(change, { path, vertex: 0.0510204, kept: "whole", otherwise: 0.1 });
  assert.ok(Math.abs(whole - 62.5) < 1e-3);
  assert.deepEqual(masses(of(49, 25, 0.0510204), resize(25), loaded).operations, [{ op: "replace", path, value: 0.1 }]);
  // the user's own number
  const own = masses(of(25, 25, 0.2), resize(49), loaded);
  assert.deepEqual(own.operations, []);
  assert.deepEqual(own.changes, [{ path, vertex: 0.2, kept: "vertex", otherwise: 0.102041, whole: 245 }]);
  // what is loaded may be unknown yet; a density is no mass of a vertex; a reset says the mass itself
  assert.equal(masses(of(25, 25, 0.2), resize(49), null).operations[0].value, 0.102041);
  const dense = of(25, 25, 0.1);
  dense.cloths[0].mass = { area_density: 0.1 };
  assert.deepEqual(masses(dense, resize(49), loaded), { operations: [], changes: [] });
  const said = [...resize(49), { op: "replace", path: "/cloths/0/mass", value: { per_vertex: 0.1 } }];
  assert.deepEqual(masses(loaded, said, loaded).changes, []);
});

test("a session's name that the server would refuse is told, with what is allowed", () => {
  for (const good of ["main", "a", "A-b_9", "x".repeat(64)]) assert.equal(sessionFault(good), "");
  for (const bad of ["", "my cloth", "é", "a/b", "x".repeat(65)])
    assert.match(sessionFault(bad), /Allowed are 1 to 64 of the letters/, bad);
});
