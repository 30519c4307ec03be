// `clothlab chart`, `stability`, `choose`, `simplify`: their output and files, the cache, and Ctrl-C.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { userShaders } from "../caches.mjs";
import { thoroughTest } from "../thorough.mjs";
import { cache, lab } from "./lab_program.mjs";
import { clothlab, folder, program } from "./program.mjs";

const read = (...path) => readFileSync(join(folder, ...path), "utf8");
const chart = [
  "chart",
  "small.json",
  "--methods",
  "verlet,xpbd",
  "--iterations",
  "1,4",
  "--time",
  "0.05",
  "--budget",
  "100", // what is measured must not depend on who else has the processor
];

test("a chart is printed and written as JSON, CSV and SVG of the same points", () => {
  const { stdout } = lab(...chart, "--out", "results");
  assert.match(stdout, /^small, 0\.05 s simulated on /);
  assert.match(stdout, /^ +1e-2 +1e-3 +1e-4$/m);
  assert.match(stdout, /^verlet +[\d.]+ \(dt [\d.]+ ms\)/m);
  assert.match(stdout, /^written: results\/chart\.json, \.csv, \.svg$/m);
  const result = JSON.parse(read("results", "chart.json"));
  assert.equal(result.kind, "chart");
  assert.equal(result.complete, true);
  assert.ok(result.points.length >= 4);
  assert.deepEqual([...new Set(result.points.map((point) => point.method))].sort(), ["verlet", "xpbd"]);
  for (const point of result.points) assert.ok([null, 1, 4].includes(point.iterations));
  const rows = read("results", "chart.csv").trim().split("\n");
  assert.equal(rows.length, 1 + result.points.length);
  assert.match(rows[0], /^method,dt_s,iterations,.*median_ms_per_simulated_s/);
  const picture = read("results", "chart.svg");
  assert.match(picture, /^<svg xmlns="http:\/\/www\.w3\.org\/2000\/svg" /);
  const marks = new Set([...picture.matchAll(/data-index="(\d+)"/g)].map(([, index]) => Number(index)));
  assert.ok(marks.size > 0 && [...marks].every((index) => index < result.points.length));
});

test("the same question is answered from the cache, --fresh and another scene are not", () => {
  const quick = ["chart", "small.json", "--methods", "verlet", "--time", "0.05", "--budget", "100"];
  const first = lab(...quick, "--json");
  const again = lab(...quick, "--json");
  assert.match(again.stderr, /note: measured before/);
  assert.equal(again.stdout, first.stdout);
  const looks = lab(...quick, "--json", "--set", "/cloths/0/color=#00ff00", "--set", "/name=green");
  assert.match(looks.stderr, /measured before/);
  assert.equal(JSON.parse(looks.stdout).scene, "green");
  const entries = () => readdirSync(join(cache, "clothlab", "lab")).length;
  const before = entries();
  const other = lab(...quick, "--json", "--set", "/gravity/1=-5");
  assert.doesNotMatch(other.stderr, /measured before/);
  assert.equal(entries(), before + 1);
  assert.doesNotMatch(lab(...quick, "--fresh").stderr, /measured before/);
});

thoroughTest("a cache that cannot be written changes nothing", () => {
  writeFileSync(join(folder, "in-the-way"), "");
  const { status, stderr } = clothlab([...chart.slice(0, -1), "2"], {
    ...userShaders,
    XDG_CACHE_HOME: join(folder, "in-the-way"),
  });
  assert.equal(status, 0);
  assert.doesNotMatch(stderr, /clothlab:/);
});

test("the choice prints its settings as options that `run` takes, and as a patch", () => {
  const { stdout } = lab(
    "choose",
    "small.json",
    "--tolerance",
    "0.01",
    "--methods",
    "verlet,symplectic_euler",
    "--time",
    "0.2",
  );
  const measured = String.raw`[\d.e-]+ \[[\d.e-]+\.\.[\d.e-]+\]`; // a number and its interval
  const setting = String.raw`(verlet|symplectic_euler), dt [\d.]+ ms`;
  const chosen = `^chosen +${setting} +error ${measured} +${measured} ms per simulated second$`;
  assert.match(stdout, new RegExp(chosen, "m"));
  assert.match(stdout, /^now +symplectic_euler, dt 2 ms/m);
  const options = stdout.match(/^options: (.*)$/m)[1].split(" ");
  assert.equal(clothlab(["run", "small.json", "--time", "0.1", ...options]).status, 0);
  const patch = JSON.parse(stdout.match(/^patch: +(.*)$/m)[1]);
  assert.ok(
    options.includes(`/solver/method=${patch.solver.method}`) && options.includes(`/solver/dt=${patch.solver.dt}`),
  );
});

test("the stability map has a table a method with the measured step next to theory's", () => {
  const { stdout } = lab(
    "stability",
    "small.json",
    "--methods",
    "verlet",
    "--columns",
    "2",
    "--from",
    "0.5",
    "--to",
    "2",
    "--out",
    "results",
  );
  assert.match(stdout, /^value +held \[ms\] +failed \[ms\] +theory \[ms\]/m);
  const result = JSON.parse(read("results", "stability.json"));
  assert.equal(result.methods[0].columns.length, 2);
  // Beyond theory's limit a cloth may tremble without blowing up (here up to 1.2 of it): the map says so.
  for (const { held_s, failed_s, theory_s } of result.methods[0].columns)
    assert.ok(held_s < failed_s && failed_s > 0.95 * theory_s && held_s < 1.5 * theory_s);
  for (const extension of ["csv", "svg"]) assert.ok(existsSync(join(folder, "results", `stability.${extension}`)));
});

test("each part gets a row with its worth, and missing parts are listed with the reason", () => {
  const { stdout } = lab("simplify", "small.json", "--time", "0.2", "--tolerance", "0.05");
  assert.match(stdout, /^ +cost +change +error +longest dt \[ms\]/m);
  assert.match(stdout, /bend/);
  assert.match(stdout, /self-collision.* - .*\w/);
});

test("Ctrl-C ends a chart within a second, keeps what there was, and says that it is not complete", async () => {
  mkdirSync(join(folder, "cut"));
  const child = spawn(program, ["chart", "seed", "--budget", "600", "--methods", "verlet,pbd", "--out", "cut"], {
    cwd: folder,
    env: { ...process.env, ...userShaders, XDG_CACHE_HOME: join(folder, "other-cache") },
  });
  let stderr = "";
  child.stderr.on("data", (text) => (stderr += text));
  await new Promise((done) => setTimeout(done, 2500));
  child.kill("SIGINT"); // ends it long before its 600 s, or this test runs out of time
  const code = await new Promise((done) => child.on("exit", done));
  assert.equal(code, 130, stderr);
  assert.match(stderr, /note: interrupted/);
  if (existsSync(join(folder, "cut", "chart.json")))
    assert.equal(JSON.parse(read("cut", "chart.json")).complete, false);
  assert.ok(
    !existsSync(join(folder, "other-cache", "clothlab", "lab")) ||
      readdirSync(join(folder, "other-cache", "clothlab", "lab")).length === 0,
  );
});
