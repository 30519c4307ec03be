// What tests/report.mjs reads out of ctest's log: times, and tests that were skipped, which continuous integration
// takes for failures.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { skipsOf, testsOf } from "../report.mjs";
import { root } from "./files.mjs";

const entry = (name, seconds, output, end = "Test Passed.") =>
  `1/3 Testing: ${name}\n1/3 Test: ${name}\nCommand: "x"\nOutput:\n----\n${output}\n<end of output>\n` +
  `Test time =  ${seconds} sec\n----\n${end}\n"${name}" end time: now\n----\n\n`;
const ran = "0.250 s: a short case\n1.500 s: a long case, of 2 s: told\n====\nAll tests passed (2 assertions)";
const none = "ok 1 - here\n  ---\n  duration_ms: 5.5\n  ...\nok 2 - there # SKIP no tool\n1..2\n# skipped 1";

test("a test's time, its slowest case and what it skipped are read, whichever way node tells them", () => {
  const found = testsOf(
    `Start testing\n${entry("physics: a", "1.80", ran)}${entry("static: b", "0.30", none)}` +
      entry("fuzz: c", "0.10", "no clang", "Test Skipped."),
  );
  assert.deepEqual(found, [
    { name: "physics: a", seconds: 1.8, skipped: [], slowest: [1.5, "a long case, of 2 s: told"] },
    { name: "static: b", seconds: 0.3, skipped: ["there: no tool"], slowest: [0.0055, "here"] },
    { name: "fuzz: c", seconds: 0.1, skipped: ["no clang"], slowest: undefined },
  ]);
  assert.deepEqual(skipsOf("✔ here (1.2ms)\n﹣ there (0.1ms) # no tool\n"), ["there: no tool"]);
});

test("with CLOTHLAB_NO_SKIPS=1 a skipped test is a failure, else it is told", () => {
  const tree = mkdtempSync(join(tmpdir(), "clothlab-report-"));
  mkdirSync(join(tree, "Testing/Temporary"), { recursive: true });
  const report = (log, CLOTHLAB_NO_SKIPS) => {
    writeFileSync(join(tree, "Testing/Temporary/LastTest.log"), log);
    const { status, stdout } = spawnSync(process.execPath, [join(root, "tests/report.mjs"), tree], {
      encoding: "utf8",
      env: { ...process.env, CLOTHLAB_NO_SKIPS },
    });
    return [status, /there: no tool/.test(stdout)];
  };
  const [skips, passes] = [entry("static: b", "0.30", none), entry("physics: a", "1.80", ran)];
  assert.deepEqual(
    [report(skips, "1"), report(skips, "0"), report(passes, "1")],
    [
      [1, true],
      [0, true],
      [0, false],
    ],
  );
  rmSync(tree, { recursive: true });
});
