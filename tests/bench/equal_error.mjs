// Cost of the same accuracy under each method (bench_equal_error), with the machine that it was measured on, and as a
// table, which is printed.
//   node tests/bench/equal_error.mjs [MACHINE]   ->   tests/bench/results/equal_error-MACHINE.json
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { cpus, loadavg } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const build = join(here, "../../build/release");
const machine = process.argv[2] ?? `${cpus().length}-cores`;
execFileSync("cmake", ["--build", build, "--target", "bench_equal_error"], { stdio: "ignore" });
const load = loadavg()[0];
const measured = execFileSync(join(build, "tests/bench_equal_error"), {
  encoding: "utf8",
  stdio: ["ignore", "pipe", "inherit"],
});
const about = { machine, cpu: cpus()[0].model, cores: cpus().length, load_average: load };
const out = join(here, `results/equal_error-${machine}.json`);
// Inserted as text, so that each row stays on one line.
writeFileSync(out, measured.replace(' "methods": [', `${JSON.stringify(about, null, 1).slice(2, -2)},\n "methods": [`));

const { methods } = JSON.parse(readFileSync(out, "utf8"));
const digits = (value, count) => Number(value.toPrecision(count));
const cell = (t) => {
  if (!t.reached) return "not reached";
  const iterations = t.iterations > 1 ? `, ${t.iterations}` : "";
  return `${digits(t.ms_a_simulated_s.median, 3)} (${digits(1000 * t.dt_s, 2)} ms${iterations})`;
};
for (const { method, targets } of methods) console.log(`| \`${method}\` | ${targets.map(cell).join(" | ")} |`);
console.log(`written: ${out}`);
