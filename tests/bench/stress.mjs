// Where methods fail: runs bench_stress and writes its results as JSON and as tables to read and to sort.
//   node tests/bench/stress.mjs [MACHINE]   ->   tests/bench/results/stress-MACHINE.{json,csv}
//   The table of stretch against iterations and dt, for tests/README.md, is printed.
//   node tests/bench/stress.mjs MACHINE LINES.jsonl   makes them from lines printed earlier.
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { cpus } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const build = join(here, "../../build/release");
const machine = process.argv[2] ?? `${cpus().length}-cores`;
const printed = process.argv[3] ? readFileSync(process.argv[3], "utf8") : run();

function run() {
  execFileSync("cmake", ["--build", build, "--target", "bench_stress"], { stdio: "ignore" });
  return execFileSync(join(build, "tests/bench_stress"), { encoding: "utf8", maxBuffer: 1 << 26 });
}

const lines = printed
  .trim()
  .split("\n")
  .map((line) => JSON.parse(line));
const cases = lines.filter((r) => r.case),
  stretch = lines.filter((r) => r.stretch);
const { renderer } = lines[0];

/** 0.00154 -> "1.54 ms"; numbers of another knob with its unit. */
function value(r, x) {
  if (x === null) return "";
  if (r.knob !== "dt") return `${+x.toPrecision(2)} ${r.unit}`.trim();
  if (Math.abs(x * 30 - 1) < 0.01) return "1/30 s";
  if (Math.abs(x * 60 - 1) < 0.01) return "1/60 s";
  if (Math.abs(x * 120 - 1) < 0.01) return "1/120 s";
  return x >= 1e-3 ? `${+(x * 1e3).toPrecision(3)} ms` : `${+(x * 1e6).toPrecision(3)} µs`;
}

const predicted = (r) => {
  if (r.predicted_from === null) return "holds";
  if (r.predicted_from === 0) return "at every step";
  const to = `from ${value(r, r.predicted_from)}`;
  return r.predicted_at_start ? `${to}; at the start from ${value(r, r.predicted_at_start)}` : to;
};

function measured(r) {
  if (r.fails_from === null) return r.knob === "dt" ? "holds" : `holds to ${value(r, r.worst)}`;
  if (r.holds_at === null) return `fails at all tried, down to ${value(r, r.fails_from)}`;
  if (!r.in_order) return `holds at ${value(r, r.holds_at)}, fails at ${value(r, r.fails_from)}`;
  return `fails from ${value(r, r.fails_from)}`;
}

const tangle = (r) => /random|point|on a line/.test(r.case);
const rests = (r) => `${r.at_rest_shape} of ${r.held}`;
const long = cases.map((r) => [
  r.case,
  r.method,
  predicted(r),
  r.why,
  measured(r),
  r.how,
  r.at_worst === r.how ? "" : r.at_worst,
  [
    tangle(r) && `${rests(r)} that came to rest are at the rest shape`,
    r.cut_short && "runs cut short at 40,000 steps",
    r.false_alarm && "the watch calls a run that holds diverged",
  ]
    .filter(Boolean)
    .join("; "),
]);

const head = "scene,method,predicted to fail,because,measured,how just beyond,how at the worst value,remarks";
const quoted = (cells) => cells.map((cell) => (/[",]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell)).join(",");
const table = [head, ...long.map(quoted), ""].join("\n");

const steps = [...new Set(stretch.map((r) => r.dt))].map((dt) => value({ knob: "dt" }, dt));
const strip = [["method", "iterations", ...steps], steps.concat("", "").map(() => "---")].concat(
  [...new Set(stretch.map((r) => `${r.method} ${r.iterations}`))].map((key) => {
    const row = stretch.filter((r) => `${r.method} ${r.iterations}` === key);
    return [`\`${row[0].method}\``, row[0].iterations, ...row.map((r) => `${r.measured} (${r.predicted})`)];
  }),
);
const out = join(here, `results/stress-${machine}`);
const rows = (list) => `[\n${list.map((r) => "  " + JSON.stringify(r)).join(",\n")}\n ]`;
writeFileSync(
  `${out}.json`,
  `{\n "what": "from which value each method fails in each stress scene", "machine": ${JSON.stringify(machine)},
 "renderer": ${JSON.stringify(renderer)}, "cpu": ${JSON.stringify(cpus()[0].model)}, "cores": ${cpus().length},
 "cases": ${rows(cases)},\n "stretch": ${rows(stretch)}\n}\n`,
);
writeFileSync(`${out}.csv`, table);
console.log(strip.map((row) => `| ${row.join(" | ")} |`).join("\n"));
console.log(`written: ${out}.json, .csv`);
