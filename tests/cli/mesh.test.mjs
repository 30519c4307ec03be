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
