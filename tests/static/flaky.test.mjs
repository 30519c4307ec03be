// tests/flaky.txt names tests that exist, each with a cause.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { root } from "./files.mjs";

test("each line of tests/flaky.txt is a test's name and the cause of its failures", () => {
  const lines = readFileSync(join(root, "tests/flaky.txt"), "utf8")
    .split("\n")
    .filter((line) => line && !line.startsWith("#"));
  for (const line of lines) {
    const [, label, name] = /^(\w+): ([\w-]+): .{20,}/.exec(line) ?? assert.fail(line);
    assert.ok(
      ["mjs", "cpp"].some((kind) => existsSync(join(root, `tests/${label}/${name}.test.${kind}`))),
      line,
    );
  }
});
