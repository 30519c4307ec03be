// The stability gauge says what a time step is worth against its limit; the gauge of convergence, how far steps are
// from solved.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { reading } = await load("panel/gauge");
const { solvedReading } = await load("panel/convergence_gauge");

test("a time step is stable, marginal from nine tenths of its limit on, and unstable beyond it", () => {
  assert.equal(reading(0.0008, 0.001).word, "Stable");
  assert.equal(reading(0.00095, 0.001).word, "Marginal");
  assert.equal(reading(0.0011, 0.001).word, "Unstable");
  assert.equal(reading(0.001, 0).word, "Unstable");
});

test("a method without a limit is stable at any time step", () => {
  assert.equal(reading(0.01, null).word, "Stable");
});

test("a step is solved up to the tolerance, where the gauge's mark is, and lost beyond ten times that", () => {
  const of = (error_m) => solvedReading({ error_m, tolerance_m: 1e-3, residual: 0.02 });
  const share = "to 1 mm, 2 % left";
  assert.deepEqual(of(1e-3), { verdict: "good", word: "Solved", share, spoken: `Solved ${share}`, filled: 0.75 });
  assert.equal(of(1.1e-3).verdict, "near");
  assert.equal(of(1.1e-3).word, "Unsolved");
  assert.equal(of(1.1e-2).verdict, "beyond");
  assert.equal(of(1e-2).filled, 1);
  assert.equal(of(0).filled, 0);
  assert.ok(of(3e-6).share.startsWith("to 3 µm"));
});
