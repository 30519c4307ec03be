// The scene as text: JSON read with lines, printed, compared, and made a command line.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { load } from "./module.mjs";

const { readJson } = await load("text/json_text");
const { print } = await load("text/print");
const { ordered } = await load("text/order");
const { difference } = await load("text/difference");
const { assignments, commandLine } = await load("text/code");
const { applyPatch } = await load("link/json_patch");

const folder = new URL("../../server/scene/presets/", import.meta.url);
const files = readdirSync(folder).filter((file) => file.endsWith(".json"));
const presets = files.map((file) => JSON.parse(readFileSync(new URL(file, folder), "utf8")));

test("a text that is no JSON is told of by line and column, in words", () => {
  for (const [text, line, column, says] of [
    ["", 1, 1, /the end of the text where a value belongs/],
    ["{", 1, 2, /the end of the text where a key in double quotes belongs/],
    ['{\n  "a": 1\n  "b": 2\n}', 3, 3, /“"” where “,” or “}” belongs/],
    ['{\n  "a": [1, 2,\n ]}', 2, 13, /a “,” before “]”/],
    ['{ "a": 1, }', 1, 9, /a “,” before “}”/],
    ["{ a: 1 }", 1, 3, /“a” where a key in double quotes belongs/],
    ['{ "a" 1 }', 1, 7, /“1” where the “:” after “a” belongs/],
    ['{ "a": True }', 1, 8, /“True” is no value/],
    ['{ "a": 01 }', 1, 9, /“1” in a number/],
    ['{ "a": 1.e5 }', 1, 9, /“\.” in a number/],
    ['{ "a": .5 }', 1, 8, /“\.” where a value belongs/],
    ['{ "a": "x\n" }', 1, 8, /a text that its line does not end/],
    ['{ "a": "\\x" }', 1, 9, /“\\x” stands for nothing/],
    ['{ "a": "\\u12" }', 1, 9, /without four digits/],
    ['{ "a": 1 } 2', 1, 12, /“2” after the end/],
    ['{ // how\n "a": 1 }', 1, 3, /a comment; JSON has none/],
    ['{ "a": 1,\n  "a": 2 }', 2, 3, /the key “a” stands here a second time/],
    ["[".repeat(40), 1, 34, /nested deeper than 32/],
  ]) {
    const fault = readJson(text);
    assert.deepEqual([fault.line, fault.column], [line, column], text);
    assert.match(fault.says, says);
  }
});

test("what JSON.parse reads is read as it does, and each place has its line", () => {
  const texts = [
    ...presets.map((preset) => print(preset)),
    '[1, -0, 1e3, -1.5E-3, "\\u00e4\\n\\"\\\\\\/", true, false, null, {}, [], ""]',
    ' {"__proto__": {"a": 1}, "constructor": 2} ',
  ];
  for (const text of texts) assert.deepEqual(readJson(text).value, JSON.parse(text));
  const { lineOf } = readJson('{\n  "a/b": [\n    1,\n    { "m~n": 2 }\n  ]\n}');
  for (const [pointer, line] of [
    ["", 1],
    ["/a~1b", 2],
    ["/a~1b/0", 3],
    ["/a~1b/1/m~0n", 4],
    ["/a~1b/1/nothing/there", 4],
    ["/a~1b/7", 2],
    ["/nothing", 1],
  ])
    assert.equal(lineOf(pointer), line, pointer);
});

test("a scene is printed in the order of the contract, in lines that fit, and read back as it was", () => {
  for (const preset of presets) {
    const sorted = JSON.parse(JSON.stringify(preset), (_, value) =>
      typeof value === "object" && value && !Array.isArray(value)
        ? Object.fromEntries(Object.entries(value).sort())
        : value,
    );
    const text = print(ordered(sorted));
    assert.deepEqual(JSON.parse(text), preset);
    assert.match(text, /^\{\n {2}"version": 1,\n {2}"name": /);
    for (const line of text.split("\n")) assert.ok(line.length <= 120, line);
    const literal = spawnSync("python3", ["-c", "import sys, json; print(json.dumps(eval(sys.stdin.read())))"], {
      input: print(preset, "python"),
      encoding: "utf8",
    });
    assert.deepEqual(JSON.parse(literal.stdout), preset);
    // biome-ignore lint/security/noGlobalEval: that it is JavaScript is what is tested
    assert.deepEqual(eval(`(${print(preset, "javascript")})`), preset);
  }
});

const cloth = (name, more = {}) => ({ name, mesh: { grid: { columns: 5, rows: 5 } }, pins: [], ...more });
const scene = {
  name: "seed",
  gravity: [0, -9.8, 0],
  cloths: [cloth("a"), cloth("b"), cloth("c")],
  colliders: [{ name: "ball", sphere: { center: [0, 0, 0], radius: 1 }, motion: null }],
  solver: { method: "verlet", dt: 0.001 },
};
const changed = (change) => {
  const copy = structuredClone(scene);
  change(copy);
  return copy;
};

test("the difference of two scenes is as deep as can be, and makes one the other", () => {
  for (const [change, paths] of [
    [() => {}, []],
    [(s) => Object.assign(s.solver, { dt: 0.002 }), ["replace /solver/dt"]],
    [(s) => Object.assign(s, { gravity: [0, -1, 0], wind: null }), ["replace /gravity", "add /wind"]],
    [(s) => delete s.solver.method, ["remove /solver/method"]],
    [(s) => s.cloths.splice(1, 1), ["remove /cloths/1"]],
    [(s) => s.cloths.splice(0, 2), ["remove /cloths/0", "remove /cloths/0"]],
    [(s) => s.cloths.splice(1, 0, cloth("x"), cloth("y")), ["add /cloths/1", "add /cloths/2"]],
    [(s) => Object.assign(s.cloths[2], { name: "z" }), ["replace /cloths/2/name"]],
    [(s) => s.cloths[0].pins.push({ at: "vertex:1" }), ["add /cloths/0/pins/0"]],
    [
      (s) => {
        delete s.colliders[0].sphere;
        s.colliders[0].box = { half: [1, 1, 1] };
      },
      ["remove /colliders/0/sphere", "add /colliders/0/box"],
    ],
    [(s) => Object.assign(s, { "a/b~c": 1 }), ["add /a~1b~0c"]],
    [(s) => Object.assign(s, { solver: { dt: s.solver.dt, method: s.solver.method } }), []],
  ]) {
    const after = changed(change);
    const operations = difference(scene, after);
    assert.deepEqual(
      operations.map(({ op, path }) => `${op} ${path}`),
      paths,
    );
    assert.deepEqual(applyPatch(scene, operations), after);
  }
});

test("as assignments of a command line, what cannot be assigned alone is assigned with the whole around it", () => {
  for (const [change, places] of [
    [(s) => Object.assign(s.solver, { dt: 0.002 }), ["/solver/dt"]],
    [(s) => s.cloths[1].pins.push({ at: "vertex:1" }, { at: "vertex:2" }), ["/cloths/1/pins/0", "/cloths/1/pins/1"]],
    [(s) => s.cloths.splice(0, 1), ["/cloths"]],
    [(s) => s.cloths.splice(0, 0, cloth("x")), ["/cloths"]],
    [(s) => delete s.solver.method, ["/solver"]],
    [
      (s) => {
        s.cloths[1].mesh.grid.rows = 3;
        s.cloths[1].pins.push({ at: "vertex:1" });
        s.cloths[2].name = "z";
      },
      ["/cloths/1", "/cloths/2/name"],
    ],
  ])
    assert.deepEqual(
      assignments(scene, changed(change)).map(([pointer]) => pointer),
      places,
    );
  const sets = changed((s) => Object.assign(s, { gravity: [0, -1, 0], name: "it's" }));
  assert.equal(
    commandLine(sets, scene),
    "clothlab serve --scene seed \\\n  --set '/name=it'\\''s' \\\n  --set '/gravity=[0,-1,0]'",
  );
  assert.match(commandLine(sets, null), /--scene it_s\.json/);
});
