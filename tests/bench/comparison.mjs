// Measures the table of server/README.md that compares the methods, and springs with finite elements, and prints it:
// speed, stability, accuracy and ease, each a figure of this run.
//   node tests/bench/comparison.mjs [MACHINE] [--budget S] [--methods a,b] [--out FILE]
//   ->   tests/bench/results/comparison-MACHINE.json, the table on stdout
// Methods: the swinging cloth of tests/README.md, a little damped, so that explicit Euler has a stable step, too.
// Models: the sheet of sheet-fem.json, and the springs that are fitted to it.
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { cpus, loadavg, tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { sheet, writeSheetOfSprings } from "./sheet_springs.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const shaders = join(here, "../../shaders");
const program = process.env.CLOTHLAB ?? join(here, "../../build/release/clothlab");
const { values, positionals } = parseArgs({
  options: { budget: { type: "string", default: "60" }, methods: { type: "string" }, out: { type: "string" } },
  allowPositionals: true,
});
const machine = positionals[0] ?? `${cpus().length}-cores`;
const folder = mkdtempSync(join(tmpdir(), "clothlab-comparison-"));
const load = loadavg()[0];

/** The JSON answer of a command of the lab, or null with the reason on stderr. */
function lab(...words) {
  console.error(`clothlab ${words.join(" ")}`);
  const found = spawnSync(program, [...words, "--json", "--fresh"], { encoding: "utf8", maxBuffer: 1 << 28 });
  if (found.status === 0) return JSON.parse(found.stdout);
  console.error(found.stderr);
  return null;
}

/** Lines of a shader and of all that it includes, without comments and empty ones; of the methods' folder alone. */
function lines(paths, folderOfAll) {
  const seen = new Set();
  const visit = (path) => {
    if (seen.has(path)) return 0;
    seen.add(path);
    let count = 0;
    for (const line of readFileSync(join(folderOfAll, path), "utf8").split("\n")) {
      const include = line.match(/^#include "([\w.]+)"/);
      if (include) count += visit(include[1]);
      else if (line.trim() !== "" && !/^\s*\/\//.test(line)) ++count;
    }
    return count;
  };
  return paths.reduce((sum, path) => sum + visit(path), 0);
}
const kernels = {
  explicit_euler: ["explicit_euler.comp"],
  symplectic_euler: ["symplectic_euler.comp"],
  verlet: ["verlet.comp"],
  rk4: ["rk4.comp"],
  implicit_euler: ["start", "contacts", "system", "multiply", "update", "search", "advance", "end"].map(
    (part) => `implicit_${part}.comp`,
  ),
  pbd: ["gauss_seidel.comp", "element_projection.glsl"],
  xpbd: ["gauss_seidel.comp", "element_projection.glsl"],
  vbd: ["gauss_seidel.comp", "vertex_descent.glsl"],
};
kernels.bdf2 = [...kernels.implicit_euler, "bdf2_keep.comp"];
const sweepAlone = { pbd: "vertex_descent.glsl", xpbd: "vertex_descent.glsl", vbd: "element_projection.glsl" };
const kernelLines = (method) => {
  const all = lines(kernels[method], join(shaders, "methods"));
  return sweepAlone[method] ? all - lines([sweepAlone[method]], join(shaders, "methods")) : all;
};
/** What a user must choose besides the material; the lab's settings say which of them a method looks at. */
const parameters = (point) => ["dt", ...["iterations", "tolerance"].filter((key) => point?.[key] != null)];

/** The order of the error over the steps of one ladder, and the error at the longest step that did not blow up. */
function accuracy(chart) {
  const floor = 4 * (chart.axes.position.float32_floor ?? 0);
  const held = chart.points.filter((p) => p.blew_up_at_s === null && p.error.position !== null);
  if (held.length === 0) return { order: null, error_at_longest: null };
  const longest = held.reduce((a, b) => (a.dt_s > b.dt_s ? a : b));
  const alike = (p) => p.iterations === longest.iterations && p.tolerance === longest.tolerance;
  const ladder = held.filter((p) => alike(p) && p.error.position > floor && p.error.position < 0.05);
  ladder.sort((a, b) => b.dt_s - a.dt_s);
  const [first, last] = [ladder[0], ladder.at(-1)];
  // An error that does not fall is float32's, not the method's.
  const falls = ladder.length > 1 && first.error.position > 2 * last.error.position;
  const order = falls ? Math.log(first.error.position / last.error.position) / Math.log(first.dt_s / last.dt_s) : null;
  return { order, longest_dt_s: longest.dt_s, error_at_longest: longest.error.position };
}

/** Speed, stability and accuracy of one method on a scene. */
function measure(scene, time, method, damping) {
  const set = damping === undefined ? [] : ["--set", `/cloths/0/material/damping=${damping}`];
  const choice = lab("choose", scene, ...set, "--methods", method, "--tolerance", "0.01", "--time", time);
  const map = lab("stability", scene, ...set, "--methods", method, "--from", "1", "--to", "1.05", "--columns", "2");
  const chart = lab("chart", scene, ...set, "--methods", method, "--time", time, "--budget", values.budget);
  const column = map?.methods[0].columns[0];
  const chosen = choice?.chosen;
  return {
    method,
    met: choice?.met ?? false,
    ms_a_simulated_s: chosen?.ms_a_simulated_s?.median ?? null,
    ms_a_step: chosen?.ms_a_simulated_s ? chosen.ms_a_simulated_s.median * chosen.dt_s : null,
    dt_s: chosen?.dt_s ?? null,
    iterations: chosen?.iterations ?? null,
    longest_held_s: column?.held_s ?? null,
    shortest_failed_s: column?.failed_s ?? null,
    theory_s: column?.theory_s ?? null,
    ...(chart ? accuracy(chart) : { order: null, error_at_longest: null }),
    parameters: parameters(chosen),
    kernel_lines: kernelLines(method),
  };
}

const swinging = join(here, "swinging-cloth.json");
const wanted = values.methods?.split(",") ?? Object.keys(kernels);
const methods = wanted.map((method) => measure(swinging, "0.3", method, 0.02));

const sheetOfSprings = join(folder, "sheet-springs.json");
writeSheetOfSprings(program, sheetOfSprings);
const simpler = lab("simplify", sheet, "--time", "0.3");
const variant = (words) => simpler?.variants.find(({ name }) => name.includes(words)) ?? {};
const schema = JSON.parse(readFileSync(join(here, "../../server/scene/scene.schema.json"), "utf8"));
const isModel = (value, name) => value?.properties?.model?.const === name;
const findModel = (value, name) =>
  isModel(value, name)
    ? value
    : Object.values(Object(value)).reduce(
        (found, each) => found ?? (each && typeof each === "object" ? findModel(each, name) : null),
        null,
      );
const materialKeys = (name) => Object.keys(findModel(schema, name).properties).filter((key) => key !== "model");
const elements = join(shaders, "elements");
const models = [
  {
    model: "springs",
    ...measure(sheetOfSprings, "0.3", "symplectic_euler"),
    change_of_fem: variant("springs instead").change ?? null,
    cost_of_fem: variant("springs instead").cost_ratio ?? null,
    law_lines: lines(["spring.glsl"], elements),
    material: materialKeys("springs"),
  },
  {
    model: "fem",
    ...measure(sheet, "0.3", "symplectic_euler"),
    change_at_half_resolution: variant("half the mesh").change ?? null,
    law_lines: lines(["membrane.glsl", "bending.glsl"], elements),
    material: materialKeys("fem"),
  },
];
rmSync(folder, { recursive: true });

const about = { machine, cpu: cpus()[0].model, cores: cpus().length, load_average: load, renderer: simpler?.renderer };
const out = values.out ?? join(here, `results/comparison-${machine}.json`);
const what = "methods on the swinging cloth (damping 0.02 N s/m), models on the sheet of sheet-fem.json";
writeFileSync(
  out,
  `${JSON.stringify({ what, ...about, budget_s: Number(values.budget), methods, models }, null, 1)}\n`,
);

const digits = (value, count = 2) => (value == null ? "-" : `${Number(value.toPrecision(count))}`);
const ms = (seconds) => digits(seconds == null ? null : 1000 * seconds);
const speed = (r) =>
  r.ms_a_simulated_s == null
    ? "no step is exact enough"
    : `${digits(r.ms_a_simulated_s)} (${ms(r.dt_s)} ms${r.iterations > 1 ? `, ${r.iterations} iterations` : ""}; ` +
      `${digits(r.ms_a_step)} a step)${r.met ? "" : ", 1e-2 not reached"}`;
const stable = (r) => {
  if (r.shortest_failed_s === null)
    return r.longest_held_s === null ? "-" : `no limit found (${ms(r.longest_held_s)} ms tried)`;
  return `${ms(r.longest_held_s)} ms`;
};
const exact = (r) =>
  `${digits(r.error_at_longest)} at ${ms(r.longest_dt_s)} ms; ${r.order === null ? "float32 hides the order" : `order ${digits(r.order)}`}`;
const rows = [
  ["", "speed: ms a simulated second at 1e-2", "stability: longest step", "accuracy: error over size", "ease"],
  ["---", "---", "---", "---", "---"],
  ...methods.map((r) => [
    `\`${r.method}\``,
    speed(r),
    stable(r),
    exact(r),
    `${r.parameters.join(", ")}; ${r.kernel_lines} lines`,
  ]),
  ...models.map((r) => [
    r.model === "fem" ? "finite elements" : "springs fitted to them",
    speed(r),
    stable(r),
    r.model === "fem"
      ? `half the resolution changes ${digits(r.change_at_half_resolution)}`
      : `${digits(r.change_of_fem)} from finite elements`,
    `${r.material.length} numbers of the material; ${r.law_lines} lines`,
  ]),
];
for (const row of rows) console.log(`| ${row.join(" | ")} |`);
console.log(`\nwritten: ${out}`);
