// Where a new body is put: clear of cloths, bodies and planes, as near as can be to where it is wished.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { freePlace } = await load("link/free_place");
const { freeName } = await load("link/names");
const half = [0.12, 0.12, 0.12];
const free = { colliders: [] };
const clear = (place, { low, high }) => place.some((at, k) => at + half[k] <= low[k] || at - half[k] >= high[k]);

test("where nothing is it stands where it is wished, else beside what is there", () => {
  assert.deepEqual(freePlace([0, 0.3, 0.3], half, [], free), [0, 0.3, 0.3]);
  const cloth = { low: [-0.5, 0, -0.5], high: [0.5, 1, 0.5] };
  const place = freePlace([0, 0.3, 0.3], half, [cloth], free);
  assert.ok(clear(place, cloth), `${place}`);
  // No place on the lattice of tenths is nearer: in front of the cloth, 0.5 + 0.12 + a gap.
  assert.ok(Math.hypot(place[0], place[1] - 0.3, place[2] - 0.3) < 0.5, `${place}`);
  const beside = freePlace([0, 0.3, 0.3], half, [cloth, { low: place, high: place.map((at) => at + 0.1) }], free);
  assert.notDeepEqual(beside, place);
  assert.ok(clear(beside, cloth), `${beside}`);
});

test("it stands on the open side of every plane, and above what fills all near places", () => {
  const floor = { plane: { point: [0, 1, 0], normal: [0, 2, 0] } };
  const [, height] = freePlace([0, 0.3, 0.3], half, [], { colliders: [floor] });
  assert.ok(height >= 1.12 && height <= 1.3, `${height}`);
  const hall = { low: [-5, -5, -5], high: [5, 5, 5] };
  assert.deepEqual(freePlace([0, 0.3, 0.3], half, [hall], free), [0, 5.18, 0.3]);
});

test("a name is that of the kind, with a number where it is taken", () => {
  assert.equal(freeName("sphere", []), "sphere");
  assert.equal(freeName("sphere", [{ name: "sphere" }, { name: "sphere-3" }]), "sphere-2");
});
