// The stability gauge says what a time step is worth: against its limit, and where there is none, whether steps are
// solved.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { reading } = await load("panel/gauge");

test("a time step is stable, marginal from nine tenths of its limit on, and unstable beyond it", () => {
  assert.equal(reading(0.0008, 0.001).word, "Stable");
  assert.equal(reading(0.00095, 0.001).word, "Marginal");
  assert.equal(reading(0.0011, 0.001).word, "Unstable");
  assert.equal(reading(0.001, 0).word, "Unstable");
});

test("a method without a limit is stable, but not called so where its steps end far from solved", () => {
  assert.equal(reading(0.01, null).word, "Stable");
  assert.equal(reading(0.01, null, true).word, "Unsolved");
  assert.equal(reading(0.01, null, true).verdict, "near");
});
