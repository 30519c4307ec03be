// The panel's explanations, marks and ways back, from the scene's schema and the presets' files.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { before, test } from "node:test";
import { load } from "./module.mjs";

const folder = new URL("../../server/scene/", import.meta.url);
const read = (name) => JSON.parse(readFileSync(new URL(name, folder), "utf8"));
const schema = read("scene.schema.json");
const fabrics = read("fabrics.json");
const names = readdirSync(new URL("presets/", folder)).filter((file) => file.endsWith(".json"));
const presets = Object.fromEntries(names.map((file) => [file.slice(0, -5), read(`presets/${file}`)]));
const methods = schema.properties.solver.properties.method.enum;

let words, fields, baseline, costs;
before(async () => {
  words = await load("explain/schema");
  fields = await load("panel/fields");
  baseline = await load("explain/baseline");
  costs = await load("explain/costs");
});
const inside = (section) => [...section.fields, ...section.sections.flatMap(inside)];
const fieldsOf = (document) => fields.sectionsOf(document, methods, fabrics).flatMap(inside);

const motions = [
  { oscillate: { axis: [0, 0, 1], amplitude: 0.2, frequency: 0.5 } },
  { linear: { velocity: [0, 0, 1] } },
  { spin: { axis: [0, 1, 0], center: [0, 0, 0], degrees_per_second: 10 } },
];
const solid = (shape, i) => ({ name: `solid ${i}`, ...shape, motion: motions[i % 3] });
/// A scene with every field that the panel has.
const everything = (material, mass) => ({
  version: 1,
  name: "everything",
  cloths: [{ name: "cloth", mesh: { grid: {} }, material, mass, pins: [{ at: "corner:0,0", motion: motions[0] }] }],
  colliders: [
    { sphere: { center: [0, 0, 0], radius: 1 } },
    { plane: { point: [0, 0, 0], normal: [0, 1, 0] } },
    { capsule: { a: [0, 0, 0], b: [0, 1, 0], radius: 1 } },
    { box: { center: [0, 0, 0], half: [1, 1, 1] } },
    { mesh: { obj: "body.obj" } },
  ].map(solid),
  self_collision: {},
  wind: { velocity: [1, 0, 0] },
});
const scenes = [
  everything({ model: "springs" }, { per_vertex: 1 }),
  everything({ model: "fem" }, { area_density: 1 }),
  everything({ model: "fem", bending: 1e-5, strain_limit: { warp: 0.1, weft: 0.1 } }, { per_vertex: 1 }),
  ...Object.values(presets),
];
const all = () =>
  scenes.flatMap((scene) =>
    methods.flatMap((method) => {
      const document = words.completed(schema, { ...scene, solver: { ...scene.solver, method } });
      return fieldsOf(document).map((field) => ({ field, document, place: field.about ?? field.paths[0] }));
    }),
  );

test("every field of the panel has a sentence, every number a range, and each says what it costs", () => {
  const missing = new Set();
  for (const { field, document, place } of all()) {
    const found = words.wordsFor(schema, document, place);
    const kind = place.replaceAll(/\d+/g, "N");
    if (!found) missing.add(`${kind} is not in the schema`);
    else if (!found.says) missing.add(`${kind} has no sentence`);
    else if (field.kind === "number" && !Number.isFinite(found.least)) missing.add(`${kind} has no range`);
    if (!costs.costOf(place)) missing.add(`${kind} has no cost`);
  }
  assert.deepEqual([...missing], []);
});

test("a number's unit is the schema's, but for percents of a share", () => {
  const spelt = { "m/s^2": "m/s²", "kg/m^2": "kg/m²", degrees: "°", "degrees/s": "°/s" };
  const wrong = new Set();
  for (const { field, document, place } of all()) {
    if (field.kind !== "number") continue;
    const unit = words.wordsFor(schema, document, place)?.unit ?? "";
    const shown = field.scale.unit ?? "";
    const same = (spelt[unit] ?? unit) === shown || (unit === "kg" && shown === "kg/vertex");
    if (!same && !(unit === "" && shown === "%")) wrong.add(`${place}: [${unit}], but the panel shows [${shown}]`);
  }
  assert.deepEqual([...wrong], []);
});

test("a place of a branch of oneOf is explained by the branch that the document has", () => {
  const springs = words.completed(schema, scenes[0]);
  const sheet = words.completed(schema, scenes[1]);
  const shear = (document) => words.wordsFor(schema, document, "/cloths/0/material/shear");
  assert.equal(shear(springs).initial, 10000);
  assert.equal(shear(sheet).initial, 97);
  assert.equal(words.wordsFor(schema, springs, "/gravity/1").initial, -9.8);
  assert.equal(words.wordsFor(schema, springs, "/no/such/place"), null);
});

const wayBack = (path, change, scene = presets.seed) => {
  const loaded = words.completed(schema, scene);
  const stored = structuredClone(loaded);
  change(stored);
  const field = fieldsOf(stored).find(({ key }) => key === path);
  return baseline.wayBack(field, stored, loaded);
};

test("a value that differs has a way back; one that does not has none", () => {
  assert.deepEqual(
    wayBack("/solver/dt", () => undefined),
    [],
  );
  assert.deepEqual(
    wayBack("/solver/dt", (scene) => (scene.solver.dt = 0.002)),
    [{ op: "replace", path: "/solver/dt", value: 0.001 }],
  );
  const colliding = { kind: "points", thickness: 0.01, friction: 0.2 };
  assert.deepEqual(
    wayBack("/self_collision", (scene) => (scene.self_collision = null)),
    [{ op: "replace", path: "/self_collision", value: colliding }],
  );
});

test("pins that move together go back together; a fabric goes back with its mass", () => {
  const moved = wayBack("/cloths/0/pins/0/motion/oscillate/frequency", (scene) => {
    for (const pin of scene.cloths[0].pins) pin.motion.oscillate.frequency = 2;
  });
  assert.deepEqual(
    moved.map(({ path, value }) => [path, value]),
    [0, 1].map((pin) => [`/cloths/0/pins/${pin}/motion/oscillate/frequency`, 0.5]),
  );
  const cut = wayBack("/cloths/0/material/fabric", (scene) => {
    scene.cloths[0].material = { model: "fem", fabric: "silk" };
    delete scene.cloths[0].mass;
  });
  assert.deepEqual(cut.at(1), { op: "add", path: "/cloths/0/mass", value: { per_vertex: 0.1 } });
  assert.equal(cut[0].value.structural, 20000);
});

test("what a fabric gives goes back by leaving it to the fabric again", () => {
  const scene = { ...presets.seed, cloths: [{ name: "cloth", mesh: { grid: {} }, material: { fabric: "silk" } }] };
  const back = (change) => {
    const loaded = words.completed(schema, scene);
    const stored = structuredClone(loaded);
    change(stored);
    const field = { key: "w", label: "warp", paths: ["/cloths/0/material/warp"], kind: "number", scale: {} };
    return baseline.wayBack(field, stored, loaded);
  };
  assert.deepEqual(
    back(() => undefined),
    [],
  );
  assert.deepEqual(
    back((stored) => (stored.cloths[0].material.warp = 5)),
    [{ op: "remove", path: "/cloths/0/material/warp" }],
  );
});

test("cloths and colliders are compared by name, whatever their order", () => {
  const base = new baseline.Baseline();
  const loaded = words.completed(schema, presets.seed);
  base.know({ schema, presets: {} });
  base.take(loaded);
  const stored = structuredClone(loaded);
  stored.colliders.unshift({ ...stored.colliders[0], name: "another", friction: 0.7 });
  const aligned = base.alignedTo(stored);
  assert.deepEqual(
    aligned.colliders.map((each) => each?.name),
    [undefined, "ball"],
  );
  const friction = (i) => fieldsOf(stored).find(({ key }) => key === `/colliders/${i}/friction`);
  assert.deepEqual(baseline.wayBack(friction(0), stored, aligned), []);
  assert.deepEqual(baseline.wayBack(friction(1), stored, aligned), []);
});

test("a page that opens late compares with the preset of the scene's name, and after a lost connection with the same", () => {
  const base = new baseline.Baseline();
  const changed = words.completed(schema, presets.seed);
  changed.solver.dt = 0.0005;
  base.take(changed);
  base.know({ schema, presets });
  assert.equal(base.alignedTo(changed).solver.dt, 0.001);
  const own = { ...structuredClone(changed), name: "my own" };
  base.take(own);
  assert.equal(base.alignedTo(own).solver.dt, 0.0005);
  base.lost();
  base.take({ ...own, solver: { ...own.solver, dt: 0.004 } });
  assert.equal(base.alignedTo(own).solver.dt, 0.0005);
  base.take({ ...own, solver: { ...own.solver, dt: 0.004 } });
  assert.equal(base.alignedTo(own).solver.dt, 0.004, "loaded anew");
});
