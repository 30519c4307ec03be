// Cost of a step per method and grid, against symplectic Euler in the same round, and cost and effect of the strain
// limit.
//   node tests/bench/methods.mjs [MACHINE]   ->   tests/bench/results/methods-MACHINE.json
import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { cpus, loadavg } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { median } from "../median.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const build = join(here, "../../build/release");
const machine = process.argv[2] ?? `${cpus().length}-cores`;
const rounds = { 25: 31, 64: 21, 128: 11, 256: 7 };
execFileSync("cmake", ["--build", build, "--target", "bench_methods", "bench_strain_limit"], { stdio: "ignore" });

const lines = (program, ...words) =>
  execFileSync(join(build, "tests", program), words.map(String), { encoding: "utf8" })
    .trim()
    .split("\n")
    .map((line) => JSON.parse(line));

const load = loadavg()[0];
let renderer = "";
const methods = [];
for (const [side, count] of Object.entries(rounds)) {
  const results = lines("bench_methods", side, count);
  const symplectic = results.find((r) => r.method === "symplectic_euler");
  for (const r of results) {
    renderer = r.renderer;
    const { ns, renderer: _, ...rest } = r;
    methods.push({
      ...rest,
      median_ns: median(ns),
      min_ns: Math.min(...ns),
      to_symplectic: +median(ns.map((value, i) => value / symplectic.ns[i])).toFixed(3),
      rounds: count,
    });
  }
}
const strainLimit = lines("bench_strain_limit");
const summary = {
  what: "cost of a step per method, seed scene on other grids, no self-collision; strain limit",
  machine,
  renderer,
  cpu: cpus()[0].model,
  cores: cpus().length,
  load_average: load,
  methods,
  strain_limit: strainLimit,
};
const out = join(here, `results/methods-${machine}.json`);
writeFileSync(out, JSON.stringify(summary, null, 1) + "\n");
console.table(
  methods.map((m) => ({
    side: m.side,
    method: m.method,
    iterations: m.iterations,
    "ns median": m.median_ns,
    "ns min": m.min_ns,
    "to symplectic": m.to_symplectic,
    dispatches: m.dispatches,
    "bytes a vertex": m.bytes_a_vertex,
    "cg iterations": m.cg_iterations,
  })),
);
console.table(strainLimit);
console.log(`written: ${out}`);
