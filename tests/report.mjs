#!/usr/bin/env node
// What the last run of the tests took and left out: the ten slowest tests, each with its slowest case, and what was
// skipped.
//   node tests/report.mjs [TREE]           TREE: the build folder, build/release
//   node tests/report.mjs --costs [TREE]   writes tests/costs.txt anew (tests/CMakeLists.txt)
// With CLOTHLAB_NO_SKIPS=1 it exits with 1 if anything was skipped, or nothing was run: where all tools are installed,
// as in continuous integration, nothing has to be.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

/// Cases of a test by their seconds, in the output of Catch2's `--durations yes` and of `node --test`, both its
/// reports.
export function casesOf(output) {
  const found = [];
  for (const [, seconds, name] of output.matchAll(/^(\d+\.\d{3}) s: (.+)$/gm)) found.push([Number(seconds), name]);
  for (const [, name, ms] of output.matchAll(/^ *(?:not )?ok \d+ - (.+)\n +---\n +duration_ms: ([\d.]+)/gm))
    found.push([Number(ms) / 1000, name]);
  for (const [, name, ms] of output.matchAll(/^ *[✔✖] (.+) \(([\d.]+)ms\)$/gm)) found.push([Number(ms) / 1000, name]);
  return found.sort((a, b) => b[0] - a[0]);
}

/// Cases that `node --test` skipped, with the reason.
export const skipsOf = (output) =>
  [...output.matchAll(/^ *(?:ok \d+ - (.+) # SKIP(.*)|﹣ (.+) \([\d.]+ms\) # (.*))$/gm)].map(
    ([, name, reason, other, why]) => `${name ?? other}: ${(reason ?? why).trim() || "no reason"}`,
  );

/// The tests of ctest's log: name, seconds, slowest case and what was skipped.
export function testsOf(log) {
  return log
    .split(/^\d+\/\d+ Testing: .*$/m)
    .slice(1)
    .map((text) => {
      const name = /^\d+\/\d+ Test: (.*)$/m.exec(text)?.[1] ?? "";
      const output = /Output:\n-+\n([\s\S]*)<end of output>/.exec(text)?.[1] ?? "";
      const skipped = skipsOf(output);
      if (/^Test Skipped/m.test(text)) skipped.push(output.trim().split("\n").at(-1) ?? "");
      return {
        name,
        seconds: Number(/^Test time = +([\d.]+) sec/m.exec(text)?.[1]),
        skipped,
        slowest: casesOf(output)[0],
      };
    });
}

function main(options) {
  const costs = options[0] === "--costs";
  const root = fileURLToPath(new URL("../", import.meta.url));
  const tree = options[costs ? 1 : 0] ?? join(root, "build/release");
  const tests = testsOf(readFileSync(join(tree, "Testing/Temporary/LastTest.log"), "utf8"));
  tests.sort((a, b) => b.seconds - a.seconds);
  if (costs) {
    const lines = tests
      .filter(({ seconds }) => seconds >= 1)
      .map(({ name, seconds }) => `${seconds.toFixed(0)} ${name}`);
    const what = "# Seconds that tests took beside others on two cores, by `node tests/report.mjs --costs`.\n";
    writeFileSync(join(root, "tests/costs.txt"), `${what}${lines.join("\n")}\n`);
    return 0;
  }
  console.log(`The slowest of ${tests.length} tests, and the slowest case of each:`);
  for (const { name, seconds, slowest } of tests.slice(0, 10))
    console.log(
      `${seconds.toFixed(1).padStart(7)} s  ${name}${slowest ? ` (${slowest[0].toFixed(1)} s: ${slowest[1]})` : ""}`,
    );
  const skips = tests.flatMap(({ name, skipped }) => skipped.map((what) => `  ${name}: ${what}`));
  if (skips.length === 0) return tests.length === 0 && process.env.CLOTHLAB_NO_SKIPS === "1" ? 1 : 0;
  console.log(`Skipped:\n${skips.join("\n")}`);
  if (process.env.CLOTHLAB_NO_SKIPS !== "1") return 0;
  console.error("tests/report.mjs: error: tests were skipped, and CLOTHLAB_NO_SKIPS=1 asks for all of them");
  return 1;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) process.exitCode = main(process.argv.slice(2));
