// Files for other programs: what their formats ask for, and what Blender's importers take for granted.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import validator from "gltf-validator";
import { clothlab, folder } from "./program.mjs";

const file = (name) => readFileSync(join(folder, name));
function run(...args) {
  const result = clothlab(["run", ...args]);
  assert.equal(result.status, 0, result.stderr);
}

/// The JSON of a binary glTF file, and its array of an accessor.
function parts(bytes) {
  const jsonBytes = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + jsonBytes).toString());
  const binary = bytes.subarray(28 + jsonBytes);
  const widths = { SCALAR: 1, VEC2: 2, VEC3: 3 };
  const array = (index) => {
    const { bufferView, componentType, count, type } = json.accessors[index];
    const { byteOffset } = json.bufferViews[bufferView];
    const read = componentType === 5126 ? "readFloatLE" : "readUInt32LE";
    return Array.from({ length: count * widths[type] }, (_, i) => binary[read](byteOffset + 4 * i));
  };
  return { json, array };
}
const linesOf = (text, key) =>
  text
    .split("\n")
    .filter((line) => line.startsWith(`${key} `))
    .map((line) => line.split(" ").slice(1));

test("Khronos' validator finds nothing wrong with a .glb, of one cloth, of four, and of meshes with seams", async () => {
  for (const scene of ["seed", "fabrics", "skirt"]) {
    run(scene, "--time", "0.1", "--out", `${scene}.glb`);
    const { issues, info } = await validator.validateBytes(new Uint8Array(file(`${scene}.glb`)));
    // Texture coordinates are there for who adds a texture.
    const wrong = issues.messages.filter(
      ({ code, pointer }) => code !== "UNUSED_OBJECT" || !/TEXCOORD_0$/.test(pointer),
    );
    assert.deepEqual(wrong, [], scene);
    assert.equal(info.version, "2.0");
  }
});

test("a .glb has each cloth by its name, with the bits of the .obj, its colour, and unit normals", () => {
  const scene = "fabrics";
  run(scene, "--time", "0.1", "--out", "same.glb");
  run(scene, "--time", "0.1", "--out", "same.obj");
  const { cloths } = JSON.parse(
    readFileSync(new URL("../../server/scene/presets/fabrics.json", import.meta.url), "utf8"),
  );
  const { json, array } = parts(file("same.glb"));
  const obj = file("same.obj").toString();
  const vertices = linesOf(obj, "v")
    .flat()
    .map((text) => Math.fround(Number(text)));
  const texture = linesOf(obj, "vt")
    .flat()
    .map((text) => Math.fround(Number(text)));
  const faces = linesOf(obj, "f")
    .flat()
    .map((corner) => Number(corner.split("/")[0]) - 1);
  const found = { vertices: [], texture: [], faces: [] };
  for (const node of json.scenes[0].nodes) {
    const { attributes, indices, material } = json.meshes[json.nodes[node].mesh].primitives[0];
    const first = found.vertices.length / 3;
    found.vertices.push(...array(attributes.POSITION));
    found.texture.push(...array(attributes.TEXCOORD_0));
    found.faces.push(...array(indices).map((corner) => corner + first));
    const normals = array(attributes.NORMAL);
    for (let i = 0; i < normals.length; i += 3) assert.ok(Math.abs(Math.hypot(...normals.slice(i, i + 3)) - 1) < 1e-6);
    assert.ok(json.materials[material].doubleSided);
  }
  assert.deepEqual(
    json.nodes.map(({ name }) => name),
    cloths.map(({ name }) => name),
  );
  assert.deepEqual(found.vertices, vertices);
  assert.deepEqual(found.faces, faces);
  // An image's first row is its upper one.
  found.texture.forEach((value, i) => assert.equal(value, i % 2 ? Math.fround(1 - texture[i]) : texture[i]));
});

test("a colour is linear light in a .glb", () => {
  run("seed", "--time", "0.01", "--out", "grey.glb", "--set", '/cloths/0/color="#bc0080"');
  const [red, green, blue, opaque] = parts(file("grey.glb")).json.materials[0].pbrMetallicRoughness.baseColorFactor;
  // IEC 61966-2-1: 188 of 255 is half of the light, 128 a fifth.
  assert.ok(Math.abs(red - 0.5029) < 1e-4 && green === 0 && Math.abs(blue - 0.2159) < 1e-4 && opaque === 1);
});

// Blender: "Mesh Cache" and the OBJ importer, with "Keep vertex order".
test("a point cache has the vertices of the .obj of the same run, in its order, and a sample for each of its files", () => {
  const times = ["--time", "0.2", "--every", "0.05"];
  run("skirt", ...times, "--out", "cache.pc2");
  run("skirt", ...times, "--out", "frame.obj");
  const cache = file("cache.pc2");
  const points = cache.readInt32LE(16),
    samples = cache.readInt32LE(28);
  assert.equal(samples, 5);
  for (let sample = 0; sample < samples; ++sample) {
    const obj = linesOf(file(`frame-000${sample}.obj`).toString(), "v").flat();
    assert.equal(obj.length, 3 * points);
    obj.forEach((text, i) =>
      assert.equal(cache.readFloatLE(32 + 4 * (3 * points * sample + i)), Math.fround(Number(text))),
    );
  }
});
