// What bodies of triangles cost by their size and number: the same sheet, 25x25 vertices, falls on the same part of
// balls whose triangles are of one size, so that only what it does not touch grows. By hand, on a quiet machine:
//   node tests/bench/bodies.mjs [MACHINE]   ->   tests/bench/results/bodies-MACHINE.json, a table
// Contact between surfaces, 5 mm, symplectic Euler, 1 ms, 0.6 s; medians of rounds in which all take turns; time is
// that of stepping alone, with one thread of software OpenGL (LP_NUM_THREADS=0, unless the environment sets it).
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { cpus, loadavg, tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { median } from "../median.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const program = process.env.CLOTHLAB ?? join(here, "../../build/release/clothlab");
const machine = process.argv[2] ?? `${cpus().length}-cores`;
const rounds = 5;

/// A ball of radius 1: an octahedron whose triangles are divided by four, `times` times.
function ball(times) {
  const vertices = [
    [1, 0, 0],
    [-1, 0, 0],
    [0, 1, 0],
    [0, -1, 0],
    [0, 0, 1],
    [0, 0, -1],
  ];
  let triangles = [
    [0, 2, 4],
    [2, 1, 4],
    [1, 3, 4],
    [3, 0, 4],
    [2, 0, 5],
    [1, 2, 5],
    [3, 1, 5],
    [0, 3, 5],
  ];
  for (let n = 0; n < times; ++n) {
    const middles = new Map();
    const middle = (a, b) => {
      const key = a < b ? `${a},${b}` : `${b},${a}`;
      if (!middles.has(key)) {
        const sum = vertices[a].map((x, axis) => x + vertices[b][axis]);
        const length = Math.hypot(...sum);
        middles.set(key, vertices.push(sum.map((x) => x / length)) - 1);
      }
      return middles.get(key);
    };
    triangles = triangles.flatMap(([a, b, c]) => {
      const [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
      return [
        [a, ab, ca],
        [b, bc, ab],
        [c, ca, bc],
        [ab, bc, ca],
      ];
    });
  }
  return { vertices, triangles };
}

/// A ball with its top at `x`, 0.85, 0.
function body(name, radius, times, x) {
  const transform = { translate: [x, 0.85 - radius, 0], rotate: [0, 0, 0], scale: radius };
  return { name, mesh: ball(times), transform, friction: 0.3 };
}

const sheet = {
  name: "sheet",
  mesh: { grid: { columns: 25, rows: 25, width: 1, height: 1 } },
  transform: { translate: [0, 1, -0.5], rotate: [0, 0, 0], scale: 1 },
  mass: { per_vertex: 0.001 },
  material: { model: "springs", structural: 100, shear: 50, bend: 5, damping: 0.02 },
};
const cases = [
  { bodies: [body("ball", 0.25, 4, 0)] },
  { bodies: [body("ball", 0.5, 5, 0)] },
  { bodies: [body("ball", 1, 6, 0)] },
  { bodies: Array.from({ length: 10 }, (_, i) => body(`ball ${i}`, 0.25, 4, 2 * i)) },
];

const folder = mkdtempSync(join(tmpdir(), "bodies-"));
for (const [index, one] of cases.entries()) {
  const scene = {
    version: 1,
    cloths: [sheet],
    colliders: one.bodies,
    self_collision: { kind: "surface", thickness: 0.005, friction: 0.2 },
    solver: { method: "symplectic_euler", dt: 0.001 },
  };
  writeFileSync(join(folder, `${index}.json`), JSON.stringify(scene));
  one.triangles = one.bodies.reduce((sum, { mesh }) => sum + mesh.triangles.length, 0);
  one.seconds = [];
}
const load = loadavg()[0];
const env = { LP_NUM_THREADS: "0", ...process.env };
for (let round = 0; round < rounds; ++round)
  for (const [index, one] of cases.entries()) {
    const report = join(folder, "report.json");
    const words = ["run", join(folder, `${index}.json`), "--time", "0.6", "--report", report];
    execFileSync(program, words, { env, stdio: "ignore" });
    const { step_s, self_collision, renderer } = JSON.parse(readFileSync(report, "utf8"));
    one.seconds.push(step_s);
    Object.assign(one, { pairs: self_collision.pairs, searches: self_collision.searches, renderer });
  }
rmSync(folder, { recursive: true });

const base = median(cases[0].seconds);
console.log("| bodies | triangles | s for 0.6 s | to the first | pairs | searches |\n|---|---|---|---|---|---|");
const results = cases.map(({ bodies, triangles, seconds, pairs, searches, renderer }) => {
  const step_s = median(seconds);
  const row = [bodies.length, triangles, step_s.toFixed(3), (step_s / base).toFixed(2), pairs, searches];
  console.log(`| ${row.join(" | ")} |`);
  return { bodies: bodies.length, triangles, step_s, to_the_first: step_s / base, pairs, searches, renderer };
});
mkdirSync(join(here, "results"), { recursive: true });
writeFileSync(
  join(here, `results/bodies-${machine}.json`),
  `${JSON.stringify({ machine, load, rounds, results }, null, 1)}\n`,
);
