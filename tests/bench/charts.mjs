// Draws speed against accuracy, and the stability map, of the scenes that server/lab/README.md shows; and of one sheet
// as finite elements and as springs that are fitted to it (server/scene/fitted_springs.h, by `clothlab simplify`).
//   node tests/bench/charts.mjs [MACHINE] [SCENE...] [--budget S] [--results DIR]
// It writes chart-SCENE-MACHINE.{svg,json}, one stability map, and simplify-sheet-fem-MACHINE.{svg,json} into
// tests/bench/results.
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdtempSync, rmSync } from "node:fs";
import { cpus, loadavg, tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { sheet, writeSheetOfSprings } from "./sheet_springs.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const program = process.env.CLOTHLAB ?? join(here, "../../build/release/clothlab");
const { values, positionals } = parseArgs({
  options: { budget: { type: "string", default: "150" }, results: { type: "string", default: join(here, "results") } },
  allowPositionals: true,
});
const [machine = `${cpus().length}-cores`, ...wanted] = positionals;
const folder = mkdtempSync(join(tmpdir(), "clothlab-charts-"));
const swinging = join(here, "swinging-cloth.json");
const sheetOfSprings = join(folder, "sheet-springs.json");
const jobs = [
  ["chart", "seed", ["seed", "--time", "1"]],
  ["chart", "swinging-cloth", [swinging, "--time", "0.3"]],
  ["chart", "hanging-strip", ["hanging-strip", "--time", "1"]],
  ["chart", "flag", ["flag", "--time", "1"]],
  ["stability", "seed", ["seed"]],
  ["simplify", "sheet-fem", [sheet, "--time", "0.5"]],
  ["chart", "sheet-fem", [sheet, "--time", "0.5"]],
  ["chart", "sheet-springs", [sheetOfSprings, "--time", "0.5"]],
];

for (const [kind, name, scene] of jobs) {
  if (wanted.length > 0 && !wanted.includes(name)) continue;
  if (name === "sheet-springs") writeSheetOfSprings(program, sheetOfSprings);
  const budget = kind === "chart" ? ["--budget", values.budget] : [];
  console.log(`${kind} ${name}, load average ${loadavg()[0].toFixed(2)}`);
  execFileSync(program, [kind, ...scene, ...budget, "--fresh", "--out", folder], { stdio: "inherit" });
  for (const ending of ["svg", "json"])
    copyFileSync(join(folder, `${kind}.${ending}`), join(values.results, `${kind}-${name}-${machine}.${ending}`));
}
rmSync(folder, { recursive: true });
