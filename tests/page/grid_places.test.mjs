// Pins and weights follow their grid to other rows and columns.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { placeIn, withPlaces } = await load("link/grid_places");
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

test("a session's name that the server would refuse is told, with what is allowed", () => {
  for (const good of ["main", "a", "A-b_9", "x".repeat(64)]) assert.equal(sessionFault(good), "");
  for (const bad of ["", "my cloth", "é", "a/b", "x".repeat(65)])
    assert.match(sessionFault(bad), /Allowed are 1 to 64 of the letters/, bad);
});
