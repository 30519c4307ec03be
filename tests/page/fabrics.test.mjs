// What the page makes of a document that leaves numbers to a fabric.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { addressed, withFabrics } = await load("link/fabrics");
const { applyPatch } = await load("link/json_patch");
const { fabricFields, untilUnstable } = await load("panel/fabric_fields");

const own = { mass: { per_vertex: 0.1 }, material: { model: "springs", structural: 300, damping: 2 } };
const cotton = { material: { model: "fem", fabric: "cotton", shear: 200, grain: 0 } };
const stored = { cloths: [own, cotton] };
const left = [
  null,
  {
    mass: { area_density: 0.1036 },
    material: { warp: 2365, bending: { warp: 8e-6, weft: 12e-6, twist: null }, damping: 0.001 },
  },
];
const shown = withFabrics(stored, left);
const fabrics = ["cotton", "silk"].map((name) => ({ name, feel: `${name} feels`, source: "" }));

/// The document after operations on the one that is shown.
const after = (...operations) => applyPatch(stored, addressed(stored, shown, operations));

test("a cloth is shown with its fabric's numbers, and its own where it has some; others stay as they are", () => {
  assert.equal(shown.cloths[0], own);
  assert.deepEqual(shown.cloths[1].mass, { area_density: 0.1036 });
  assert.equal(shown.cloths[1].material.warp, 2365);
  assert.equal(shown.cloths[1].material.shear, 200);
  assert.equal(withFabrics(stored, [null, null]), stored);
});

test("a slider of a number that was left to the fabric writes that number alone", () => {
  const operation = { op: "replace", path: "/cloths/1/material/warp", value: 100 };
  assert.deepEqual(addressed(stored, shown, [operation]), [{ ...operation, op: "add" }]);
  const changed = after(operation);
  assert.deepEqual(changed.cloths[1].material, { ...cotton.material, warp: 100 });
  assert.equal("mass" in changed.cloths[1], false);
});

test("of a group of numbers the others come along, and two changes of one group both count", () => {
  const at = (key, value) => ({ op: "replace", path: `/cloths/1/material/bending/${key}`, value });
  assert.deepEqual(after(at("warp", 1), at("weft", 2)).cloths[1].material.bending, { warp: 1, weft: 2, twist: null });
  const heavier = after({ op: "replace", path: "/cloths/1/mass/area_density", value: 0.5 });
  assert.deepEqual(heavier.cloths[1].mass, { area_density: 0.5 });
});

test("what the document does not have need not be removed", () => {
  assert.deepEqual(addressed(stored, shown, [{ op: "remove", path: "/cloths/1/mass" }]), []);
});

test("the menu gives a cloth all of a fabric, or the numbers that it has as its own", () => {
  const menu = (index) => fabricFields(shown, index, fabrics)[0];
  assert.equal(menu(0).read(shown), "custom");
  assert.equal(menu(1).read(shown), "cotton");
  const silk = after(...menu(0).change("silk", shown));
  assert.deepEqual(silk.cloths[0], { material: { model: "springs", fabric: "silk" } });
  assert.deepEqual(after(...menu(1).change("silk", shown)).cloths[1], { material: { model: "fem", fabric: "silk" } });
  const { fabric: _, ...numbers } = shown.cloths[1].material;
  assert.deepEqual(after(...menu(1).change("custom", shown)).cloths[1], {
    material: numbers,
    mass: { area_density: 0.1036 },
  });
});

test("below the menu is what the fabric is like, and an offer to give up numbers of the cloth's own", () => {
  const menu = fabricFields(shown, 1, fabrics)[0];
  const base = "/cloths/1/material";
  const values = {
    [`${base}/fabric`]: "cotton",
    [`${base}/model`]: "fem",
    [`${base}/warp`]: 2365,
    [`${base}/bending/warp`]: 8e-6,
  };
  assert.deepEqual(menu.note(values, { from_fabrics: left }), { text: "Cotton feels." });
  const { bending: _, ...rest } = left[1].material;
  const note = menu.note(values, { from_fabrics: [null, { material: rest }] });
  assert.equal(note.text, "Cotton feels. Here with its own bending, mass.");
  assert.deepEqual(after(...note.offer.operations).cloths[1], { material: { model: "fem", fabric: "cotton" } });
  assert.deepEqual(fabricFields(shown, 0, fabrics)[0].note({ "/cloths/0/material/fabric": "custom" }, {}), {
    text: "",
  });
});

test("a server without fabrics has no menu of them", () => assert.deepEqual(fabricFields(shown, 1, []), []));

test("a sheet's numbers end where the square of Poisson's ratio is that of warp over weft", () => {
  const sheet = { model: "fem", warp: 2365, weft: 3801, poisson: 0.311 };
  const moved = (key, value, of = sheet) => {
    const document = { cloths: [{ material: of }] };
    return applyPatch(document, untilUnstable(key, "/cloths/0")(value, document)).cloths[0].material;
  };
  for (const [key, value] of [
    ["warp", 10],
    ["weft", 200_000],
    ["poisson", 1],
  ]) {
    const { warp, weft, poisson } = moved(key, value);
    const share = poisson ** 2 / (warp / weft);
    assert.ok(share < 1 && share > 0.99, `${key}: ${share}`);
  }
  assert.equal(moved("warp", 1000).warp, 1000);
  assert.equal(moved("weft", 200_000, { ...sheet, poisson: 0 }).weft, 200_000);
});
