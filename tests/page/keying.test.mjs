// "Key this value": what of the panel can be keyed, and the keyframes that a press sets.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { load } from "./module.mjs";

let keying;
before(async () => (keying = await load("panel/keying")));

const field = (path, more = {}) => ({ key: path, label: path, paths: [path], kind: "number", scale: {}, ...more });
const scene = (keys = []) => ({
  gravity: [0, -9.8, 0],
  air_drag: 0.5,
  cloths: [{ material: { model: "springs", structural: 100, bend: 0 } }],
  keys,
});

test("a slider has a key where the server takes one, a vector as a whole, and none where there are no springs", () => {
  const place = (path, more) => keying.keyedPlace(field(path, more), scene());
  assert.equal(place("/gravity/1"), "/gravity");
  assert.equal(place("/wind/velocity/0"), "/wind/velocity");
  assert.equal(place("/air_drag"), "/air_drag");
  assert.equal(place("/colliders/3/friction"), "/colliders/3/friction");
  assert.equal(place("/cloths/0/material/structural"), "/cloths/0/material/structural");
  for (const path of ["/cloths/0/material/bend", "/solver/dt", "/colliders/0/sphere/radius", "/cloths/0/color"])
    assert.equal(place(path), null, path);
  assert.equal(place("/air_drag", { kind: "toggle" }), null);
  assert.equal(place("/air_drag", { paths: ["/air_drag", "/other"] }), null);
});

test("a press sets the present value at the present time: a new key, one more time in order, or another value", () => {
  const set = (keys, time) => keying.keyOperations("/air_drag", scene(keys), time)[0];
  const other = { of: "/gravity", at: [[0, [0, 0, 0]]], ease: "step" };
  const made = set([other], 1.25);
  assert.deepEqual(made, {
    op: "replace",
    path: "/keys",
    value: [other, { of: "/air_drag", at: [[1.25, 0.5]], ease: "linear" }],
  });
  const key = {
    of: "/air_drag",
    at: [
      [0, 0],
      [2, 4],
    ],
    ease: "smooth",
  };
  assert.deepEqual(set([key], 1.0000000001).value, [
    {
      ...key,
      at: [
        [0, 0],
        [1, 0.5],
        [2, 4],
      ],
    },
  ]);
  assert.deepEqual(set([key], 2).value[0].at, [
    [0, 0],
    [2, 0.5],
  ]);
  const [gravity] = keying.keyOperations("/gravity", scene([other]), 3);
  assert.deepEqual(gravity.value[0].at[1], [3, [0, -9.8, 0]]);
});
