// Cost of a step of finite elements against one of springs on the same grid, under each explicit method, and the
// real-time factor of cotton on 64x64 vertices with the cheapest setting whose error is at most 1e-2.
//   node tests/bench/models.mjs [MACHINE] [--rounds N] [--out FILE]
//   ->   tests/bench/results/models-MACHINE.json
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { cpus, loadavg, tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { median } from "../median.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const build = join(here, "../../build/release");
const { values, positionals } = parseArgs({
  options: { rounds: { type: "string", default: "15" }, out: { type: "string" } },
  allowPositionals: true,
});
const machine = positionals[0] ?? `${cpus().length}-cores`;
execFileSync("cmake", ["--build", build, "--target", "bench_models", "clothlab"], { stdio: "ignore" });

const folder = mkdtempSync(join(tmpdir(), "clothlab-models-"));
const seconds = 0.25;

const load = loadavg()[0];
const steps = [];
let renderer = "";
for (const side of [25, 64, 128]) {
  const lines = execFileSync(join(build, "tests/bench_models"), [String(side), values.rounds], { encoding: "utf8" });
  const results = lines.trim().split("\n").map(JSON.parse);
  for (const { ns, renderer: name, ...rest } of results) {
    renderer = name;
    const springs = results.find((r) => r.method === rest.method && r.model === "springs");
    const ratios = ns.map((value, i) => value / springs.ns[i]);
    steps.push({ ...rest, median_ns: median(ns), min_ns: Math.min(...ns), to_springs: +median(ratios).toFixed(3) });
  }
}

/** Runs cotton.json with a setting for `seconds`: its vertices at the end, and what a simulated second cost. */
function run({ method, dt, iterations, tolerance = 1e-4 }) {
  const [mesh, report] = ["cotton.obj", "report.json"].map((name) => join(folder, name));
  const settings = { method, dt, iterations, tolerance };
  const words = ["run", join(here, "cotton.json"), "--time", String(seconds), "--out", mesh, "--report", report];
  for (const [key, value] of Object.entries(settings)) words.push("--set", `/solver/${key}=${value}`);
  const done = spawnSync(process.env.CLOTHLAB ?? join(build, "clothlab"), words, { encoding: "utf8" });
  if (done.status === 4) return { ...settings, blew_up: true };
  if (done.status !== 0) throw new Error(done.stderr);
  const { step_s, sim_time } = JSON.parse(readFileSync(report, "utf8"));
  const text = readFileSync(mesh, "utf8");
  const vertices = [...text.matchAll(/^v (\S+) (\S+) (\S+)/gm)].map((v) => v.slice(1).map(Number));
  return { ...settings, ms_a_simulated_s: (1000 * step_s) / sim_time, vertices };
}
const apart = (a, b) =>
  Math.sqrt(a.reduce((sum, v, i) => sum + v.reduce((s, x, k) => s + (x - b[i][k]) ** 2, 0), 0) / a.length);

/**
 * The cheapest setting of cotton whose error is at most 1e-2 of its metre, each method's steps halved until it is.
 * Its damping makes it too stiff for the lab's reference, RK4 in double precision; so the truth is symplectic Euler, an
 * explicit method, within its limit. A method of order 1: its error is the distance to the run whose steps are twice as
 * long.
 */
function cotton() {
  const truth = run({ method: "symplectic_euler", dt: 1e-6, iterations: 1 });
  const coarser = run({ method: "symplectic_euler", dt: 2e-6, iterations: 1 });
  const own = apart(truth.vertices, coarser.vertices);
  const tried = [];
  for (const [method, counts, tolerances] of [
    ["implicit_euler", [1, 2], [1e-1, 1e-2, 1e-3]],
    ["xpbd", [1, 4, 16], [1e-4]],
    ["vbd", [1, 4, 16], [1e-4]],
  ])
    for (const tolerance of tolerances)
      for (const iterations of counts)
        for (let dt = seconds / 8; dt > 1e-3; dt /= 2) {
          const { vertices, ...found } = run({ method, dt, iterations, tolerance });
          const error = vertices ? apart(truth.vertices, vertices) + own : null;
          tried.push({ ...found, error });
          if (error !== null && error <= 0.01) break;
        }
  const good = tried.filter(({ error }) => error !== null && error <= 0.01);
  const best = good.reduce((a, b) => (a && a.ms_a_simulated_s < b.ms_a_simulated_s ? a : b), null);
  return {
    seconds,
    reference_error: own,
    reference_ms_a_simulated_s: truth.ms_a_simulated_s,
    real_time_factor: best && 1000 / best.ms_a_simulated_s,
    best,
    tried,
  };
}

const summary = {
  what: "a step of finite elements over one of springs in the same round; cotton of 64x64 in real time",
  machine,
  renderer,
  cpu: cpus()[0].model,
  cores: cpus().length,
  load_average: load,
  rounds: Number(values.rounds),
  steps,
  largest_ratio: Math.max(...steps.map((s) => s.to_springs)),
  cotton: cotton(),
};
const out = values.out ?? join(here, `results/models-${machine}.json`);
writeFileSync(out, `${JSON.stringify(summary, null, 1)}\n`);
rmSync(folder, { recursive: true });
console.table(
  steps.map(({ side, method, model, median_ns, to_springs }) => ({ side, method, model, median_ns, to_springs })),
);
console.log(`the largest ratio: ${summary.largest_ratio}`);
console.table(summary.cotton.tried);
console.log(`cotton: ${JSON.stringify(summary.cotton.best)}, ${summary.cotton.real_time_factor} times real time`);
console.log(`written: ${out}`);
