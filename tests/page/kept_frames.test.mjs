// The frames that a page keeps to look at again: at most a minute and so many bytes of them, of one cloth.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { KeptFrames, longest, mostBytes } = await load("link/kept_frames");
const frame = (step, bytes = 1000, topologyRevision = 1) => ({
  header: { step, topologyRevision },
  buffer: { byteLength: bytes },
});
const steps = (kept) => kept.all.map(({ frame: { header } }) => header.step);

test("frames are kept for a minute, in the order in which they came", () => {
  const kept = new KeptFrames();
  for (let i = 0; i < 5000; ++i) kept.take(frame(i), 20 * i);
  const listed = steps(kept);
  assert.equal(listed.at(-1), 4999);
  assert.equal(listed.length, longest / 20 + 1);
  assert.equal(kept.bytes, 1000 * listed.length);
});

test("of large frames so many are kept as there is room for, and one at least", () => {
  const kept = new KeptFrames();
  for (let i = 0; i < 40; ++i) kept.take(frame(i, mostBytes / 10), i);
  assert.deepEqual(steps(kept), [30, 31, 32, 33, 34, 35, 36, 37, 38, 39]);
  kept.take(frame(40, 2 * mostBytes), 40);
  assert.deepEqual(steps(kept), [40]);
});

test("steps that the session has gone back behind, and another cloth's, are forgotten", () => {
  const kept = new KeptFrames();
  for (let i = 0; i < 10; ++i) kept.take(frame(10 * i), i);
  const back = [];
  kept.wentBack = (step) => back.push(step);
  kept.take(frame(90), 10); // the same step again
  kept.take(frame(45), 10);
  assert.deepEqual(steps(kept), [0, 10, 20, 30, 40, 45]);
  assert.deepEqual(back, [45]);
  kept.take(frame(0, 1000, 2), 11);
  assert.deepEqual(back, [45, 0]);
  assert.deepEqual(steps(kept), [0]);
  assert.equal(kept.bytes, 1000);
});
