// `clothlab chart` and `stability` in shards, which share a folder.
import assert from "node:assert/strict";
import { readdirSync, readFileSync, statSync, truncateSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { environment, lab } from "./lab_program.mjs";
import { clothlab, folder } from "./program.mjs";

const read = (...path) => JSON.parse(readFileSync(join(folder, ...path), "utf8"));
const methods = ["verlet", "symplectic_euler", "rk4"];
const of = (out, shard) => ["--methods", methods.join(), "--out", out, "--shard", shard];

test("a chart in shards has the points of all methods, the present setting first", () => {
  const chart = (shard) => lab("chart", "small.json", "--time", "0.1", "--budget", "100", ...of("chart", shard));
  assert.match(chart("1/2").stdout, /NOT COMPLETE/);
  const half = read("chart", "chart.json");
  assert.equal(half.complete, false);
  assert.ok(half.notes.includes("1 of 3 methods are not measured yet."), half.notes.join("\n"));
  chart("2/2");
  const whole = read("chart", "chart.json");
  assert.equal(whole.complete, true);
  assert.deepEqual(new Set(whole.points.map(({ method }) => method)), new Set(methods));
  assert.deepEqual([whole.points[0].method, whole.present.method], ["symplectic_euler", "symplectic_euler"]);
  // Where other programs worked on the same cores, a method has no costs, and a note says so.
  const stable = whole.points.filter(({ blew_up_at_s }) => blew_up_at_s === null);
  const costless = stable.some(({ ms_a_simulated_s }) => ms_a_simulated_s === null);
  assert.equal(costless, /costs are left out/.test(whole.notes.join()));
});

test("a map in shards is that of one call; a part that is there is not measured again, one cut in half is", () => {
  const columns = ["--columns", "2"];
  lab("stability", "small.json", ...columns, "--methods", methods.join(), "--out", "one");
  for (const shard of ["3/3", "1/3", "2/3"]) lab("stability", "small.json", ...columns, ...of("map", shard));
  const [one, map] = [read("one", "stability.json"), read("map", "stability.json")];
  assert.equal(map.complete, true);
  const by = (name) => (a, b) => a[name].localeCompare(b[name]);
  assert.deepEqual(map.methods.sort(by("method")), one.methods.sort(by("method")));

  const parts = readdirSync(join(folder, "map", "parts"));
  assert.equal(parts.length, 3);
  const written = () => parts.map((name) => statSync(join(folder, "map", "parts", name)).mtimeMs);
  const before = written();
  truncateSync(join(folder, "map", "parts", parts[1]), 100);
  lab("stability", "small.json", ...columns, ...of("map", "1/1"));
  const again = written();
  assert.deepEqual([again[0], again[2]], [before[0], before[2]]);
  assert.notEqual(again[1], before[1]);
  assert.deepEqual(read("map", "stability.json").methods.sort(by("method")), map.methods);
});

test("a wrong shard and a shard without a folder are refused", () => {
  for (const [args, words] of [
    [["--shard", "1/2"], /--shard: no --out; the folder that all shards write into/],
    [["--out", "none", "--shard", "3/2"], /--shard: "3\/2"; i\/n with 1 <= i <= n/],
    [["--out", "none", "--shard", "1/2", "--methods", "euler"], /--methods: "euler"/],
  ]) {
    const { status, stderr } = clothlab(["chart", "small.json", ...args], environment);
    assert.equal(status, 2);
    assert.match(stderr, words);
  }
});
