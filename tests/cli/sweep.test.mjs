import assert from "node:assert/strict";
import { mkdtempSync, readdirSync, readFileSync, rmSync, statSync, truncateSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { runProgram } from "../protocol/harness.mjs";

const folder = mkdtempSync(join(tmpdir(), "clothlab-sweep-"));
after(() => rmSync(folder, { recursive: true }));

const run = (...args) => runProgram(args);

/// A small hanging cloth.
const scene = {
  version: 1,
  name: "small",
  cloths: [{ mesh: { grid: { columns: 5, rows: 5, width: 1, height: 1 } }, pins: [{ at: "edge:row:0" }] }],
  self_collision: null,
};
const plan = {
  scene,
  time: 0.1,
  measure: [],
  axes: [
    { at: "/solver/method", values: ["verlet", "rk4"] },
    { at: "/solver/dt", from: 0.0005, to: 0.002, count: 3, spacing: "log" },
  ],
};

function file(name, content) {
  const path = join(folder, name);
  writeFileSync(path, JSON.stringify(content));
  return path;
}

/// The results' files, sorted.
const points = (out) =>
  readdirSync(join(out, "points"))
    .flatMap((part) => readdirSync(join(out, "points", part)).map((name) => join(part, name)))
    .filter((name) => name.endsWith(".json"))
    .sort();

test("shards measure each point once, and a table has them all", async () => {
  const path = file("small.json", plan);
  const out = join(folder, "shards");
  for (const shard of ["1/2", "2/2"]) {
    const { code, stdout } = await run("sweep", path, "--out", out, "--shard", shard);
    assert.equal(code, 0);
    assert.match(stdout, /3 points measured/);
  }
  assert.equal(points(out).length, 6);
  const { code, stdout } = await run("sweep", "--merge", out);
  assert.equal(code, 0);
  assert.match(stdout, /6 of 6 points/);
  const rows = readFileSync(join(out, "table.csv"), "utf8").trim().split("\n");
  assert.match(rows[0], /^method,dt,/);
  assert.deepEqual(
    rows.slice(1).map((row) => row.split(",").slice(0, 2).join(" ")),
    ["verlet 0.0005", "verlet 0.001", "verlet 0.002", "rk4 0.0005", "rk4 0.001", "rk4 0.002"],
  );
  const whole = join(folder, "whole");
  await run("sweep", path, "--out", whole);
  assert.deepEqual(points(whole), points(out));
});

test("what is there is skipped; a file cut in half or missing is measured again", async () => {
  const path = file("again.json", plan);
  const out = join(folder, "again");
  await run("sweep", path, "--out", out);
  const names = points(out);
  const times = names.map((name) => statSync(join(out, "points", name)).mtimeMs);
  truncateSync(join(out, "points", names[2]), 40);
  rmSync(join(out, "points", names[4]));
  const merged = await run("sweep", "--merge", out);
  assert.match(merged.stderr, /2 points are not measured, or their files are damaged/);
  const { stdout } = await run("sweep", path, "--out", out);
  assert.match(stdout, /2 points measured, 4 there before/);
  const again = names.map((name) => statSync(join(out, "points", name)).mtimeMs);
  assert.deepEqual(
    names.filter((_, i) => again[i] !== times[i]),
    [names[2], names[4]],
  );
});

test("the folder keeps a scene that is in a file, and a table is made without the file", async () => {
  const path = file("scene.json", scene);
  const out = join(folder, "kept");
  const sweep = file("of-file.json", { ...plan, scene: "scene.json" });
  for (const shard of ["1/2", "2/2"]) assert.equal((await run("sweep", sweep, "--out", out, "--shard", shard)).code, 0);
  rmSync(path);
  const { code, stdout } = await run("sweep", "--merge", out);
  assert.equal(code, 0);
  assert.match(stdout, /6 of 6 points/);
});

test("errors, crossings and shapes are measured; a cost is there, or why it is not, never both", async () => {
  const measure = ["error", "cost", "crossings", "shape"];
  const path = file("all.json", { ...plan, measure, axes: [{ at: "/solver/dt", values: [0.001, 0.0005] }] });
  const out = join(folder, "all");
  assert.equal((await run("sweep", path, "--out", out)).code, 0);
  const results = points(out).map((name) => JSON.parse(readFileSync(join(out, "points", name), "utf8")));
  for (const result of results) {
    assert.equal(result.crossings, 0);
    assert.equal(result.cost.median_ms_per_simulated_s === null, "why_no_cost" in result);
    assert.ok(statSync(join(out, "points", result.id.slice(0, 2), `${result.id}.ply`)).size > 300); // 25 vertices
  }
  const [long, short] = [0.001, 0.0005].map((dt) => results.find(({ dt_s }) => dt_s === dt).error);
  // Symplectic Euler is of first order.
  const ratio = long.position_over_size / short.position_over_size;
  assert.ok(ratio > 1.8 && ratio < 2.2, `${ratio}`);
});

test("values that make no scene are kept with the reason, and a blow-up with its time", async () => {
  const path = file("bad.json", {
    ...plan,
    axes: [{ at: "/solver/dt", values: [0.001, -1, 0.1] }],
  });
  const out = join(folder, "bad");
  const { code, stdout, stderr } = await run("sweep", path, "--out", out);
  assert.equal(code, 0);
  assert.match(stdout, /1 of them no valid scene/);
  assert.match(stderr, /the first that is no valid scene: \/solver\/dt: -1; a number from/);
  await run("sweep", "--merge", out);
  const table = JSON.parse(readFileSync(join(out, "table.json"), "utf8"));
  const column = (name) => table.rows.map((row) => row[table.columns.indexOf(name)]);
  assert.match(column("refused")[1], /\/solver\/dt: -1; a number from/);
  assert.equal(column("refused")[0], null);
  assert.equal(column("blew_up_at_s")[0], null);
  assert.ok(column("blew_up_at_s")[2] > 0);
});

for (const [what, content, words] of [
  ["an unknown key", { ...plan, axis: [] }, /\/axis: unknown key "axis"; one of .*did you mean "axes"/],
  ["a place that no scene has", { ...plan, axes: [{ at: "/solvr/dt", values: [1] }] }, /\/axes\/0\/at: "\/solvr\/dt"/],
  [
    "a misspelt key",
    { ...plan, axes: [{ at: "/solver/dtt", values: [0.001, 0.002] }] },
    /\/axes\/0\/at: no point makes a valid scene: \/solver\/dtt: unknown key "dtt".*did you mean "dt"/,
  ],
  ["two axes of one name", { ...plan, axes: [plan.axes[1], plan.axes[1]] }, /\/axes\/1\/name: "dt"; another name/],
  ["no axes", { scene }, /\/axes: nothing; an array/],
  [
    "a count of one",
    { ...plan, axes: [{ at: "/solver/dt", from: 1, to: 2, count: 1 }] },
    /\/axes\/0\/count: 1; a whole/,
  ],
  [
    "too many points",
    { ...plan, axes: ["a", "b"].map((name) => ({ name, at: "/solver/dt", from: 1, to: 2, count: 9999 })) },
    /points; at most 10000000/,
  ],
])
  test(`${what} is refused`, async () => {
    const { code, stderr } = await run("sweep", file("wrong.json", content), "--out", join(folder, "none"));
    assert.equal(code, 2);
    assert.match(stderr, words);
  });

test("a folder with another sweep, a wrong shard and a folder without a sweep are refused", async () => {
  const path = file("one.json", plan);
  const out = join(folder, "one");
  await run("sweep", path, "--out", out, "--shard", "6/6");
  const other = await run("sweep", file("other.json", { ...plan, time: 0.2 }), "--out", out);
  assert.equal(other.code, 2);
  assert.match(other.stderr, /another sweep is in it/);
  for (const shard of ["0/3", "4/3", "a", "1/"]) {
    const { code, stderr } = await run("sweep", path, "--out", out, "--shard", shard);
    assert.equal(code, 2);
    assert.match(stderr, /--shard: ".*"; i\/n with 1 <= i <= n/);
  }
  const merged = await run("sweep", "--merge", folder);
  assert.equal(merged.code, 2);
  assert.match(merged.stderr, /has no sweep.json/);
});

test("a point's file that is no result of it is measured again, whatever is in it", async () => {
  const path = file("odd.json", { ...plan, axes: [{ at: "/solver/dt", values: [0.001, 0.002] }] });
  const out = join(folder, "odd");
  await run("sweep", path, "--out", out);
  const names = points(out);
  for (const odd of ['{"id": 5}', "[1]", '"x"', "{}"]) {
    writeFileSync(join(out, "points", names[0]), odd);
    const merged = await run("sweep", "--merge", out);
    assert.match(merged.stderr, /1 points? (is|are) not measured, or (its file is|their files are) damaged/, odd);
    assert.match((await run("sweep", path, "--out", out)).stdout, /1 points? measured, 1 there before/);
  }
});

test("a place that no scene can have is told as any other that this one has not", async () => {
  for (const at of [
    "/cloths/99999999999999999999/mass",
    "/cloths/18446744073709551616",
    "/cloths/-/mass",
    "/cloths/01",
  ]) {
    const { code, stderr } = await run(
      "sweep",
      file("far.json", { ...plan, axes: [{ at, values: [1, 2] }] }),
      "--out",
      folder,
    );
    assert.equal(code, 2, at);
    assert.match(stderr, /\/axes\/0\/at: ".*"; a place that the scene has/);
  }
});
