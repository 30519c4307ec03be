// C++ follows .clang-format.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { test } from "node:test";
import { files, root } from "./files.mjs";

const version = /version (\d+)/.exec(spawnSync("clang-format", ["--version"], { encoding: "utf8" }).stdout ?? "")?.[1];
const skip =
  version !== "14" &&
  `clang-format is ${version ?? "not installed"}; others than 14 (Debian 12) lay out a little differently`;
test("C++ is laid out as clang-format does it", { skip }, () => {
  const sources = files.filter((file) => /\.(?:h|cpp)$/.test(file));
  const { status, stderr } = spawnSync("clang-format", ["--dry-run", "-Werror", ...sources], {
    cwd: root,
    encoding: "utf8",
  });
  assert.equal(status, 0, stderr);
});
