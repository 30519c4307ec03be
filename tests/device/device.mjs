// Measures this machine's OpenGL device part by part, within a time, and writes what it knows after each part: whoever
// stops it early has all that came before. Called by `run` (README.md).
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { cpus } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { parts } from "./measures.mjs";
import { markdown } from "./report.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const { values } = parseArgs({
  options: {
    small: { type: "boolean", default: false },
    seconds: { type: "string", default: "480" },
    bandwidth: { type: "string" },
    out: { type: "string", default: join(here, "results") },
  },
});
const begun = performance.now();
/** Seconds that are left of all. */
if (!(Number(values.seconds) > 0)) {
  console.error(`tests/device/run: --seconds ${values.seconds}; allowed: a number above 0`);
  process.exit(2);
}
const left = () => Number(values.seconds) - (performance.now() - begun) / 1000;

mkdirSync(values.out, { recursive: true });
const result = {
  commit: readFileSync(join(here, "commit"), "utf8").trim(),
  date: new Date().toISOString(),
  small: values.small,
  processor: `${cpus()[0]?.model.trim()}, ${cpus().length} cores`,
};
const context = { here, result, small: values.small, bandwidth: Number(values.bandwidth) || null };
for (const { name, share, measure } of parts) {
  const seconds = Math.min(share ?? Infinity, left() - 5);
  console.log(`\n== ${name}, at most ${Math.max(0, Math.round(seconds))} s; ${Math.round(left())} s left`);
  const until = performance.now() + 1000 * seconds;
  if (seconds < 2) result[name] = { left_out: "no time was left" };
  else
    result[name] = await measure({ ...context, left: () => (until - performance.now()) / 1000 }).catch((error) => ({
      failed: error.message,
    }));
  for (const key of ["failed", "left_out"])
    if (result[name][key]) console.log(`${key.replace("_", " ")}: ${result[name][key]}`);
  result.seconds = Math.round((performance.now() - begun) / 1000);
  writeFileSync(join(values.out, "device.json"), `${JSON.stringify(result, null, 1)}\n`);
  writeFileSync(join(values.out, "device.md"), markdown(result));
}
const leftOut = parts.map(({ name }) => name).filter((name) => result[name].left_out);
const wrong = parts.map(({ name }) => name).filter((name) => result[name].failed || result[name].wrong);
console.log(`\n${result.seconds} s: ${join(values.out, "device.md")} and device.json`);
console.log(wrong.length === 0 ? "nothing that was measured is wrong" : `wrong: ${wrong.join(", ")}`);
if (leftOut.length > 0) console.log(`not measured: ${leftOut.join(", ")}`);
process.exitCode = wrong.length === 0 ? 0 : 1;
