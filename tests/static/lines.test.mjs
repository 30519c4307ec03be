// No line is longer than 120 characters, except lines that cannot be broken: a row of a table, a link, a string. In
// TypeScript and scripts only comments are measured, since Biome breaks the code where it can.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { files, root } from "./files.mjs";

const longest = 120;
const is_text =
  /(?:\.(?:h|cpp|glsl|comp|vert|frag|mjs|ts|css|html|md|yaml|yml|cmake)|CMakeLists\.txt|\/run|Dockerfile)$/;
const without_what_stays_whole = (line, file) => {
  if (file.endsWith(".md")) return line.replace(/^\s*\|.*/, "").replaceAll(/\]\([^)]*\)/g, "]");
  if (/\.(?:ts|mjs)$/.test(file)) return /^\s*\/\//.test(line) ? line : "";
  return line.replaceAll(/"(?:[^"\\]|\\.)*"/g, "");
};

test("lines of at most 120 characters", () => {
  const found = files
    .filter((file) => is_text.test(file) && !file.startsWith("tests/bench/results/"))
    .flatMap((file) =>
      readFileSync(join(root, file), "utf8")
        .split("\n")
        .flatMap((line, index) =>
          without_what_stays_whole(line, file).length > longest ? [`${file}:${index + 1}`] : [],
        ),
    );
  assert.deepEqual(found, []);
});
