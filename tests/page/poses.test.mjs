// A cloth that handles have put elsewhere: about its middle, with the places by which pins hold it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { clothPose, movedCloth, poseOf } = await load("view/poses");
const { shiftedCloth } = await load("link/shifted_cloth");

const box = [
  [0, 0, 0],
  [1, 1, 1],
];
const cloth = {
  name: "cloth",
  transform: { translate: [0.1, 1, 0.2], rotate: [30, -40, 50], scale: 0.5 },
  pins: [{ at: "vertex:1", place: [0, 2, 0] }, { at: { box } }, { at: "corner:0,0" }],
  weights: [{ at: { box }, mass: 1 }],
};
// a point of the mesh, as a vector of three.js: a sphere's place is one
const local = poseOf({ sphere: { center: [0.3, 0, 0.5], radius: 1 } }).place;
const values = (operations) => Object.fromEntries(operations.map(({ path, value }) => [path.slice(10), value]));
const near = (found, wanted) => {
  for (const [axis, value] of wanted.entries()) assert.ok(Math.abs(found[axis] - value) < 2e-5, `${found}, ${wanted}`);
};

test("put where it is, nothing of it changes", () => {
  const same = values(movedCloth(cloth, 0, local, clothPose(cloth, local)));
  near(same["transform/translate"], cloth.transform.translate);
  near(same["transform/rotate"], cloth.transform.rotate);
  assert.equal(same["transform/scale"], 0.5);
  near(same["pins/0/place"], [0, 2, 0]);
  assert.deepEqual(same["pins/1/at"], { box });
});

test("moved, its places and boxes go along", () => {
  const pose = clothPose(cloth, local);
  pose.place.x += 0.25;
  const moved = values(movedCloth(cloth, 0, local, pose));
  near(moved["transform/translate"], [0.35, 1, 0.2]);
  near(moved["pins/0/place"], [0.25, 2, 0]);
  near(moved["pins/1/at"].box[1], [1.25, 1, 1]);
  near(moved["weights/0/at"].box[0], [0.25, 0, 0]);
});

test("scaled, its middle stays and its places go away from it", () => {
  const pose = clothPose(cloth, local);
  const before = pose.place.toArray();
  const scaled = values(movedCloth(cloth, 0, local, { ...pose, scale: 1 }));
  const after = clothPose(
    { transform: { translate: scaled["transform/translate"], rotate: scaled["transform/rotate"], scale: 1 } },
    local,
  );
  near(after.place.toArray(), before);
  near(
    scaled["pins/0/place"],
    [0, 2, 0].map((value, axis) => before[axis] + 2 * (value - before[axis])),
  );
});

test("a copy lies elsewhere, with its own name", () => {
  const copy = shiftedCloth(cloth, "cloth-2", [1, 0, 0]);
  assert.equal(copy.name, "cloth-2");
  near(copy.transform.translate, [1.1, 1, 0.2]);
  near(copy.pins[0].place, [1, 2, 0]);
  near(copy.pins[1].at.box[0], [1, 0, 0]);
  assert.deepEqual(copy.pins[2], cloth.pins[2]);
  assert.deepEqual(cloth.transform.translate, [0.1, 1, 0.2], "the first stays");
});
