// State hashes after one second of every preset, and of five scenes with triangle meshes, several cloths and moving
// spheres and planes, under every method. Made before and after a change of the code that must not change the motion. A
// scene that blows up gives the hash of its last good state.
//   CLOTHLAB=build/release/clothlab node tests/bench/hashes.mjs [--only REGEX] [--out FILE] [--compare FILE]
// Prints (and writes) JSON; with --compare it names what differs, and exits with 1 if anything does. Hashes hold for
// one device and Mesa version.
import { execFile } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { cpus, tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";

const program = process.env.CLOTHLAB;
if (!program) throw new Error("CLOTHLAB must name the program");
const args = process.argv.slice(2);
const option = (flag) => (args.includes(flag) ? args[args.indexOf(flag) + 1] : null);
const methods = ["explicit_euler", "symplectic_euler", "verlet", "rk4", "implicit_euler", "pbd", "xpbd", "vbd", "bdf2"];

const springs = { model: "springs", structural: 300, shear: 150, bend: 20, damping: 0.02 };
const grid = (columns, rows, more = {}) => ({
  mesh: { grid: { columns, rows, width: 0.8, height: (0.8 * rows) / columns } },
  mass: { per_vertex: 0.0007 },
  material: springs,
  transform: { translate: [0, 1, -0.4] },
  ...more,
});

/// A disc of triangles: one vertex, then rings of 6, 12, 18, ... around it.
function disc(rings, radius) {
  const vertices = [[0, 0, 0]],
    triangles = [];
  const at = (ring, i) => (ring === 0 ? 0 : 1 + 3 * ring * (ring - 1) + (i % (6 * ring)));
  for (let ring = 1; ring <= rings; ++ring)
    for (let i = 0; i < 6 * ring; ++i) {
      const angle = (2 * Math.PI * i) / (6 * ring);
      vertices.push([((radius * ring) / rings) * Math.cos(angle), 0, ((radius * ring) / rings) * Math.sin(angle)]);
    }
  for (let ring = 1; ring <= rings; ++ring)
    for (let side = 0; side < 6; ++side)
      for (let i = 0; i < ring; ++i) {
        const outer = side * ring + i,
          inner = side * (ring - 1) + i;
        triangles.push([at(ring, outer), at(ring - 1, inner), at(ring, outer + 1)]);
        if (i + 1 < ring) triangles.push([at(ring - 1, inner), at(ring - 1, inner + 1), at(ring, outer + 1)]);
      }
  return { vertices, triangles };
}
const round = (mesh) => ({ mesh, mass: { area_density: 0.3 }, material: springs, transform: { translate: [0, 1, 0] } });
const sphere = (center, radius, motion = null) => ({
  sphere: { center, radius },
  friction: 0.3,
  restitution: 0,
  motion,
});
const plane = (point, normal, motion = null) => ({ plane: { point, normal }, friction: 0.4, restitution: 0.2, motion });
const made = {
  "a disc on a moving sphere": {
    cloths: [round(disc(8, 0.5))],
    self_collision: { thickness: 0.06, friction: 0.2 },
    colliders: [sphere([0, 0.6, 0], 0.25, { linear: { velocity: [0.3, 0, 0] } })],
  },
  "a pinned disc with a weight and a strain limit": {
    cloths: [
      {
        ...round(disc(6, 0.4)),
        pins: [{ at: "vertex:0" }],
        weights: [{ at: "vertex:60", mass: 0.05 }],
        material: { ...springs, strain_limit: 0.1 },
      },
    ],
    air_drag: 0.4,
  },
  "three cloths over a plane that oscillates": {
    cloths: [0, 1, 2].map((i) =>
      grid(13 + 2 * i, 11, {
        name: `cloth-${i}`,
        transform: { translate: [0.1 * i, 0.3 + 0.12 * i, -0.3], rotate: [0, 20 * i, 0] },
      }),
    ),
    colliders: [plane([0, 0.1, 0], [0, 1, 0], { oscillate: { axis: [0, 1, 0], amplitude: 0.05, frequency: 1 } })],
    self_collision: { thickness: 0.055, friction: 0.3 },
  },
  "a grid and a disc between spheres and a plane that spins": {
    cloths: [grid(17, 13), { ...round(disc(5, 0.3)), transform: { translate: [0, 0.7, 0] } }],
    colliders: [
      sphere([0.2, 0.5, 0], 0.15, { spin: { axis: [0, 1, 0], center: [0, 0.5, 0], degrees_per_second: 90 } }),
      sphere([-0.3, 0.4, 0.1], 0.2),
      plane([0, 0.1, 0], [0, 1, 0], { spin: { axis: [0, 0, 1], center: [0, 0.1, 0], degrees_per_second: 15 } }),
    ],
  },
  "a scattered cloth, pinned to what spins": {
    cloths: [
      grid(15, 15, {
        start: { scatter: { size: 0.5, seed: 3 } },
        pins: [{ at: "edge:row:0", motion: { spin: { axis: [0, 1, 0], center: [0, 1, 0], degrees_per_second: 60 } } }],
      }),
    ],
    self_collision: { thickness: 0.05, friction: 0.1 },
  },
};

const folder = mkdtempSync(join(tmpdir(), "clothlab-hashes-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));
const run = promisify(execFile);
const wanted = new RegExp(option("--only") ?? ""); // matches "preset, method"

async function hashOf(scene, method, place) {
  const report = join(folder, `report-${place}.json`);
  try {
    await run(program, ["run", scene, "--time", "1", "--set", `/solver/method="${method}"`, "--report", report]);
  } catch (error) {
    if (error.stderr?.includes("clothlab: error: /solver/method")) return "refused"; // the method does not suit it
    if (error.code !== 4) throw error; // 4: the scene blew up, which has a hash too
  }
  const { state_hash, diverged, renderer } = JSON.parse(readFileSync(report, "utf8"));
  result.renderer = renderer;
  return state_hash + (diverged ? " (blew up)" : "");
}

const { stdout } = await run(program, ["presets"]);
const presets = stdout
  .trim()
  .split("\n")
  .map((line) => line.split(/\s+/)[0]);
const scenes = presets.map((name) => [name, name]);
for (const [name, scene] of Object.entries(made)) {
  const file = join(folder, `${scenes.length}.json`);
  writeFileSync(
    file,
    JSON.stringify({
      version: 1,
      name,
      gravity: [0, -9.8, 0],
      solver: { method: "symplectic_euler", dt: 0.0008, iterations: 10, tolerance: 1e-4 },
      ...scene,
    }),
  );
  scenes.push([name, file]);
}

const result = { benchmark: "hashes", renderer: "", hashes: {} };
const todo = scenes
  .flatMap(([name, file]) => methods.map((method) => ({ what: `${name}, ${method}`, file, method })))
  .filter(({ what }) => wanted.test(what));
for (const { what } of todo) result.hashes[what] = ""; // fixes their order, in which the runs need not end
let next = 0;
await Promise.all(
  Array.from({ length: cpus().length }, async () => {
    while (next < todo.length) {
      const place = next++;
      const { what, file, method } = todo[place];
      result.hashes[what] = await hashOf(file, method, place);
    }
  }),
);

const text = JSON.stringify(result, null, 2) + "\n";
const out = option("--out"),
  against = option("--compare");
if (out) writeFileSync(out, text);
if (!against) {
  process.stdout.write(text);
} else {
  const before = JSON.parse(readFileSync(against, "utf8"));
  if (before.renderer !== result.renderer)
    console.log(`not comparable: ${before.renderer} before, ${result.renderer} now`);
  const changed = Object.keys({ ...before.hashes, ...result.hashes }).filter(
    (what) => wanted.test(what) && before.hashes[what] !== result.hashes[what],
  );
  for (const what of changed) console.log(`${what}: ${before.hashes[what]} before, ${result.hashes[what]} now`);
  console.log(`${changed.length} of ${todo.length} differ`);
  process.exitCode = changed.length > 0 ? 1 : 0;
}
