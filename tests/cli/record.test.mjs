// `clothlab record`: a recording is what `run` computes; its page is one small file.
import assert from "node:assert/strict";
import { existsSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { clothlab, folder } from "./program.mjs";
import { inPage, pointCache, readRecording as read, record } from "./recordings.mjs";

test("its frames are the states that run computes, to half a 512th of an edge, with colliders that move", async () => {
  const changed = ["--set", '/colliders/0/motion={"linear":{"velocity":[1,0,0]}}'];
  const { status, stdout, path } = record(["seed", "--time", "1.1", "--rate", "20", ...changed], "a.clothlab");
  assert.equal(status, 0);
  assert.match(stdout, /^a\.clothlab: 23 frames of seed, 1\.1 s, \d+ bytes\n$/);
  const { recording, moments } = await read(readFileSync(path));
  assert.equal(recording.rate, 20);
  assert.equal(moments.length, 23);
  assert.equal(recording.diverged, null);
  const [{ setting }] = recording.groups;
  assert.equal(setting.document.name, "seed");
  assert.equal(setting.topology.vertexCount, 625);
  const run = clothlab(["run", "seed", "--time", "1.1", "--every", "0.05", "--out", "a.pc2", ...changed]);
  assert.equal(run.status, 0, run.stderr);
  const states = pointCache(join(folder, "a.pc2"));
  assert.equal(states.length, 23);
  const edge = (2 + Math.SQRT2) / 3 / 24; // a little off: the border has more sides than diagonals
  for (const [k, { step, time, low, quantum, numbers, moved }] of moments.entries()) {
    assert.equal(step, 50 * k);
    assert.ok(Math.abs(time - 0.05 * k) < 1e-9);
    assert.ok(Math.abs(quantum * 512 - edge) < 0.01 * edge, `${quantum}`);
    assert.ok(Math.abs(moved[0].sphere.center[0] - 0.05 * k) < 1e-6);
    for (let i = 0; i < numbers.length; ++i)
      assert.ok(Math.abs(low[i % 3] + quantum * numbers[i] - states[k][i]) < 0.51 * quantum, `frame ${k}, number ${i}`);
  }
});

test("lengths at rest are those of the cloth that nothing pulls", async () => {
  const { path } = record(["seed", "--time", "0"], "rest.clothlab");
  const { recording, moments } = await read(readFileSync(path));
  const [{ setting }] = recording.groups;
  const { numbers, quantum } = moments[0];
  setting.restLengths.forEach((rest, e) => {
    const [a, b] = [setting.edges[2 * e], setting.edges[2 * e + 1]];
    const length = quantum * Math.hypot(...[0, 1, 2].map((axis) => numbers[3 * a + axis] - numbers[3 * b + axis]));
    assert.ok(Math.abs(length - rest) < 2 * quantum, `edge ${a} ${b}: ${length}, ${rest}`);
  });
});

test("10 s of the seed at 30 frames a second are a page of at most 1 MB, which loads nothing", async () => {
  const { status, path } = record(["seed", "--time", "10"], "seed.html");
  assert.equal(status, 0);
  const { size } = statSync(path);
  assert.ok(size <= 1e6, `${size} bytes`);
  const html = readFileSync(path, "utf8");
  assert.doesNotMatch(html, /\b(?:src|href)=(?!"data:,")|@import|url\(/);
  assert.match(html, /default-src 'none'/);
  assert.match(html, /<title>seed<\/title>/);
  const { recording } = await read(inPage(html));
  assert.ok(recording.frames >= 300 && recording.frames <= 306);
});

test("a scene that blows up is kept up to there, marked, with exit code 4", async () => {
  const { status, stderr, path } = record(["blowup", "--time", "3"], "blowup.html");
  assert.equal(status, 4);
  assert.match(stderr, /the simulation diverged/);
  const { recording, moments } = await read(inPage(readFileSync(path, "utf8")));
  assert.ok(recording.diverged.reason.length > 10);
  assert.ok(moments.length > 0 && moments.at(-1).time < 3);
});

test("a name that is markup is text in the page", () => {
  const { path } = record(["seed", "--time", "0", "--set", '/name="</title><script>1"'], "name.html");
  assert.match(readFileSync(path, "utf8"), /<title>&lt;\/title>&lt;script>1<\/title>/);
});

test("a rate between whole steps is told, and a step longer than a frame makes fewer frames", async () => {
  const { stderr } = record(["seed", "--time", "0.1", "--rate", "30"], "b.clothlab");
  assert.match(stderr, /--rate 30: a frame every 33 steps/);
  const slow = record(
    ["seed", "--time", "0.4", "--rate", "120", "--set", "/solver/dt=0.05", "--set", '/solver/method="xpbd"'],
    "c.clothlab",
  );
  assert.match(slow.stderr, /--rate 120: a frame every 1 steps of 0.05 s, so 20 a second/);
  const { recording, moments } = await read(readFileSync(slow.path));
  assert.deepEqual([recording.rate, moments.length], [20, 9]);
});

for (const [what, [args, out, message]] of Object.entries({
  "another kind of file": [["seed", "--time", "1"], "a.gif", /\.html .*\.clothlab .*\.glb, \.usda or \.pc2 .*\.obj/],
  "no frames a second": [["seed", "--time", "1", "--rate", "0"], "a.html", /1 to 120/],
  "too many frames a second": [["seed", "--time", "1", "--rate", "121"], "a.html", /1 to 120/],
  "a rate that is no number": [["seed", "--time", "1", "--rate", "nan"], "a.html", /1 to 120/],
  "a folder that is not there": [["seed", "--time", "1"], "nowhere/a.html", /nowhere/],
}))
  test(`${what} exits 2 before anything is simulated, and leaves no file`, () => {
    const { status, stderr, path } = record(args, out);
    assert.equal(status, 2, stderr);
    assert.match(stderr, message);
    assert.ok(!existsSync(path));
  });

test("without the player a page is refused with what to do, and the recording alone is not", () => {
  writeFileSync(join(folder, "empty"), "");
  const nowhere = { CLOTHLAB_DATA: join(folder, "nowhere") };
  // The source tree has it, if the page has been built there.
  assert.equal(clothlab(["record", "seed", "--time", "0", "--out", "d.clothlab"], nowhere).status, 0);
});
