// `clothlab run`: report, trace, meshes, the same result every time, and a run that diverges.
import assert from "node:assert/strict";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { clothlab, folder } from "./program.mjs";

const file = (name) => readFileSync(join(folder, name));
const report = (name) => JSON.parse(file(name));

function run(...args) {
  const result = clothlab(["run", ...args]);
  assert.equal(result.status, 0, result.stderr);
  return result;
}

test("the report holds what the contract promises", () => {
  run("seed", "--time", "0.05", "--report", "report.json");
  const r = report("report.json");
  assert.equal(r.vertices, 625);
  assert.ok(r.memory_bytes > 625 * 2 * 2 * 16, "two copies of positions and velocities, 16 bytes each");
  assert.equal(r.steps, 50);
  assert.ok(Math.abs(r.sim_time - 0.05) < 1e-9);
  assert.ok(r.renderer.length > 0 && r.passes.length > 0);
  assert.ok(r.step_s > 0 && r.wall_s > r.step_s);
  assert.ok(Math.abs(r.ns_per_vertex_step - (1e9 * r.step_s) / (625 * 50)) < 1e-6 * r.ns_per_vertex_step);
  for (const key of ["kinetic", "elastic", "gravitational"]) assert.ok(Number.isFinite(r.energy[key]), key);
  assert.ok(r.max_strain > 0 && r.max_strain < 1);
  assert.equal(r.diverged, false);
  assert.match(r.state_hash, /^[0-9a-f]{16}$/);
});

test("the report counts what implicit Euler's solver and the strain limit did", () => {
  run(
    "seed",
    "--time",
    "0.1",
    "--report",
    "report.json",
    "--set",
    "/solver/method=implicit_euler",
    "--set",
    "/solver/dt=0.01",
    "--set",
    "/solver/iterations=1",
    "--set",
    "/cloths/0/material/strain_limit=0.05",
  );
  const r = report("report.json");
  assert.ok(r.solver.newton_steps >= 10 && r.solver.linear_iterations > 10 && r.solver.unconverged === 0);
  assert.ok(r.strain_limit.sweeps >= 10);
  assert.ok(r.passes.includes("implicit_euler") && r.passes.includes("strain_limit"));
  run("seed", "--time", "0.01", "--report", "report.json");
  assert.ok(!("solver" in report("report.json")) && !("strain_limit" in report("report.json")));
});

test("a method with a fixed number of sweeps reports nothing of its solver and has no limit to warn of", () => {
  for (const method of ["pbd", "xpbd", "vbd"]) {
    const { stderr } = run(
      "seed",
      "--time",
      "0.033",
      "--report",
      "report.json",
      "--set",
      `/solver/method=${method}`,
      "--set",
      "/solver/dt=0.0165",
      "--set",
      "/solver/iterations=2",
      "--set",
      "/self_collision=null",
    );
    // What two sweeps leave is told; nothing else is.
    assert.match(
      stderr,
      /^(clothlab: (warning: 2 sweeps of|note: \d+ of \d+ steps that were measured ended far from solved)[^\n]*\n)*$/,
    );
    const r = report("report.json");
    assert.ok(r.passes.includes(method) && !("solver" in r), JSON.stringify(r));
  }
});

test("two processes reach the same state to the bit, whatever else they write", () => {
  run("seed", "--time", "0.3", "--report", "plain.json");
  run("seed", "--time", "0.3", "--report", "watched.json", "--trace", "w.csv", "--out", "w.obj", "--every", "0.017");
  assert.equal(report("plain.json").state_hash, report("watched.json").state_hash);
});

test("--set changes the run, the later of two wins", () => {
  run("seed", "--time", "0.05", "--set", "/solver/dt=0.001", "--set", "/solver/dt=0.0005", "--report", "set.json");
  assert.equal(report("set.json").steps, 100);
  assert.equal(report("set.json").dt, 0.0005);
});

test("a time that is not whole in steps is rounded, and that is said", () => {
  const { stderr } = run("seed", "--time", "0.0204", "--report", "rounded.json");
  assert.equal(report("rounded.json").steps, 20);
  assert.match(stderr, /note: --time 0\.0204 .*0\.02\b/);
});

test("the trace has a row per --every, the start and the end among them", () => {
  run("seed", "--time", "0.05", "--trace", "trace.csv", "--every", "0.02");
  const [header, ...rows] = file("trace.csv").toString().trim().split("\n");
  assert.equal(header, "time,kinetic,elastic,gravitational,max_strain,max_speed,contacts,residual,error_m");
  // symplectic_euler has nothing to solve: its last two columns are empty
  assert.ok(rows.every((row) => row.endsWith(",,")));
  const values = rows.map((row) => row.slice(0, -2).split(",").map(Number));
  assert.deepEqual(
    values.map(([time]) => Math.round(time * 1000)),
    [0, 20, 40, 50],
  );
  assert.ok(values.flat().every(Number.isFinite));
  assert.equal(values[0][1], 0, "it starts at rest");
});

test("under a method that iterates report and trace tell how far steps are from solved, under others nothing", () => {
  const few = ["--set", "/solver/method=xpbd", "--set", "/solver/dt=0.016", "--set", "/solver/iterations=3"];
  const { stderr } = run(
    "seed",
    "--time",
    "0.48",
    ...few,
    "--report",
    "few.json",
    "--trace",
    "few.csv",
    "--every",
    "0.16",
  );
  const { convergence } = report("few.json");
  assert.ok(convergence.error_m > convergence.tolerance_m && convergence.largest_error_m >= convergence.error_m);
  assert.ok(convergence.residual > 0.1 && convergence.measured >= 2 && convergence.unsolved >= 1);
  assert.match(stderr, /far from solved.*more iterations, a smaller dt, or the method implicit_euler/);
  const rows = file("few.csv")
    .toString()
    .trim()
    .split("\n")
    .slice(1)
    .map((row) => row.split(",").slice(-2));
  assert.deepEqual(rows[0], ["", ""], "nothing is measured at the start");
  assert.equal(Number(rows.at(-1)[1]), Number(convergence.error_m.toPrecision(9)), "the last step is");
  run("seed", "--time", "0.01", "--report", "explicit.json");
  assert.equal(report("explicit.json").convergence, null);
});

test("an OBJ has every vertex and two triangles a cell, with indices in range", () => {
  run("seed", "--time", "0", "--out", "start.obj");
  const lines = file("start.obj").toString().trim().split("\n");
  const of = (kind) => lines.filter((line) => line.startsWith(`${kind} `)).map((line) => line.split(" ").slice(1));
  const vertices = of("v").map((v) => v.map(Number));
  assert.equal(vertices.length, 625);
  assert.equal(of("vt").length, 625);
  assert.deepEqual(vertices[0], [-0.5, 1, 0]);
  assert.deepEqual(vertices[624], [0.5, 1, 1]);
  const faces = of("f").map((f) => f.map((corner) => Number(corner.split("/")[0])));
  assert.equal(faces.length, 2 * 24 * 24);
  assert.ok(faces.flat().every((corner) => corner >= 1 && corner <= 625));
  assert.deepEqual(faces[0], [1, 26, 27]);
});

test("a PLY holds the same positions as the OBJ", () => {
  run("seed", "--time", "0.1", "--out", "same.obj");
  run("seed", "--time", "0.1", "--out", "same.ply");
  const bytes = file("same.ply");
  const start = bytes.indexOf("end_header\n") + "end_header\n".length;
  const header = bytes.subarray(0, start).toString();
  assert.match(header, /^ply\nformat binary_little_endian 1\.0\n/);
  assert.match(header, /element vertex 625\n/);
  assert.equal(bytes.length, start + 625 * 20 + 2 * 24 * 24 * 13);
  const obj = file("same.obj")
    .toString()
    .split("\n")
    .filter((line) => line.startsWith("v "));
  obj.forEach((line, vertex) => {
    const position = [0, 4, 8].map((at) => bytes.readFloatLE(start + 20 * vertex + at));
    assert.deepEqual(
      line
        .split(" ")
        .slice(1)
        .map((text) => Math.fround(Number(text))),
      position,
    );
  });
});

test("samples go to numbered files", () => {
  run("seed", "--time", "0.03", "--out", "step.obj", "--every", "0.01");
  const written = readdirSync(folder)
    .filter((name) => /^step-.*\.obj$/.test(name))
    .sort();
  assert.deepEqual(written, ["step-0000.obj", "step-0001.obj", "step-0002.obj", "step-0003.obj"]);
});

test("a point cache counts its samples and holds them all", () => {
  run("seed", "--time", "0.03", "--out", "cache.pc2", "--every", "0.01");
  const bytes = file("cache.pc2");
  assert.equal(bytes.subarray(0, 12).toString("latin1"), "POINTCACHE2\0");
  assert.deepEqual([bytes.readInt32LE(12), bytes.readInt32LE(16), bytes.readInt32LE(28)], [1, 625, 4]);
  assert.equal(bytes.length, 32 + 4 * 625 * 12);
  assert.deepEqual(
    [0, 4, 8].map((at) => bytes.readFloatLE(32 + at)),
    [-0.5, 1, 0],
  );
});

test("a run that diverges exits 4, keeps what was good, and marks it", () => {
  const { status, stderr } = clothlab([
    "run",
    "blowup",
    "--time",
    "1",
    "--report",
    "blowup.json",
    "--out",
    "blowup.obj",
    "--trace",
    "blowup.csv",
  ]);
  assert.equal(status, 4);
  assert.match(
    stderr,
    /note: the simulation diverged: .* J at t = .*1\.[45]\d* times.*--set \/solver\/dt=0\.001[23]\n/,
  );
  const r = report("blowup.json");
  assert.equal(r.diverged, true);
  assert.ok(r.diverged_by > r.sim_time);
  assert.match(r.diverged_reason, /0\.0025 s/);
  // The last good state: 62.5 kg that fall gain about 600 J.
  assert.ok(r.energy.kinetic + r.energy.elastic < 600, JSON.stringify(r.energy));
  const obj = file("blowup.obj").toString();
  assert.match(obj, /^#.*diverged/);
  assert.doesNotMatch(obj, /nan|inf/i);
  assert.match(file("blowup.csv").toString(), /\n# diverged by [\d.]+ s\n$/);
});

test("what is said of a run does not depend on who looks at it", () => {
  // Its energy grows for some steps only: judged where one happens to look, it could pass for one that holds.
  const said = (...args) => {
    const { status } = clothlab(["run", "blowup", "--time", "0.6", "--report", "looked.json", ...args]);
    const { diverged, diverged_by, diverged_reason, state_hash } = report("looked.json");
    return { status, diverged, diverged_by, diverged_reason, state_hash };
  };
  const unwatched = said();
  assert.equal(unwatched.diverged, true);
  assert.deepEqual(said("--every", "0.013", "--trace", "looked.csv"), unwatched);
  assert.deepEqual(said("--verify", "--every", "0.05"), unwatched);
});

test("--verify counts crossings at every sample: of sheets that pass through each other, and of one that does not", () => {
  const sheet = (y, turn) => ({
    mesh: { grid: { columns: 5, rows: 5, width: 1, height: 1 } },
    transform: { translate: [0.013, y, -0.5], rotate: [0, turn, 0] },
    pins: [{ at: "edge:row:0", motion: { linear: { velocity: [0, y < 1 ? 0 : -1, 0] } } }],
  });
  const scene = { version: 1, gravity: [0, 0, 0], solver: { method: "vbd", dt: 0.01 } };
  const write = (cloths) => writeFileSync(join(folder, "layers.json"), JSON.stringify({ ...scene, cloths }));
  const verified = (...args) => {
    const { stdout } = run("layers.json", "--time", "0.5", "--report", "verified.json", "--verify", ...args);
    return { ...report("verified.json"), stdout };
  };
  write([sheet(0.9, 0), sheet(1.1, 7)]); // the upper row moves 0.5 m down, through the lower cloth at 0.2 s
  const through = verified("--every", "0.05");
  const check = through.crossing_check;
  assert.equal(check.samples, 11);
  assert.ok(through.crossings > 0 && check.samples_with_crossings > 0, JSON.stringify(check));
  assert.ok(check.first_at > 0.19 && check.first_at <= check.worst_at && check.worst_at <= 0.51);
  assert.match(
    check.first_pairs[0],
    /^edge \d+-\d+ of \/cloths\/[01] .* meets triangle \d+-\d+-\d+ of \/cloths\/[01] /,
  );
  assert.match(through.stdout, new RegExp(`crossings: at most ${through.crossings}, .* first at`));
  write([sheet(0.9, 0)]);
  const alone = verified();
  assert.equal(alone.crossings, 0);
  assert.deepEqual(alone.crossing_check, {
    samples: 51, // every 0.01 s if nothing else is said
    samples_with_crossings: 0,
    first_at: null,
    first_pairs: [],
    worst_at: null,
    at_end: 0,
  });
  assert.equal(report("verified.json").crossings, 0);
  run("layers.json", "--time", "0.05", "--report", "verified.json");
  assert.ok(!("crossings" in report("verified.json")));
});

test("--verify counts cloth that goes through a collider's mesh, at the mesh's place at that time", () => {
  const all = {
    box: [
      [-9, -9, -9],
      [9, 9, 9],
    ],
  };
  const sheet = { name: "sheet", mesh: { grid: { columns: 5, rows: 5 } }, pins: [{ at: all }] }; // nothing stops it
  const mesh = {
    vertices: [
      [0.1, -0.3, 0.4],
      [0.2, -0.3, 0.5],
      [0.1, -0.2, 0.5],
    ],
    triangles: [[0, 1, 2]],
  };
  const arrow = { name: "arrow", mesh, motion: { linear: { velocity: [0, 1, 0] } } };
  const scene = { version: 1, solver: { dt: 0.01 }, cloths: [sheet], colliders: [arrow] };
  writeFileSync(join(folder, "arrow.json"), JSON.stringify(scene));
  run("arrow.json", "--time", "0.4", "--every", "0.02", "--report", "arrow-report.json", "--verify");
  const { crossings, crossing_check: check, surface } = report("arrow-report.json");
  assert.ok(crossings > 0);
  assert.ok(surface.searches > 0 && surface.forced > 0, JSON.stringify(surface));
  // Its tip is at the sheet at 0.2 s, its base at 0.3 s.
  assert.ok(Math.abs(check.first_at - 0.21) < 0.011, JSON.stringify(check));
  assert.ok(check.samples_with_crossings >= 4 && check.samples_with_crossings <= 6, JSON.stringify(check));
  assert.equal(check.at_end, 0);
  assert.match(check.first_pairs.join(), /of \/cloths\/0 \("sheet"\)/);
  assert.match(check.first_pairs.join(), /of \/colliders\/0 \("arrow"\)/);
});

test("a scene of surfaces that starts with crossings is refused, with the pairs and a way out, and runs as points", () => {
  const asked = ["--set", '/self_collision={"kind":"surface"}'];
  const refused = clothlab(["run", "fabrics", "--time", "0.1", ...asked]);
  assert.equal(refused.status, 2);
  assert.match(
    refused.stderr,
    /\/self_collision\/kind: "surface", but the start has \d+ crossings: edge \d+-\d+ of \/cloths\/0/,
  );
  assert.match(refused.stderr, /"points"/);
  run("fabrics", "--time", "0.01", "--set", '/self_collision={"kind":"points"}');
});

test("a run that fails leaves no report and no trace of an older one", () => {
  const outputs = ["--report", "same.json", "--trace", "same.csv"];
  for (const [failing, status] of [
    [["nosuch", "--time", "0.01"], 2],
    [["seed", "--time", "0.01", "--set", "/solver/dt=-1"], 2],
    [["seed", "--time", "-1"], 2],
    [["seed", "--time", "0.01", "--gpu", "999"], 2],
  ]) {
    run("seed", "--time", "0.01", ...outputs);
    assert.equal(report("same.json").steps, 10);
    assert.equal(clothlab(["run", ...failing, ...outputs]).status, status);
    for (const name of ["same.json", "same.csv"])
      assert.ok(!readdirSync(folder).includes(name), `${name} after ${failing.join(" ")}`);
  }
});
