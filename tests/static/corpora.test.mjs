// The fuzz targets' inputs are packed as corpus.mjs packs them, which loses no byte.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { fileOf, packed, readPacked } from "../fuzz/corpus.mjs";

for (const target of ["dispatch", "frame", "mesh", "obj", "patch", "scene"])
  test(`the inputs of ${target} are packed, sorted by name`, () => {
    const text = readFileSync(fileOf(target), "latin1");
    assert.equal(packed(readPacked(text)), text);
  });

test("any bytes come back from a packed file", () => {
  const inputs = new Map([
    ["all", Buffer.from(Array.from({ length: 256 }, (_, byte) => byte))],
    ["empty", Buffer.alloc(0)],
    ["escapes", Buffer.from("\\n\\\n\\x41\\\\\t\\")],
  ]);
  assert.deepEqual(readPacked(packed(inputs)), inputs);
  for (const wrong of ["a\t\\", "a\t\\x4", "a\t\\q", "no tab"]) assert.throws(() => readPacked(`${wrong}\n`), wrong);
});
