// The lab's pictures that `clothlab sweep --merge` draws, against the table beside them.
import assert from "node:assert/strict";
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { runProgram } from "../protocol/harness.mjs";

const folder = mkdtempSync(join(tmpdir(), "clothlab-sweep-pictures-"));
after(() => rmSync(folder, { recursive: true }));

/// A small hanging cloth.
const scene = {
  version: 1,
  name: "small",
  cloths: [
    {
      mesh: { grid: { columns: 5, rows: 5, width: 1, height: 1 } },
      pins: [{ at: "edge:row:0" }],
      material: { model: "springs", structural: 100, shear: 0, bend: 0, damping: 0 },
    },
  ],
  solver: { method: "verlet", dt: 0.001 },
  air_drag: 0,
  self_collision: null,
};
const methods = { at: "/solver/method", values: ["verlet", "rk4"] };
const steps = { at: "/solver/dt", from: 0.001, to: 0.04, count: 3, spacing: "log" };
const rows = { at: "/cloths/0/mesh/grid/rows", values: [5, 7] };

/// Measures the sweep, or its shard, and merges it. Returns what the merge says, the pictures by name, and the rows.
async function merged(name, axes, { measure = [], shard = "1/1" } = {}) {
  const [file, out] = [join(folder, `${name}.json`), join(folder, name)];
  writeFileSync(file, JSON.stringify({ scene, time: 0.4, measure, axes }));
  const made = await runProgram(["sweep", file, "--out", out, "--shard", shard]);
  assert.equal(made.code, 0, made.stderr);
  const said = await runProgram(["sweep", "--merge", out]);
  assert.equal(said.code, 0, said.stderr);
  const names = readdirSync(out).filter((entry) => entry.endsWith(".svg"));
  const pictures = new Map(names.map((entry) => [entry, readFileSync(join(out, entry), "utf8")]));
  const table = JSON.parse(readFileSync(join(out, "table.json"), "utf8"));
  const asObject = (row) => Object.fromEntries(table.columns.map((column, c) => [column, row[c]]));
  return { ...said, pictures, points: table.rows.map(asObject) };
}
const count = (text, pattern) => [...text.matchAll(pattern)].length;

test("a chart for each value of what is not the solver's, with the points that have an error and a cost", async () => {
  const { stdout, pictures, points } = await merged("chart", [rows, methods, steps], { measure: ["error", "cost"] });
  assert.deepEqual([...pictures.keys()].sort(), ["chart-rows-5.svg", "chart-rows-7.svg", "map.svg"]);
  assert.match(stdout, /sweep.html, chart-rows-5.svg, chart-rows-7.svg, map.svg/);
  for (const value of rows.values) {
    const svg = pictures.get(`chart-rows-${value}.svg`);
    assert.match(svg, new RegExp(`Speed against accuracy: chart \\(small\\), rows ${value}<`));
    assert.match(svg, /position error at 0.4 s: .* \(1 m\)/);
    const own = points.filter((point) => point.rows === value);
    const drawn = own.filter((point) => point.error_position_over_size !== null && point.cost_timed_runs > 0);
    assert.equal(count(svg, /class="mark(?: beside)?" data-index/g), drawn.length);
    assert.equal(count(svg, /class="mark blown"/g), own.filter((point) => point.blew_up_at_s !== null).length);
    assert.ok(own.some((point) => point.blew_up_at_s !== null));
  }
});

test("a map for another axis of numbers: its blown cells are the points that blew up", async () => {
  const stiffness = { name: "stiffness", at: "/cloths/0/material/structural", values: [100, 10000] };
  const { pictures, points } = await merged("map", [methods, stiffness, steps]);
  assert.deepEqual([...pictures.keys()], ["map.svg"]);
  const svg = pictures.get("map.svg");
  assert.match(svg, /dt against stiffness/);
  assert.match(svg, /&quot;stiffness&quot; is \/cloths\/0\/material\/structural/);
  const blown = points.filter((point) => point.blew_up_at_s !== null);
  assert.ok(blown.length > 0 && blown.length < points.length);
  assert.equal(count(svg, /class="cell blown"/g), blown.length);
  assert.equal(count(svg, /class="cell"/g), points.length - blown.length);
  for (const { method, stiffness: value, dt } of blown)
    assert.match(svg, new RegExp(`${method}, ${value}, dt ${Number((1000 * dt).toPrecision(3))} ms: blew up`));
  // Verlet's limit is at 2 / omega, so ten times the frequency has a tenth of the limit.
  const limits = Object.fromEntries(
    points.filter((point) => point.method === "verlet" && point.dt > 0.03).map((p) => [p.stiffness, p.dt_limit_s]),
  );
  assert.ok(Math.abs(limits[100] / limits[10000] - 10) < 0.1, JSON.stringify(limits));
});

test("several axes of numbers have maps of their own; names from labels are plain", async () => {
  const kinds = {
    name: "kind",
    patches: [
      { name: "thin & light", patch: { gravity: [0, -2, 0] } },
      { name: "../up", patch: { gravity: [0, -1, 0] } },
    ],
  };
  const columns = { at: "/cloths/0/mesh/grid/columns", values: [5, 6] };
  const { stdout, pictures } = await merged("several", [kinds, columns, rows, { ...steps, count: 2 }]);
  assert.match(stdout, /sweep.html and 8 pictures/);
  const names = ["thin-light", "..-up"].flatMap((kind) => [
    ...columns.values.map((value) => `map-over-rows-kind-${kind}-columns-${value}.svg`),
    ...rows.values.map((value) => `map-over-columns-kind-${kind}-rows-${value}.svg`),
  ]);
  assert.deepEqual([...pictures.keys()].sort(), names.sort());
});

test("points that are missing or make no scene are told; without an axis of the solver nothing is drawn", async () => {
  const wrong = { ...rows, values: [5, 0] };
  const { pictures } = await merged("absent", [methods, wrong, steps], { shard: "1/2" });
  const svg = pictures.get("map.svg");
  assert.match(svg, /6 points are not measured yet\./);
  assert.match(svg, /2 points are not here: the values make no valid scene\./);
  assert.match(svg, /; not complete/);
  const half = await merged("half", [rows, { ...steps, count: 4 }], { measure: ["error", "cost"], shard: "2/2" });
  for (const value of rows.values)
    assert.match(half.pictures.get(`chart-rows-${value}.svg`), /2 points are not measured yet\./);
  assert.equal((await merged("none", [rows], { measure: ["error", "cost"] })).pictures.size, 0);
});

test("no more pictures than a reader looks at, and it is said", async () => {
  const gravities = Array.from({ length: 66 }, (_, i) => [0, -i, 0]);
  const axes = [{ at: "/gravity", values: gravities }, rows, { ...steps, count: 2 }];
  const { stderr, pictures } = await merged("many", axes);
  assert.equal(pictures.size, 64);
  assert.match(stderr, /2 pictures more would be needed .* at most 64 are drawn/);
});
