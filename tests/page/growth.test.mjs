// The growing mode of a blow-up, found in places a step apart.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { swing } = await load("show/growth");

/// Places along x after `step` steps: all move on evenly, and every other vertex swings from side to side by the mode's
/// amplitude there, grown `factor` times a step.
const places = (step, amplitudes, factor) =>
  Float32Array.from(amplitudes.flatMap((amplitude, i) => [i + 0.01 * step, amplitude * (-factor) ** step, 0]));

test("what swings from side to side at each step is told from what moves evenly, as shares of the largest", () => {
  const amplitudes = [0, 0.001, -0.002, 0.004, 0];
  const shares = swing(...[0, 1, 2].map((step) => places(step, amplitudes, 1)), 1e-9);
  // 1e-4: positions of up to 4 m as floats of 24 bits, 2.4e-7 m, of 4 mm
  shares.forEach((share, i) => assert.ok(Math.abs(share - Math.abs(amplitudes[i]) / 0.004) < 2e-4, `${i}: ${share}`));
});

test("a mode that grows has the same shape, and an even motion has none", () => {
  const grown = swing(...[0, 1, 2].map((step) => places(step, [0.001, 0.002], 2.4)), 1e-9);
  assert.ok(Math.abs(grown[0] - 0.5) < 1e-3 && grown[1] === 1);
  const even = swing(...[0, 1, 2].map((step) => places(step, [0, 0, 0], 1)), 1e-4);
  assert.ok(even.every((share) => share < 0.01));
});
