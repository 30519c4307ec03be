// The page's TypeScript has no type error: the bundler only strips types and would not notice.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { root } from "./files.mjs";

const compiler = join(root, "web/node_modules/typescript/bin/tsc");
const skip = !existsSync(compiler) && "web/node_modules is not installed: server/run or tests/run do it";
test("the page's TypeScript has no type error", { skip }, () => {
  const { status, stdout } = spawnSync(process.execPath, [compiler, "--noEmit", "-p", "web"], {
    cwd: root,
    encoding: "utf8",
  });
  assert.equal(status, 0, stdout);
});
