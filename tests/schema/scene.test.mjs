// Compares server/scene/scene.schema.json with the program's validator: each scene below, valid or broken on purpose,
// gets the same verdict from both, except for rules about several parts of the scene, which JSON Schema cannot express.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import Ajv2020 from "ajv/dist/2020.js";

const sceneFolder = new URL("../../server/scene/", import.meta.url);
const schema = JSON.parse(readFileSync(new URL("scene.schema.json", sceneFolder)));
const accepts = new Ajv2020({ strict: true, strictTypes: false, strictRequired: false }).compile(schema);

/** Rules that only the program checks, by what it says of them. */
const crossFieldRules = {
  "a pin lies in its mesh": /\/at: .*allowed: (a place in this grid|a vertex of this mesh|"vertex:N" or)/,
  "a pin's box has its smaller corner first": /the smaller corner first/,
  "a pin's box holds a vertex": /selects no vertex/,
  "a triangle's vertices exist": /\/triangles\/\d+\/\d+: .*\[vertex\]/,
  "with area_density every vertex has an area": /would have no mass/,
  "poisson^2 is below warp / weft": /\/poisson: .*the square root of warp \/ weft/,
  "pbd has no finite elements": /\/solver\/method: .*PBD's stiffness is no N\/m/,
  "a key is of something that can be keyed, once": /^\/keys\/\d+\/of: /,
  "a key's times rise": /^\/keys\/\d+\/at\/\d+\/0: .*times rise/,
  "a key's values are of the range of what it is of": /^\/keys\/\d+\/at\/\d+\/1(\/\d)?: /,
  "a pin lets go at once": /^\/keys\/\d+\/ease: .*between true and false/,
  "a panel's outline and holes do not meet, and its vertices are not too many":
    /\/mesh\/panel\/(outline\/\d+|holes\/\d+\/\d+|edge|edges\/[^:]*): /,
  "names are unique": /a name that no earlier one has/,
  "all cloths together are not too large": /vertices so far/,
  "a mesh's file is there and is one": /\/mesh\/(obj|file): /,
  "a collider's triangles can be simulated":
    /^\/colliders\/\d+\/mesh: found (triangle \d+: |\d+ vertices and (?!\d+ triangles so far))/,
  "all colliders together are not too large": /triangles so far/,
  "no cloth starts through or inside a collider": /^\/colliders\/\d+: .*, and (cloth that goes through|inside it) /,
  "surfaces that keep apart start apart": /^\/self_collision\/kind: "surface", but the start has /,
};

const grid = { grid: { columns: 5, rows: 4, width: 1, height: 0.8 } };
const oscillate = { oscillate: { axis: [0, 0, 1], amplitude: 0.2, frequency: 0.5 } };
const spin = { spin: { axis: [1, 0, 0], center: [0, 1, 0], degrees_per_second: 72 } };
const linear = { linear: { velocity: [0.1, 0, 0] } };

const whole = {
  version: 1,
  name: "whole",
  gravity: [0, -9.8, 0],
  cloths: [
    {
      name: "first",
      mesh: grid,
      transform: { translate: [0, 1, 0], rotate: [0, 10, 0], scale: 1 },
      mass: { per_vertex: 0.1 },
      material: { model: "springs", structural: 20000, shear: 10000, bend: 2000, damping: 2, strain_limit: null },
      pins: [
        { at: "corner:0,0", motion: oscillate },
        { at: "edge:row:3", motion: spin },
        { at: "vertex:5", place: [0.1, 1.2, 0], motion: null },
        {
          at: {
            box: [
              [-9, -9, -9],
              [9, 9, 9],
            ],
          },
          motion: linear,
        },
      ],
      weights: [
        { at: "edge:row:3", mass: 0.5 },
        {
          at: {
            box: [
              [-9, -9, -9],
              [9, 9, 9],
            ],
          },
          mass: 1e-3,
        },
      ],
      start: { scatter: { size: 0.5, seed: 1 } },
      color: "#b03a2e",
      texture: "weave",
    },
    {
      mesh: {
        vertices: [
          [0, 0, 0],
          [0, 0, 1],
          [1, 0, 0],
          [1, 0, 1],
        ],
        triangles: [
          [0, 1, 2],
          [2, 1, 3],
        ],
      },
      mass: { area_density: 0.15 },
      pins: [{ at: "vertex:2" }],
      weights: [{ at: "vertex:1", mass: 1 }],
      start: { scale: [1, 0, -1] },
    },
    {
      name: "piece",
      mesh: {
        panel: {
          outline: [
            [0, 0],
            [0.4, 0],
            [0.4, 0.4],
            [0, 0.4],
          ],
          holes: [
            [
              [0.1, 0.1],
              [0.2, 0.1],
              [0.2, 0.2],
            ],
          ],
          edge: 0.1,
          edges: { left: [3, 0], hem: [0, 1] },
        },
      },
    },
    {
      mesh: { file: "leaf.obj", pattern: "uv", pattern_scale: 2, node: null, mend: true },
      pins: [{ at: "vertex:3" }],
      start: { dress: 0.5 },
    },
  ],
  colliders: [
    { name: "ball", sphere: { center: [0, 0.6, 0], radius: 0.25 }, friction: 0.3, restitution: 0, motion: linear },
    { plane: { point: [0, 0, 0], normal: [0, 1, 0] }, friction: 0.5 },
    { capsule: { a: [0, 0.5, 0], b: [0, 1, 0], radius: 0.1 }, motion: spin },
    { box: { center: [0, 0, 0], half: [0.1, 0.2, 0.3], rotate: [0, 30, 0] } },
    {
      mesh: {
        vertices: [
          [20, 0, 0],
          [21, 0, 0],
          [20, 1, 0],
          [20, 0, 1],
        ],
        triangles: [
          [0, 2, 1],
          [0, 1, 3],
        ],
      },
      transform: { translate: [0, 5, 0], rotate: [0, 10, 0], scale: 1 },
      motion: oscillate,
    },
    { mesh: { obj: "leaf.obj" }, transform: { translate: [0, 50, 0] } },
  ],
  self_collision: { thickness: 0.01, friction: 0.2, kind: "points" },
  wind: { velocity: [2, 0, 0], gust: 0.3, gust_frequency: 0.7, drag: 1, lift: 0.2 },
  air_drag: 0,
  solver: { method: "symplectic_euler", dt: 0.001, iterations: 10, tolerance: 1e-4 },
  keys: [
    {
      of: "/wind/velocity",
      at: [
        [0, [0, 0, 0]],
        [2, [6, 0, 0]],
      ],
      ease: "smooth",
    },
    {
      of: "/cloths/0/pins/0/held",
      at: [
        [0, true],
        [2.5, false],
      ],
      ease: "step",
    },
    { of: "/air_drag", at: [[1, 0.5]] },
  ],
};
/// The file beside it; its first vertex is part of no face.
const leaf = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 2/1 3/2 4/3\n";
const least = { version: 1, cloths: [{ mesh: { grid: {} } }] };
const sheet = {
  warp: 300,
  weft: 200,
  poisson: 0.2,
  shear: 40,
  bending: { warp: 1e-5, weft: 2e-5, twist: 1e-6 },
  damping: 0.001,
  grain: 30,
  strain_limit: { warp: 0.1, weft: 0.2 },
};
const sheets = {
  version: 1,
  cloths: [
    { mesh: grid, material: { model: "fem", ...sheet } },
    { mesh: grid, material: { model: "fem", bending: 1e-5, strain_limit: 0.1 } },
    { mesh: grid, material: { fabric: "silk", damping: 1e-4 } },
    { mesh: grid, material: { model: "springs", fabric: "interlock", bend: 0 } },
  ],
  solver: { method: "verlet" },
};

/** Every path into a value, the top included. */
function* paths(value, path = []) {
  yield path;
  if (value !== null && typeof value === "object")
    for (const key of Object.keys(value)) yield* paths(value[key], [...path, key]);
}

const at = (value, path) => path.reduce((part, key) => part[key], value);

function changed(base, path, change) {
  const copy = structuredClone({ top: base });
  const full = ["top", ...path];
  change(at(copy, full.slice(0, -1)), full.at(-1));
  return copy.top;
}

/** Every minimum and maximum in the schema, and a little to both sides of each. */
function boundaries() {
  const ends = new Set();
  for (const path of paths(schema)) if (["minimum", "maximum"].includes(path.at(-1))) ends.add(at(schema, path));
  return [...ends].flatMap((x) => [
    x,
    x - Math.max(1e-13, Math.abs(x) * 1e-9),
    x + Math.max(1e-13, Math.abs(x) * 1e-9),
    x + 1,
  ]);
}

function* mutations() {
  const numbers = [...new Set([...boundaries(), 0.5, 2.5, 25.0, 1e300, -1e300])];
  const others = [null, true, "", "x", 7, -1, [], {}, [0, 1, 0], [0, 0, 0], ["0", 1, 0], { x: 1 }];
  const texts = [
    "corner:4,3",
    "corner:5,0",
    "corner:01,0",
    "corner:1",
    "vertex:19",
    "vertex:20",
    "vertex:-1",
    "edge:column:4",
    "edge:column:5",
    "edge:diagonal:1",
    "edge:row:0 ",
    "#00FF7f",
    "#00ff7",
    "#00ff7g",
    "plain",
    "checker",
    "stripes",
    "linear",
    "smooth",
    "velvet",
    "denim",
    "fem",
    "springs",
    "explicit_euler",
    "symplectic_euler",
    "verlet",
    "rk4",
    "implicit_euler",
    "pbd",
    "xpbd",
    "vbd",
    "bdf2",
    "auto",
    "first",
    "cloth-2",
    "é".repeat(64),
    "é".repeat(65),
    "😀".repeat(64),
    "tab\t",
    "del\u007f",
  ];
  for (const base of [whole, least, sheets]) {
    yield base;
    for (const path of paths(base)) {
      const value = at(base, path);
      const replacements = [...others];
      if (typeof value === "number") replacements.push(...numbers);
      if (typeof value === "string") replacements.push(...texts);
      for (const replacement of replacements) yield changed(base, path, (parent, key) => (parent[key] = replacement));
      if (path.length)
        yield changed(base, path, (parent, key) =>
          Array.isArray(parent) ? parent.splice(Number(key), 1) : delete parent[key],
        );
      if (Array.isArray(value))
        yield changed(base, path, (parent, key) => parent[key].push(structuredClone(value[0] ?? 0)));
      else if (value !== null && typeof value === "object")
        for (const [key, extra] of Object.entries({
          extra: 1,
          motion: null,
          grid: grid.grid,
          obj: "a.obj",
          file: "a.ply",
          fabric: "cotton",
          per_vertex: 1,
          scale: [1, 1, 1],
          scatter: { size: 1 },
          dress: 0.5,
          mass: 1,
          box: [
            [0, 0, 0],
            [1, 1, 1],
          ],
          capsule: {},
          ...spin,
          ...linear,
          sphere: { center: [0, 0, 0], radius: 1 },
        }))
          yield changed(base, path, (parent, name) => (parent[name][key] = extra));
    }
  }
  const many = (count, make) => Array.from({ length: count }, (_, i) => make(i));
  const small = { mesh: { grid: { columns: 2, rows: 2 } } };
  for (const extra of [0, 1]) {
    yield { ...least, cloths: many(64 + extra, () => small) };
    yield { ...least, colliders: many(64 + extra, () => ({ sphere: { center: [0, 0, 0], radius: 1 } })) };
    yield { ...least, cloths: [{ ...small, pins: many(1024 + extra, () => ({ at: "vertex:0" })) }] };
    yield { ...least, cloths: [{ ...small, weights: many(1024 + extra, () => ({ at: "vertex:0", mass: 1 })) }] };
    yield { ...least, name: "x".repeat(64 + extra) };
  }
  for (const cloths of [[small], [small, small]]) yield { ...least, cloths, self_collision: { kind: "surface" } };
  yield { ...least, cloths: [{ mesh: { grid: { columns: 1024, rows: 1024 } } }, small] };
  const cube = (scale) => ({
    mesh: {
      vertices: many(8, (i) => [i & 1, (i >> 1) & 1, i >> 2].map((bit) => scale * (bit - 0.5))),
      triangles: [0, 1, 2].flatMap((axis) => {
        const [a, b] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
        return [0, 1 << axis].flatMap((side) => [
          [side, side | a, side | a | b],
          [side, side | a | b, side | b],
        ]);
      }),
    },
  });
  for (const scale of [0.5, 4]) yield { ...least, cloths: [small], colliders: [cube(scale)] };
  const line = { vertices: many(3, (i) => [i, 50, 0]), triangles: [[0, 1, 2]], mend: false };
  yield { ...least, cloths: [small], colliders: [{ mesh: line }] };
  const strip = (n) => ({
    vertices: many(n, (i) => [i, 50 + (i % 2), 0]),
    triangles: many(n - 2, (i) => [i, i + 1, i + 2]),
  });
  yield { ...least, cloths: [small], colliders: [{ mesh: strip(150000) }, { mesh: strip(60000) }] };
}

/** The program's verdict on each text: "" for valid, else what it says. One call, since starting takes longer than checking. */
function verdicts(texts) {
  const folder = mkdtempSync(join(tmpdir(), "clothlab-schema-"));
  try {
    writeFileSync(join(folder, "leaf.obj"), leaf);
    const names = texts.map((text, i) => (writeFileSync(join(folder, `${i}.json`), text), `${i}.json`));
    const run = spawnSync(process.env.CLOTHLAB, ["validate", ...names], {
      cwd: folder,
      encoding: "utf8",
      maxBuffer: 1 << 28,
    });
    assert.ok(run.status === 0 || run.status === 2, `validate ended with ${run.status} ${run.signal}`);
    const said = new Map();
    for (const line of (run.stdout + run.stderr).split("\n")) {
      const [, name, rest] = line.match(/^(\d+)\.json[:,] ?(.*)$/) ?? [];
      if (name) said.set(Number(name), rest.startsWith("valid (") ? "" : rest);
    }
    return texts.map((_, i) => said.get(i) ?? assert.fail(`nothing was said of ${texts[i]}`));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

test("the schema and the program agree on every scene, valid or broken", () => {
  const scenes = [...new Set([...mutations()].map((scene) => JSON.stringify(scene)))];
  const said = verdicts(scenes);
  const disagreements = [],
    seen = new Set();
  let valid = 0;
  scenes.forEach((text, i) => {
    const bySchema = accepts(JSON.parse(text)),
      byProgram = said[i] === "";
    if (byProgram) ++valid;
    if (bySchema === byProgram) return;
    const rule = bySchema && Object.keys(crossFieldRules).find((name) => crossFieldRules[name].test(said[i]));
    if (rule) seen.add(rule);
    else disagreements.push(`${bySchema ? "schema accepts" : "program accepts"}: ${said[i]}\n  ${text.slice(0, 400)}`);
  });
  assert.equal(
    disagreements.length,
    0,
    `${disagreements.length} of ${scenes.length}:\n${disagreements.slice(0, 5).join("\n")}`,
  );
  assert.ok(
    scenes.length > 1000 && valid > 200 && scenes.length - valid > 500,
    `${scenes.length} scenes, ${valid} valid`,
  );
  assert.deepEqual([...seen].sort(), Object.keys(crossFieldRules).sort(), "a rule that no scene above breaks");
});

test("the schema names the fabrics of fabrics.json", () => {
  const fabrics = JSON.parse(readFileSync(new URL("fabrics.json", sceneFolder)));
  assert.deepEqual(
    schema.$defs.fabric.enum,
    fabrics.map(({ name }) => name),
  );
});

test("every preset satisfies the schema", () => {
  const folder = new URL("presets/", sceneFolder);
  for (const file of readdirSync(folder).filter((name) => name.endsWith(".json")))
    assert.ok(accepts(JSON.parse(readFileSync(new URL(file, folder)))), `${file}: ${JSON.stringify(accepts.errors)}`);
});
