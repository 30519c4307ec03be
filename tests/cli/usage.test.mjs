// Help, exit codes, and messages about wrong input.
import assert from "node:assert/strict";
import { existsSync, mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { clothlab, folder } from "./program.mjs";

const commands = [
  "run",
  "render",
  "record",
  "chart",
  "stability",
  "choose",
  "simplify",
  "validate",
  "presets",
  "fabrics",
  "info",
  "selftest",
  "manual",
  "serve",
];

test("without a subcommand the help goes to stderr and the exit code is 2", () => {
  const { status, stdout, stderr } = clothlab([]);
  assert.equal(status, 2);
  assert.equal(stdout, "");
  for (const command of commands) assert.match(stderr, new RegExp(`^  ${command} `, "m"));
  assert.match(stderr, /Examples:/);
});

test("--help and --version exit 0 and print on stdout", () => {
  for (const args of [["--help"], ...commands.map((command) => [command, "--help"])]) {
    const { status, stdout, stderr } = clothlab(args);
    assert.equal(status, 0, args.join(" "));
    assert.match(stdout, /Usage: /);
    assert.equal(stderr, "");
  }
  assert.match(clothlab(["--version"]).stdout, /^clothlab \d+\.\d+\.\d+\n$/);
});

const wrong = {
  "an unknown command": [["fly"], /fly/],
  "an unknown option": [["run", "seed", "--time", "1", "--tmie", "2"], /--tmie/],
  "no --time": [["run", "seed"], /--time/],
  "no scene": [["run", "--time", "1"], /scene/],
  "a time that is no number": [["run", "seed", "--time", "soon"], /--time/],
  "a negative time": [["run", "flag", "--time", "-1"], /0 or more/],
  "a time that is not finite": [["run", "flag", "--time", "inf"], /0 or more/],
  "a preset that is not there": [["run", "sead", "--time", "1"], /seed/],
  "a value out of range": [["run", "seed", "--time", "1", "--set", "/solver/dt=-1"], /\/solver\/dt/],
  "a key that is not there": [["run", "seed", "--time", "1", "--set", "/solver/dd=1"], /\/solver\/dd/],
  "an assignment without a value": [["run", "seed", "--time", "1", "--set", "/solver/dt"], /--set|\/solver\/dt/],
  "an unknown kind of mesh file": [["run", "seed", "--time", "1", "--out", "a.stl"], /\.obj, \.ply, \.glb, \.pc2/],
  "a point cache of one state": [["run", "seed", "--time", "1", "--out", "a.pc2"], /--every/],
  "--every for nothing": [["run", "seed", "--time", "1", "--every", "0.1"], /--out, --trace or --verify/],
  "--every below a step": [["run", "flag", "--time", "1", "--every", "1e-5", "--trace", "t.csv"], /one step/],
  "a size without a height": [["render", "seed", "--time", "0", "--out", "a.png", "--size", "100"], /WIDTHxHEIGHT/],
  "a size with more after it": [
    ["render", "seed", "--time", "0", "--out", "a.png", "--size", "10x10x10"],
    /WIDTHxHEIGHT/,
  ],
  "a size of nothing": [["render", "seed", "--time", "0", "--out", "a.png", "--size", "0x100"], /from 1 to/],
  "a size beyond the largest": [["render", "seed", "--time", "0", "--out", "a.png", "--size", "9999x10"], /from 1 to/],
  "a picture that is no PNG": [["render", "seed", "--time", "0", "--out", "a.jpg"], /\.png/],
  "a method that is not there": [["chart", "seed", "--methods", "verlet,leapfrog"], /leapfrog.*symplectic_euler/],
  "iterations that are no number": [["chart", "seed", "--iterations", "1,,4"], /whole numbers from 1/],
  "a chart of a negative time": [["chart", "seed", "--time", "-1"], /--time: -1; above 0/],
  "a chart of a time that is not finite": [["chart", "seed", "--time", "nan"], /--time: nan; above 0/],
  "a chart without a budget": [["chart", "seed", "--budget", "0"], /--budget: 0; above 0/],
  "a chart into a folder that cannot be made": [["chart", "seed", "--out", "nowhere/below"], /--out nowhere\/below/],
  "a choice without a tolerance": [["choose", "seed"], /--tolerance/],
  "a tolerance beyond the whole": [["choose", "seed", "--tolerance", "1.5"], /above 0, at most 1/],
  "a part's worth at no tolerance": [["simplify", "seed", "--tolerance", "0"], /above 0, at most 1/],
  "a map of a number that is not there": [["stability", "seed", "--field", "/solver/speed"], /--field/],
  "a map of a single value": [["stability", "seed", "--columns", "1"], /--columns.*2 to 41/],
  "a GPU that is not there": [["run", "seed", "--time", "0", "--gpu", "99"], /clothlab info/],
};
for (const [what, [args, message]] of Object.entries(wrong)) {
  test(`${what} exits 2 with one line that says what is wrong`, () => {
    const { status, stderr } = clothlab(args);
    assert.equal(status, 2, stderr);
    assert.match(stderr, /^clothlab: error: [^\n]+\n$/);
    assert.match(stderr, message);
  });
}

test("outputs are checked before anything is simulated, and nothing is left behind", () => {
  mkdirSync(join(folder, "a-folder.csv"));
  const good = { "--out": "early.obj", "--report": "early.json", "--trace": "early.csv" };
  for (const [option, path] of [
    ["--out", "nowhere/a.obj"],
    ["--report", "nowhere/a.json"],
    ["--trace", "a-folder.csv"],
  ]) {
    const { status, stderr } = clothlab([
      "run",
      "seed",
      "--time",
      "1e6",
      ...Object.entries({ ...good, [option]: path }).flat(),
    ]);
    assert.equal(status, 2);
    assert.match(stderr, new RegExp(`${option} ${path}`));
    for (const early of Object.values(good)) assert.ok(!existsSync(join(folder, early)), early);
  }
});

test("a scene file that is not JSON names the file and the place", () => {
  writeFileSync(join(folder, "broken.json"), '{ "version": 1,, }');
  const { status, stderr } = clothlab(["run", "broken.json", "--time", "1"]);
  assert.equal(status, 2);
  assert.match(stderr, /broken\.json/);
});

test("without any OpenGL the exit code is 3 and the packages to install are named", () => {
  const { status, stderr } = clothlab(["run", "seed", "--time", "0"], { __EGL_VENDOR_LIBRARY_DIRS: "/nonexistent" });
  assert.equal(status, 3);
  assert.match(stderr, /libegl1 libgl1-mesa-dri/);
});

test("info names a usable device, the one that is used, the methods, and the folders of the data files", () => {
  const { status, stdout } = clothlab(["info"]);
  assert.equal(status, 0);
  assert.match(stdout, /^\* \d+: .*OpenGL 4\./m);
  assert.match(stdout, /^methods .*\bsymplectic_euler\b/m);
  assert.match(stdout, /^shaders +\/.*shaders$/m);
});

test("a step near or beyond the longest stable one is said on stderr, in one line, and is no error", () => {
  const thick = ["--set", "/self_collision/thickness=0.036"]; // otherwise the thin self-collision is reported, too
  for (const args of [
    ["validate", "blowup"],
    ["run", "seed", "--time", "0", ...thick, "--set", "/solver/dt=0.0025"],
  ]) {
    const { status, stderr } = clothlab(args);
    assert.equal(status, 0);
    assert.match(stderr, /^clothlab: warning: .*0\.0025 s is beyond 0\.001701 s.*symplectic_euler.*\n$/);
  }
  const near = clothlab(["run", "seed", "--time", "0", ...thick, "--set", "/solver/dt=0.0016"]);
  assert.match(near.stderr, /^clothlab: warning: dt = 0\.0016 s is 94 % of 0\.001701 s.*\n$/);
  for (const args of [
    ["validate", "flag"],
    ["run", "seed", "--time", "0", ...thick],
  ])
    assert.equal(clothlab(args).stderr, "");
});

test("a self-collision too thin for the mesh is said on stderr with the thickness that holds, and is no error", () => {
  // 0.85 of the seed's spacing, 1 m / 24.
  for (const args of [
    ["validate", "seed"],
    ["run", "seed", "--time", "0"],
    ["run", "seed", "--time", "0", "--set", "/self_collision/thickness=0.03"],
  ]) {
    const { status, stderr } = clothlab(args);
    assert.equal(status, 0);
    assert.match(stderr, /^clothlab: warning: .*self_collision\.thickness = 0\.0[13] m is too thin .*0\.0354 m.*\n$/);
  }
  for (const preset of ["flag", "curtain", "drape", "tablecloth", "twist", "trampoline"])
    assert.equal(clothlab(["validate", preset]).stderr, "");
});
