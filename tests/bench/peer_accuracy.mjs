// The same error by clothlab, Bullet and MuJoCo on one core. For the swinging cloth (swinging-cloth.json, 17x17, no
// contact) it finds the cheapest setting of each program whose RMS position error at 0.3 s is 1e-2, 1e-3 and 1e-4 of
// its size, against the double-precision reference of the same springs, and the milliseconds of stepping for a
// simulated second; and the largest stretch of an edge once air has brought the cloth to rest. By hand, on a quiet
// machine, in six minutes, after `apt-get install libbullet-dev` and `npm ci --prefix tests/bench/peers`:
//   node tests/bench/peer_accuracy.mjs [MACHINE] [--rounds N] [--only PATTERN] [--out FILE]
//                                      ->   tests/bench/results/peer_accuracy-MACHINE.json, a table
// What each program was told, and why: peers/accuracy.mjs, classic.cpp, deformable.cpp, mujoco.mjs. Bullet is native
// code in 32-bit floats, MuJoCo WebAssembly in 64-bit ones, clothlab software OpenGL in 32-bit ones with one thread:
// LP_NUM_THREADS=0, unless the environment sets it. All run in turn in each round, so that noise disturbs all alike.
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { cpus, loadavg, tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { programs } from "./peers/accuracy.mjs";
import { version as mujoco_version } from "./peers/mujoco.mjs";
import { most_ms, search } from "./peers/search.mjs";
import { buildBench, bulletVersion, median, run, threads } from "./peers/shared.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const { values, positionals } = parseArgs({
  options: {
    rounds: { type: "string", default: "5" },
    only: { type: "string", default: "" },
    out: { type: "string" },
  },
  allowPositionals: true,
});
const machine = positionals[0] ?? `${cpus().length}-cores`;
const size = 0.5; // [m]
const targets = [1e-2, 1e-3, 1e-4]; // of the size
const swing = { seconds: 0.3, air_drag: 0 }; // before the cloth buckles
/** No spring is damped, since Bullet's classic links know no damping, and rest does not depend on it. After so long the
 * slowest sway has fallen to a millionth; what moves more than `still` in the last second will not rest. */
const rest = { seconds: 8, air_drag: 5 };
const still = 1e-4; // of the size
/** Of a setting that takes longer [ms a simulated second] three samples are enough; of one that takes less than
 * `fast_ms` each round takes three, since a run of some milliseconds is easily disturbed. */
const slow_ms = 2000;
const fast_ms = 200;

const started = Date.now();
const load = loadavg()[0];
const folder = mkdtempSync(join(tmpdir(), "clothlab-peer-accuracy-"));
const document = JSON.parse(readFileSync(join(here, "swinging-cloth.json"), "utf8"));
const truth = buildBench("truth");
function reference({ seconds, air_drag }, largest_step) {
  const file = join(folder, "truth.json");
  writeFileSync(file, JSON.stringify({ ...document, air_drag }));
  return JSON.parse(run(truth, [file, String(seconds), String(largest_step)]));
}
const swung = reference(swing, 1.2e-5);
const rested = reference(rest, 3e-4);

/** Root of the mean over the vertices of the squared distance [m]. */
function rmsDistance(positions, to) {
  if (!positions || !to) return Infinity;
  const squares = positions.flatMap((at, i) => at.map((x, k) => (x - to[i][k]) ** 2));
  return Math.sqrt(squares.reduce((a, b) => a + b) / positions.length);
}

const edges = swung.triangles.flatMap(([a, b, c]) => [
  [a, b],
  [b, c],
  [c, a],
]);
const distance = (at, [a, b]) => Math.hypot(...at[a].map((x, k) => x - at[b][k]));
const stretch = (at) => Math.max(...edges.map((edge) => distance(at, edge) / distance(swung.start, edge) - 1));

const digits = (value, count) => Number(value.toPrecision(count));
let renderer = "";
const contestants = (await programs(document, swung, folder)).filter(({ name }) => name.match(values.only));
function swingWith(program, { steps, iterations }) {
  const found = program.run({ dt: swing.seconds / steps, iterations, ...swing });
  renderer = found.renderer ?? renderer;
  return { ms: found.ms, error: rmsDistance(found.positions, swung.position) };
}

const goals = targets.map((target) => target * size);
for (const program of contestants) {
  Object.assign(
    program,
    search(program, (setting) => swingWith(program, setting), goals),
  );
  const { steps, iterations, error } = program.best;
  console.error(`${program.name}: least error ${error.toExponential(1)} m, ${steps} steps, ${iterations} iterations`);
}

const samplesIn = (round, { samples: [ms] }) => (ms < fast_ms ? 3 : ms > slow_ms && round > 2 ? 0 : 1);
for (let round = 0; round < Number(values.rounds); ++round)
  for (const program of contestants)
    for (const candidate of new Set(program.candidates.flat()))
      for (let sample = 0; sample < samplesIn(round, candidate); ++sample)
        candidate.samples.push(swingWith(program, candidate).ms);

/** At rest with the step of the cheapest setting within 1e-2, or of the least error. */
function restWith(program, setting) {
  const dt = swing.seconds / setting.steps;
  const after = (seconds) => program.run({ dt, iterations: setting.iterations, ...rest, seconds }).positions;
  const [before, positions] = [rest.seconds - 1, rest.seconds].map(after);
  const moved = rmsDistance(before, positions);
  return {
    iterations: setting.iterations,
    dt_s: digits(dt, 5),
    stretch: positions && digits(stretch(positions), 5),
    moved_in_last_second_m: Number.isFinite(moved) ? digits(moved, 3) : null,
    rests: moved < still * size,
  };
}

const cheapest = (candidates) =>
  candidates.reduce((a, b) => (a && median(a.samples) <= median(b.samples) ? a : b), undefined);
const results = contestants.map((program) => {
  const winners = program.candidates.map(cheapest);
  const reached = winners.map((winner, t) => {
    if (!winner) return { target: targets[t], reached: false };
    const { steps, iterations, error, samples } = winner;
    const ms = { median: digits(median(samples), 4), min: digits(Math.min(...samples), 4) };
    const dt_s = digits(swing.seconds / steps, 5);
    const error_m = digits(error, 3);
    return { target: targets[t], reached: true, iterations, steps, dt_s, error_m, ms_a_simulated_s: ms };
  });
  const { steps, iterations, error } = program.best;
  return {
    program: program.name.replaceAll("`", ""),
    targets: reached,
    least_error_tried: { error_m: digits(error, 3), steps, iterations },
    rest: restWith(program, winners[0] ?? program.best),
    ladders: program.ladders.map(({ rungs, ended }) => ({
      iterations: rungs[0].iterations,
      steps: rungs.map((rung) => rung.steps),
      error_m: rungs.map((rung) => (Number.isFinite(rung.error) ? digits(rung.error, 3) : null)),
      ended,
    })),
  };
});

/** Whether another program solves the same equations: its error at steps far below every limit. */
const agreement = [
  ["MuJoCo RK4 (WebAssembly)", 1024],
  ["MuJoCo RK4 (WebAssembly)", 2048],
  ["Bullet deformable, explicit", 4096],
  ["Bullet deformable, explicit", 8192],
].flatMap(([name, steps]) => {
  const program = contestants.find((each) => each.name === name);
  if (!program) return [];
  return { program: name, steps, error_m: digits(swingWith(program, { steps, iterations: 1 }).error, 3) };
});
rmSync(folder, { recursive: true });

const rest_stretch = stretch(rested.position);
const summary = {
  what: "cheapest settings for an RMS position error at 0.3 s of the swinging 17 x 17 cloth, and its stretch at rest",
  machine,
  renderer,
  bullet: bulletVersion(),
  mujoco: mujoco_version,
  node: process.version,
  cpu: cpus()[0].model,
  cores: cpus().length,
  llvmpipe_threads: Number(threads),
  load_average: load,
  rounds: Number(values.rounds),
  took_s: Math.round((Date.now() - started) / 1000),
  size_m: size,
  most_ms_a_simulated_s: most_ms,
  reference: { error_m: digits(swung.error_m, 2), rest_stretch, rest_error_m: digits(rested.error_m, 2) },
  agreement,
  results,
};
const out = values.out ?? join(here, `results/peer_accuracy-${machine}.json`);
// A list of numbers stays on one line.
const text = JSON.stringify(summary, null, 1).replace(/\[[\s\d.,e+-]*(?:null[\s\d.,e+-]*)*\]/g, (list) =>
  list.replace(/\s+/g, " "),
);
writeFileSync(out, `${text}\n`);

const cell = (t, r) => {
  if (!t.reached) return `not reached (${digits(1e6 * r.least_error_tried.error_m, 2)} um)`;
  const iterations = t.iterations > 1 ? `, ${t.iterations}` : "";
  const { median: middle, min } = t.ms_a_simulated_s;
  return `${digits(middle, 2)} / ${digits(min, 2)} (${digits(1000 * t.dt_s, 2)} ms${iterations})`;
};
const percent = (value) => `${(100 * value).toFixed(2)} %`;
const head = ["program", ...targets.map((target) => target.toExponential()), "stretch at rest"];
const rows = results.map((r) => [
  /^[a-z]/.test(r.program) ? `\`${r.program}\`` : r.program,
  ...r.targets.map((t) => cell(t, r)),
  r.rest.rests ? percent(r.rest.stretch) : "does not rest",
]);
for (const row of [head, Array(head.length).fill("---"), ...rows]) console.log(`| ${row.join(" | ")} |`);
console.log(`\nstretch at rest of the reference: ${percent(rest_stretch)}`);
for (const { program, steps, error_m } of agreement) console.log(`${program}, ${steps} steps: ${error_m} m`);
console.log(`written: ${out}`);
