// The program's sources under clang-tidy with the checks of .clang-tidy, eight at a time as they are compiled: most of
// the time goes into the headers that they share.
import assert from "node:assert/strict";
import { execFile, spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { availableParallelism } from "node:os";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { promisify } from "node:util";
import { root } from "./files.mjs";

const version = /version (\d+)/.exec(spawnSync("clang-tidy", ["--version"], { encoding: "utf8" }).stdout ?? "")?.[1];
const skip = version !== "14" && `clang-tidy is ${version ?? "not installed"}; others than 14 (Debian 12) ask for more`;

test("clang-tidy has nothing to say about the program's sources", { skip }, async () => {
  const build = dirname(process.env.CLOTHLAB ?? join(root, "build/release/clothlab"));
  const sources = JSON.parse(readFileSync(join(build, "compile_commands.json"), "utf8"))
    .map(({ file }) => file)
    .filter((file) => /\/(?:server|Unity)\//.test(file));
  assert.ok(sources.length > 10, `${sources.length} sources in ${build}`);
  const said = [];
  const next = async () => {
    for (let source = sources.pop(); source; source = sources.pop()) {
      const { stdout } = await promisify(execFile)("clang-tidy", ["-quiet", "-p", build, source], {
        maxBuffer: 1 << 26,
      }).catch((failed) => failed);
      if (/(?:warning|error): /.test(stdout)) said.push(stdout);
    }
  };
  await Promise.all(Array.from({ length: availableParallelism() }, next));
  assert.equal(said.join("\n"), "");
});
