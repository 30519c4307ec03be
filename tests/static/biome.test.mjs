// TypeScript and scripts follow .biome.jsonc, in layout and rules.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { root } from "./files.mjs";

const biome = join(root, "tests/node_modules/@biomejs/biome/bin/biome");
const skip = !existsSync(biome) && "tests/node_modules is not installed: tests/run does it";
for (const task of ["format", "lint"])
  test(`biome ${task} has nothing to say (else: tests/node_modules/.bin/biome ${task} --write)`, { skip }, () => {
    const { status, stdout, stderr } = spawnSync(process.execPath, [biome, task, "--error-on-warnings"], {
      cwd: root,
      encoding: "utf8",
    });
    assert.equal(status, 0, stdout + stderr);
  });
