// bash can read every shell script of the repository, and shellcheck has no warning.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { files, root } from "./files.mjs";

const scripts = files.filter(
  (path) =>
    path.endsWith(".sh") ||
    path.endsWith(".sbatch") ||
    (!/\.\w+$/.test(path) && /^#!.*\b(ba)?sh\b/.test(readFileSync(join(root, path), "latin1").slice(0, 60))),
);

test("bash can read every shell script", () => {
  assert.ok(scripts.includes("tests/run") && scripts.includes("server/setup.sh") && scripts.includes(".ci/run"));
  for (const script of scripts) execFileSync("bash", ["-n", script], { cwd: root });
});

const none = spawnSync("shellcheck", ["--version"]).error !== undefined;
test("shellcheck warns of nothing in any shell script", { skip: none && "shellcheck is not installed" }, () => {
  const { status, stdout } = spawnSync("shellcheck", ["--external-sources", "--severity=warning", ...scripts], {
    cwd: root,
    encoding: "utf8",
  });
  assert.equal(status, 0, stdout);
});
