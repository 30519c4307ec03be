// Scenes whose mesh is a file, on the command line.
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { clothlab, folder } from "./program.mjs";

const square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
mkdirSync(join(folder, "scenes"));
mkdirSync(join(folder, "meshes"));
writeFileSync(join(folder, "scenes/square.obj"), square);
writeFileSync(join(folder, "meshes/other.obj"), square.replace("f 1 2 3 4", "f 1 2 3"));
const scene = (obj) => {
  writeFileSync(join(folder, "scenes/scene.json"), JSON.stringify({ version: 1, cloths: [{ mesh: { obj } }] }));
  return "scenes/scene.json";
};

test("a mesh's name is a path below the folder of the scene file", () => {
  const { status, stdout } = clothlab(["validate", scene("square.obj")]);
  assert.equal(status, 0);
  assert.match(stdout, /4 vertices/);
  const outside = clothlab(["validate", scene("../meshes/other.obj")]);
  assert.equal(outside.status, 2);
  assert.match(outside.stderr, /\/cloths\/0\/mesh\/obj.*"\.\.".*--asset-root/);
});

test("with --asset-root it is a path below that folder, for every command", () => {
  for (const command of [
    ["validate", scene("other.obj")],
    ["run", scene("other.obj"), "--time", "0.01"],
  ]) {
    assert.equal(clothlab([...command, "--asset-root", "meshes"]).status, 0, command[0]);
    assert.equal(clothlab(command).status, 2, command[0]);
  }
  const { status, stderr } = clothlab(["run", "seed", "--time", "1", "--asset-root", "no-such"]);
  assert.equal(status, 2);
  assert.match(stderr, /--asset-root no-such/);
});

test("of a preset it is a path below the present folder, and --set may name it", () => {
  const pins = '/cloths/0/pins=[{"at": "vertex:3"}]';
  const args = ["run", "hanging-strip", "--time", "0.01", "--out", "out.obj", "--set", "/cloths/0/weights=[]"];
  const mesh = '/cloths/0/mesh={"obj": "scenes/square.obj"}';
  const { status, stderr } = clothlab([...args, "--set", "/cloths/0/pins=[]", "--set", mesh, "--set", pins]);
  assert.equal(status, 0, stderr);
});

test("a seam that rounding has opened is closed, and one that stays open is told by line", () => {
  const halves = (apart, middle) => {
    const lines = ["v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0", `v ${1 + apart} 0 0`, `v ${1 + apart} 1 0`];
    lines.push("v 2 0 0", "v 2 1 0", "f 1 2 3 4");
    if (middle) lines.push("v 1 0.5 0", "f 2 7 8 9", "f 9 8 3");
    else lines.push("f 5 7 8 6");
    return `${lines.join("\n")}\n`;
  };
  const told = (obj) => {
    writeFileSync(join(folder, "scenes/seam.obj"), obj);
    const { status, stdout, stderr } = clothlab(["validate", scene("seam.obj")]);
    assert.equal(status, 0, stderr);
    return { stdout, stderr };
  };
  const closed = told(halves(2.3e-16));
  assert.match(closed.stdout, /6 vertices/);
  assert.equal(closed.stderr, "");
  const open = told(halves(1e-4));
  assert.match(open.stdout, /8 vertices/);
  assert.match(open.stderr, /\/cloths\/0\/mesh: seam\.obj: 2 corners .*line 9 and line 10: the mesh is open there/);
  assert.match(told(halves(0, true)).stderr, /1 corner at its borders lies on an edge .*line 9/);
  const vertices = [
    [0, 0, 0],
    [1, 0, 0],
    [0, 0, 1],
    [1, 0, 0],
    [1, 0, 1],
    [0, 0, 1],
  ]; // prettier-ignore
  const mesh = {
    vertices,
    triangles: [
      [0, 2, 1],
      [3, 5, 4],
    ],
  }; // prettier-ignore
  writeFileSync(join(folder, "scenes/own.json"), JSON.stringify({ version: 1, cloths: [{ mesh }] }));
  const own = clothlab(["validate", "scenes/own.json"]);
  assert.match(own.stderr, /\/cloths\/0\/mesh: 2 corners .*triangle 0 and triangle 1/);
});

test("a start that is too near for contact is told once with its cause, and is not blamed on pins or bodies", () => {
  const sheet = (height) => ({
    mesh: { grid: { columns: 9, rows: 9 } },
    transform: { translate: [0, height, 0] },
    pins: [{ at: "corner:0,0" }, { at: "corner:8,0" }],
  });
  const near = { version: 1, cloths: [sheet(0), sheet(1e-7)], self_collision: { thickness: 0.005, kind: "surface" } };
  writeFileSync(join(folder, "scenes/near.json"), JSON.stringify(near));
  const { status, stderr } = clothlab(["run", "scenes/near.json", "--time", "0.1"]);
  assert.equal(status, 0, stderr);
  assert.equal(stderr.match(/at the start vertex .* is 1e-07 m from .*move them apart by/g)?.length, 1, stderr);
  assert.doesNotMatch(stderr, /pins or bodies/);
});
