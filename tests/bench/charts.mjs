// Draws speed against accuracy, and the stability map, of the scenes that server/lab/README.md shows.
//   node tests/bench/charts.mjs [MACHINE] [SCENE...]
// It writes tests/bench/results/chart-SCENE-MACHINE.{svg,json} and one stability map.
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdtempSync, rmSync } from "node:fs";
import { cpus, loadavg, tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const program = process.env.CLOTHLAB ?? join(here, "../../build/release/clothlab");
const [machine = `${cpus().length}-cores`, ...wanted] = process.argv.slice(2);
const swinging = join(here, "swinging-cloth.json");
const jobs = [
  ["chart", "seed", ["seed", "--time", "1"]],
  ["chart", "swinging-cloth", [swinging, "--time", "0.3"]],
  ["chart", "hanging-strip", ["hanging-strip", "--time", "1"]],
  ["chart", "flag", ["flag", "--time", "1"]],
  ["stability", "seed", ["seed"]],
];
const folder = mkdtempSync(join(tmpdir(), "clothlab-charts-"));
for (const [kind, name, scene] of jobs) {
  if (wanted.length > 0 && !wanted.includes(name)) continue;
  const budget = kind === "chart" ? ["--budget", "150"] : [];
  console.log(`${kind} ${name}, load average ${loadavg()[0].toFixed(2)}`);
  execFileSync(program, [kind, ...scene, ...budget, "--fresh", "--out", folder], { stdio: "inherit" });
  for (const ending of ["svg", "json"])
    copyFileSync(join(folder, `${kind}.${ending}`), join(here, `results/${kind}-${name}-${machine}.${ending}`));
}
rmSync(folder, { recursive: true });
