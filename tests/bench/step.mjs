// Cost of a step per method and grid, with reads through buffer textures and through storage buffers, and the seed
// scene's real-time factor. Configurations alternate, so that a noisy machine disturbs all alike; medians and minima
// are kept.
//   node tests/bench/step.mjs [MACHINE]   ->   tests/bench/results/step-MACHINE.json
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { cpus, loadavg, tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { median } from "../median.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const build = join(here, "../../build/release");
const machine = process.argv[2] ?? `${cpus().length}-cores`;
const rounds = 5;
execFileSync("cmake", ["--build", build, "--target", "bench_step", "clothlab"], { stdio: "ignore" });

/** Steps a run: enough for about a second a configuration, and past the first folds of the cloth. */
const grids = [
  { side: 25, warmUp: 1500, steps: 1000 },
  { side: 64, warmUp: 300, steps: 300 },
  { side: 128, warmUp: 100, steps: 100 },
  { side: 256, warmUp: 40, steps: 30 },
];

const results = [];
for (const grid of grids)
  for (const selfCollision of [false, true])
    for (const reads of selfCollision ? ["texture"] : ["texture", "storage"])
      results.push({ ...grid, selfCollision, reads, samples: [] });

let renderer = "";
for (let round = 0; round < rounds; ++round) {
  for (const result of results) {
    const words = [result.side, Number(result.selfCollision), result.warmUp, result.steps, 3].map(String);
    const env = { ...process.env, CLOTHLAB_READS: result.reads };
    const line = JSON.parse(execFileSync(join(build, "tests/bench_step"), words, { env, encoding: "utf8" }));
    renderer = line.renderer;
    result.samples.push(...line.ns_per_vertex_step);
  }
}

const reportPath = join(mkdtempSync(join(tmpdir(), "clothlab-bench-")), "report.json");
const realTimeFactors = [];
for (let round = 0; round < rounds; ++round) {
  execFileSync(join(build, "clothlab"), ["run", "seed", "--time", "10", "--report", reportPath], { stdio: "ignore" });
  const report = JSON.parse(readFileSync(reportPath, "utf8"));
  realTimeFactors.push(report.sim_time / report.step_s);
}

const summary = {
  what: "ns per vertex and step, symplectic Euler, seed scene on other grids",
  machine,
  renderer,
  cpu: cpus()[0].model,
  cores: cpus().length,
  load_average: loadavg()[0],
  seed_real_time_factor: { median: median(realTimeFactors), runs: realTimeFactors },
  step: results.map((r) => ({
    side: r.side,
    self_collision: r.selfCollision,
    reads: r.reads,
    median_ns: median(r.samples),
    min_ns: Math.min(...r.samples),
    runs: r.samples.length,
  })),
};
const out = join(here, `results/step-${machine}.json`);
writeFileSync(out, JSON.stringify(summary, null, 1) + "\n");
console.log(`seed: ${summary.seed_real_time_factor.median.toFixed(1)} times real time`);
for (const r of summary.step)
  console.log(
    `${r.side}x${r.side} ${r.self_collision ? "self-collision" : "no self-collision"} ${r.reads}: ` +
      `${r.median_ns.toFixed(0)} ns median, ${r.min_ns.toFixed(0)} min`,
  );
console.log(`written: ${out}`);
