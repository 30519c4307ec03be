// The page applies accepted patches as RFC 6902 and RFC 7396 say.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { applyPatch, valueAt } = await load("link/json_patch");

test("a merge patch replaces, adds and with null removes, down to any depth (RFC 7396, appendix A)", () => {
  const cases = [
    [{ a: "b" }, { a: "c" }, { a: "c" }],
    [{ a: "b" }, { b: "c" }, { a: "b", b: "c" }],
    [{ a: "b", b: "c" }, { a: null }, { b: "c" }],
    [{ a: [1, 2] }, { a: [3] }, { a: [3] }],
    [{ a: { b: "c" } }, { a: { b: "d", c: null } }, { a: { b: "d" } }],
    [{ a: "text" }, { a: { bb: { ccc: null } } }, { a: { bb: {} } }],
  ];
  for (const [before, patch, after] of cases) assert.deepEqual(applyPatch(before, patch), after);
});

test("each operation of a JSON Patch does what it says, and the document before stays as it was", () => {
  const before = { list: [1, 2, 3], "a/b": { "m~n": 8 }, still: true };
  const cases = [
    [
      { op: "add", path: "/list/1", value: 9 },
      { ...before, list: [1, 9, 2, 3] },
    ],
    [
      { op: "add", path: "/list/-", value: 9 },
      { ...before, list: [1, 2, 3, 9] },
    ],
    [
      { op: "remove", path: "/list/0" },
      { ...before, list: [2, 3] },
    ],
    [
      { op: "replace", path: "/list/2", value: 0 },
      { ...before, list: [1, 2, 0] },
    ],
    [
      { op: "replace", path: "/a~1b/m~0n", value: 9 },
      { ...before, "a/b": { "m~n": 9 } },
    ],
    [
      { op: "copy", from: "/list", path: "/other" },
      { ...before, other: [1, 2, 3] },
    ],
    [
      { op: "move", from: "/list/0", path: "/list/2" },
      { ...before, list: [2, 3, 1] },
    ],
    [{ op: "replace", path: "", value: { all: 1 } }, { all: 1 }],
    [{ op: "test", path: "/still", value: true }, before],
  ];
  const kept = structuredClone(before);
  for (const [operation, after] of cases) assert.deepEqual(applyPatch(before, [operation]), after, operation.op);
  assert.deepEqual(before, kept);
  assert.throws(() => applyPatch(before, [{ op: "replace", path: "/nothing/here", value: 1 }]), /nothing at/);
});

test("a pointer that leads nowhere gives undefined, also where an object inherits such a name", () => {
  assert.equal(valueAt({ a: [{ b: 2 }] }, "/a/0/b"), 2);
  assert.equal(valueAt({ a: 1 }, "/a/b"), undefined);
  assert.equal(valueAt({}, "/toString"), undefined);
});
