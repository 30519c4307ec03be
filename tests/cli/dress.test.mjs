// Garments that go through a figure or through themselves, led out at the start.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { obj, pairs, sceneOf } from "../dressed.mjs";
import { clothlab, folder } from "./program.mjs";

mkdirSync(join(folder, "dress"));
const made = pairs(0.065, 0.06).map(({ name, cloth, body }, i) => {
  const files = [`cloth${i}.obj`, body ? `body${i}.obj` : null];
  writeFileSync(join(folder, "dress", files[0]), obj(cloth));
  if (body) writeFileSync(join(folder, "dress", files[1]), obj(body));
  return { name, files };
});

/// What `validate` says of the pair, led out in so many seconds; 0: as it is.
function validated({ name, files }, seconds) {
  const file = `dress/${files[0].replace("obj", "json")}`;
  writeFileSync(join(folder, file), JSON.stringify(sceneOf(name, ...files, seconds)));
  return { file, ...clothlab(["validate", file]) };
}

const hard = ["hem folded through the front", "sleeve through the side of a figure's shirt"];

test("each of the pairs is refused as it is, and starts led out, or is refused with the places", () => {
  for (const pair of made) {
    const before = validated(pair, 0);
    assert.equal(before.status, 2, pair.name);
    assert.match(before.stderr, /crossings: edge .*"dress"/, pair.name);
    const { status, stderr } = validated(pair, hard.includes(pair.name) ? 0.02 : 0.5);
    if (status === 0)
      assert.match(
        stderr,
        /led out at the start in 0\.\d+ s: \d+ vertices moved, the farthest by [\d.]+ mm/,
        pair.name,
      );
    else assert.match(stderr, /after 0\.02 s of leading out.* crossings: edge .* meets triangle/, pair.name);
    assert.ok(status === 0 || hard.includes(pair.name), `${pair.name}: ${stderr}`);
  }
});

test("a run of a start that was led out finds no crossing, from its first sample on", () => {
  const { file } = validated(made[0], 0.5);
  const { status, stderr } = clothlab(["run", file, "--time", "0.02", "--verify", "--report", "dress/report.json"]);
  assert.equal(status, 0, stderr);
  const report = JSON.parse(readFileSync(join(folder, "dress/report.json"), "utf8"));
  assert.equal(report.crossings, 0);
  assert.ok(report.crossing_check.samples >= 2);
});

test("--fit of files that cross writes a start that is led out; of others none", () => {
  const [cloth, body] = made[2].files.map((name) => `dress/${name}`);
  const { status, stdout, stderr } = clothlab(["validate", "--fit", "dress/fitted.json", cloth, "--body", body]);
  assert.equal(status, 0, stderr);
  assert.match(stdout, /valid/);
  assert.match(stderr, /it is led out at the start/);
  const scene = () => JSON.parse(readFileSync(join(folder, "dress/fitted.json"), "utf8"));
  assert.deepEqual(scene().cloths[0].start, { dress: 1 });
  clothlab(["validate", "--fit", "dress/fitted.json", body]);
  assert.equal(scene().cloths[0].start, undefined);
});
