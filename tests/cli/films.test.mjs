// `clothlab record` writes films for other programs: as their formats' validators want them, with the places of the
// recording's frames, and its bodies where they are.
import assert from "node:assert/strict";
import { readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import validator from "gltf-validator";
import { glbAt, placed, readGlb, readObj, readUsda, valueAt } from "./film_files.mjs";
import { clothlab, folder } from "./program.mjs";
import { inPage, pointCache, readRecording, record } from "./recordings.mjs";

// Every kind of body, each with every motion that it may have, two cloths, and a start that is not 0.
const spin = (center, degrees_per_second) => ({ spin: { axis: [0, 0, 1], center, degrees_per_second } });
const wedge = {
  vertices: [
    [0, 0, 0],
    [0.4, 0, 0],
    [0, 0, 0.4],
    [0, 0.4, 0],
  ],
  triangles: [
    [0, 2, 1],
    [0, 1, 3],
    [0, 3, 2],
    [1, 2, 3],
  ],
};
const cloth = (name, columns, y, more) => ({
  name,
  mesh: { grid: { columns, rows: 9 } },
  transform: { translate: [0, y, -0.5] },
  ...more,
});
const scene = {
  version: 1,
  name: "all bodies",
  cloths: [cloth("sheet", 9, 1, { color: "#2060c0" }), cloth("second sheet", 5, 1.3, { pins: [{ at: "corner:0,0" }] })],
  colliders: [
    { name: "ball", sphere: { center: [0, 0.5, 0], radius: 0.3 }, motion: { linear: { velocity: [0.3, 0, 0] } } },
    { name: "floor", plane: { point: [0, 0, 0], normal: [0, 1, 0] } },
    { name: "rod", capsule: { a: [-1, 0.3, 0], b: [-1, 0.9, 0.2], radius: 0.2 }, motion: spin([-1, 0.5, 0], 90) },
    {
      name: "crate",
      box: { center: [1.2, 0.3, 0], half: [0.2, 0.1, 0.3], rotate: [10, 20, 30] },
      motion: spin([1.2, 0, 0], -300),
    },
    {
      name: "wedge",
      mesh: wedge,
      transform: { translate: [0, 0, -2], rotate: [0, 30, 0], scale: 1.5 },
      motion: { oscillate: { axis: [1, 0, 0], amplitude: 0.2, frequency: 1 } },
    },
  ],
};
const file = (name) => readFileSync(join(folder, name));
let recording, moments, setting;
const made = (out, ...args) => {
  const result = record(["all.clothlab", ...args], out);
  assert.equal(result.status, 0, result.stderr);
  return result;
};
before(async () => {
  writeFileSync(join(folder, "all.json"), JSON.stringify(scene));
  const { status, stderr } = record(["all.json", "--time", "1.5"], "all.clothlab");
  assert.equal(status, 0, stderr);
  ({ recording, moments } = await readRecording(file("all.clothlab")));
  [{ setting }] = recording.groups;
});

/// A vertex of a frame as the server computes it from the recording, in single precision.
const place = ({ low, quantum, numbers }, i) =>
  low.map((from, axis) => Math.fround(from + Math.fround(quantum * numbers[3 * i + axis])));
const some = (count) => [0, 1, 2, 3, 4].map((k) => Math.floor((k * (count - 1)) / 4));
/// Numbers below 4 m: the difference from the first frame and its sum with it round by half of 2^-22 each, as do the
/// place and the first place.
const rounding = 4 * 2 ** -23;
const near = (found, wanted, tolerance, what) =>
  found.forEach((x, axis) => assert.ok(Math.abs(x - wanted[axis]) <= tolerance, `${what}: ${found}, not ${wanted}`));

/// A collider as the recording has it in a frame.
const collider = (index, { moved }) => ({
  ...setting.document.colliders[index],
  ...moved.find((each) => each.index === index),
});
const radians = (degrees) => (degrees * Math.PI) / 180;
/// Turned about x, then y, then z [degrees].
const turned = (point, degrees) =>
  [
    [0, 1, 2],
    [1, 2, 0],
    [2, 0, 1],
  ].reduce((at, [axis, u, v]) => {
    const [cos, sin] = [Math.cos(radians(degrees[axis])), Math.sin(radians(degrees[axis]))];
    const out = at.slice();
    out[u] = cos * at[u] - sin * at[v];
    out[v] = sin * at[u] + cos * at[v];
    return out;
  }, point);
const plus = (a, b) => a.map((x, i) => x + b[i]);
const distance = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));

/// That these places, of a body's surface, are those of the collider: all that tells where it is.
function checkBody(of, places, what) {
  const close = 2e-6; // of unit quaternions and places of single precision, up to 4 m from the origin
  const farthest = (direction) =>
    Math.max(...places.map((p) => p[0] * direction[0] + p[1] * direction[1] + p[2] * direction[2]));
  if (of.sphere) {
    const { center, radius } = of.sphere;
    for (const p of places) assert.ok(Math.abs(distance(p, center) - radius) < close, `${what}: ${p}`);
  } else if (of.plane) {
    for (const p of places) assert.ok(Math.abs(p[1]) < close, `${what}: ${p}`);
    assert.ok(farthest([1, 0, 0]) > 2 && farthest([0, 0, 1]) > 2, `${what}: too small`);
  } else if (of.capsule) {
    const { a, b, radius } = of.capsule;
    const along = a.map((x, i) => (b[i] - x) / distance(a, b));
    for (const p of places) {
      const from = p.map((x, i) => x - a[i]);
      const share = Math.min(
        distance(a, b),
        Math.max(
          0,
          from.reduce((sum, x, i) => sum + x * along[i], 0),
        ),
      );
      assert.ok(
        Math.abs(
          distance(
            p,
            plus(
              a,
              along.map((x) => x * share),
            ),
          ) - radius,
        ) < close,
        `${what}: ${p}`,
      );
    }
    const end = b.reduce((sum, x, i) => sum + x * along[i], radius);
    assert.ok(Math.abs(farthest(along) - end) < close, `${what}: its end`);
  } else {
    const corners = of.box
      ? [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z) => [x, y, z].map((s, i) => s * of.box.half[i]))))
      : of.mesh.vertices.map((v) => v.map((x) => x * of.transform.scale));
    const { rotate, center: at } = of.box ?? { ...of.transform, center: of.transform.translate };
    for (const corner of corners) {
      const wanted = plus(turned(corner, rotate), at);
      assert.ok(Math.min(...places.map((p) => distance(p, wanted))) < close, `${what}: nothing at ${wanted}`);
    }
  }
}

test("Khronos' validator finds nothing wrong with a .glb of moving cloths and bodies", async () => {
  made("all.glb");
  const { issues, info } = await validator.validateBytes(new Uint8Array(file("all.glb")));
  // Texture coordinates are there for who adds a texture.
  const wrong = issues.messages.filter(({ code, pointer }) => code !== "UNUSED_OBJECT" || !/TEXCOORD_0$/.test(pointer));
  assert.deepEqual(wrong, []);
  assert.equal(info.animationCount, 1);
});

test("a .glb has the vertices of the recording at its times, and between two of them the middle", () => {
  made("places.glb");
  const glb = readGlb(file("places.glb"));
  const { cloths } = setting.topology;
  for (const frame of some(moments.length)) {
    const nodes = glbAt(glb, Math.fround(moments[frame].time));
    for (const [c, { name }] of scene.cloths.entries()) {
      assert.equal(nodes[name].places.length, cloths[c].vertexCount);
      for (const i of some(cloths[c].vertexCount))
        near(
          nodes[name].places[i],
          place(moments[frame], cloths[c].firstVertex + i),
          rounding,
          `frame ${frame}, vertex ${i}`,
        );
    }
  }
  const half = glbAt(glb, (moments[7].time + moments[8].time) / 2).sheet.places;
  for (const i of some(half.length)) {
    const [a, b] = [7, 8].map((k) => place(moments[k], i));
    // Times of single precision, up to 2^-24 s off, at up to 10 m/s.
    near(
      half[i],
      plus(a, b).map((x) => x / 2),
      2 * rounding + 1e-6,
      `vertex ${i}`,
    );
  }
});

test("a .glb has colours, triangles, texture coordinates and unit normals in every frame", () => {
  made("looks.glb");
  const { json, array } = readGlb(file("looks.glb"));
  const linear = (byte) => (byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4);
  near(
    json.materials[0].pbrMetallicRoughness.baseColorFactor,
    [linear(0x20), linear(0x60), linear(0xc0), 1],
    1e-12,
    "colour",
  );
  const [{ attributes, targets, indices }] = json.meshes[0].primitives;
  const { triangles, textureCoordinates } = setting.topology;
  assert.deepEqual(array(indices).flat(), [...triangles.slice(0, 3 * 128)]);
  const upright = array(attributes.TEXCOORD_0).flatMap(([u, v]) => [u, 1 - v]);
  near(upright, [...textureCoordinates.slice(0, 2 * 81)], 2 ** -24, "texture");
  const first = array(attributes.NORMAL);
  for (const target of some(targets.length))
    for (const [i, change] of array(targets[target].NORMAL).entries())
      assert.ok(Math.abs(Math.hypot(...plus(first[i], change)) - 1) < 1e-6, `target ${target}, vertex ${i}`);
});

test("the bodies of a .glb are where the recording has them, whatever their kind and motion", () => {
  made("bodies.glb");
  const glb = readGlb(file("bodies.glb"));
  for (const frame of some(moments.length)) {
    const nodes = glbAt(glb, Math.fround(moments[frame].time));
    for (const [i, { name }] of scene.colliders.entries())
      checkBody(collider(i, moments[frame]), nodes[name].places, `${name} in frame ${frame}`);
  }
});

test("a .usda has the recording's vertices to the bit, its time, unit and colours, and names that USD allows", () => {
  made("all.usda");
  const { metadata, prims } = readUsda(file("all.usda").toString());
  assert.equal(metadata.metersPerUnit, 1);
  assert.equal(metadata.upAxis, "Y");
  assert.equal(metadata.defaultPrim, prims[0].name);
  assert.ok(Math.abs(metadata.timeCodesPerSecond - recording.rate) < 1e-9);
  assert.ok(Math.abs(metadata.endTimeCode - moments.at(-1).time * recording.rate) < 1e-6);
  const materials = new Map();
  const named = (prim, path) => {
    assert.match(prim.name, /^[A-Za-z_]\w*$/);
    if (prim.type === "Material") materials.set(`${path}/${prim.name}`, prim.prims[0].attributes);
    assert.equal(new Set(prim.prims.map(({ name }) => name)).size, prim.prims.length);
    for (const each of prim.prims) named(each, `${path}/${prim.name}`);
  };
  named(prims[0], "");
  for (const [c, { vertexCount: count, firstVertex: first }] of setting.topology.cloths.entries()) {
    const { name } = scene.cloths[c];
    const of = prims[0].prims.find(({ attributes }) => attributes["userProperties:name"]?.value === name);
    assert.equal(of.type, "Mesh");
    const { points, normals, extent, "primvars:st": texture, faceVertexIndices } = of.attributes;
    assert.equal(points.samples.size, moments.length);
    assert.equal(faceVertexIndices.value.length, 3 * of.attributes.faceVertexCounts.value.length);
    assert.equal(texture.value.length, count);
    const look = materials.get(of.attributes["material:binding"].value);
    assert.deepEqual(look["inputs:diffuseColor"].value, of.attributes["primvars:displayColor"].value[0]);
    const codes = [...points.samples.keys()];
    for (const frame of some(moments.length)) {
      const places = points.samples.get(codes[frame]);
      assert.ok(Math.abs(codes[frame] - moments[frame].time * recording.rate) < 1e-6);
      assert.equal(places.length, count);
      const [low, high] = extent.samples.get(codes[frame]);
      for (const i of some(count)) {
        assert.deepEqual(places[i].map(Math.fround), place(moments[frame], first + i), `frame ${frame}, vertex ${i}`);
        places[i].forEach((x, axis) => assert.ok(x >= low[axis] && x <= high[axis]));
        assert.ok(Math.abs(Math.hypot(...normals.samples.get(codes[frame])[i]) - 1) < 1e-6);
      }
    }
  }
});

test("the bodies of a .usda are where the recording has them, as spheres, capsules, cubes and meshes", () => {
  made("bodies.usda");
  const [{ prims }] = readUsda(file("bodies.usda").toString()).prims;
  const kinds = { ball: "Sphere", floor: "Mesh", rod: "Capsule", crate: "Cube", wedge: "Mesh" };
  const codes = [...prims.find(({ name }) => name === "sheet").attributes.points.samples.keys()];
  for (const [index, { name }] of scene.colliders.entries()) {
    const { type, attributes } = prims.find((each) => each.attributes["userProperties:name"]?.value === name);
    assert.equal(type, kinds[name]);
    assert.deepEqual(attributes.xformOpOrder.value, ["xformOp:translate", "xformOp:orient", "xformOp:scale"]);
    for (const frame of some(moments.length)) {
      const at = (key) => valueAt(attributes[`xformOp:${key}`], codes[frame]);
      const [w, x, y, z] = at("orient");
      const world = (point) => placed(point, at("scale"), [x, y, z, w], at("translate"));
      const of = collider(index, moments[frame]);
      const what = `${name} in frame ${frame}`;
      if (type === "Capsule") {
        const { height, radius, axis } = attributes;
        assert.equal(axis.value, "X");
        assert.ok(Math.abs(radius.value - of.capsule.radius) < 1e-12);
        near(world([-height.value / 2, 0, 0]), of.capsule.a, 2e-6, what);
        near(world([height.value / 2, 0, 0]), of.capsule.b, 2e-6, what);
      } else {
        const r = attributes.radius?.value ?? attributes.size?.value / 2;
        const local = attributes.points?.value ?? [
          [r, 0, 0],
          [0, -r, 0],
          [0, 0, r],
        ];
        const corners = [-r, r].flatMap((a) => [-r, r].flatMap((b) => [-r, r].map((c) => [a, b, c])));
        checkBody(of, (type === "Cube" ? corners : local).map(world), what);
      }
    }
  }
});

test("a .pc2 has every vertex of every frame to the bit, and beside it the mesh that it moves", () => {
  const { stdout } = made("all.pc2");
  assert.match(stdout, /^all\.pc2 and all\.obj: \d+ frames of all bodies, 1\.5 s, \d+ bytes\n$/);
  const samples = pointCache(join(folder, "all.pc2"));
  assert.equal(samples.length, moments.length);
  for (const [frame, moment] of moments.entries())
    for (let i = 0; i < setting.topology.vertexCount; ++i)
      assert.deepEqual(samples[frame].slice(3 * i, 3 * i + 3), place(moment, i), `frame ${frame}, vertex ${i}`);
  const { places, texture, triangles } = readObj(file("all.obj").toString());
  assert.deepEqual(places.flat().map(Math.fround), samples[0]);
  assert.equal(texture.length, places.length);
  assert.deepEqual(triangles.flat(), [...setting.topology.triangles]);
});

test("an .obj is a file a frame, so many a second and so much of it as was asked for", () => {
  const { stdout } = made("series.obj", "--rate", "10", "--time", "0.6");
  assert.match(stdout, /^series-0000\.obj to series-0006\.obj: 7 frames of all bodies, /);
  for (const k of [0, 3, 6])
    assert.deepEqual(
      readObj(file(`series-000${k}.obj`).toString()).places[17].map(Math.fround),
      place(moments[3 * k], 17),
    );
});

test("of a recording its beginning is a recording of the same bits, and a page plays it", async () => {
  // 40 frames: within the second group.
  made("part.clothlab", "--time", "1.3");
  made("part.html", "--time", "1.3");
  const alone = await readRecording(file("part.clothlab"));
  const paged = await readRecording(inPage(file("part.html").toString()));
  for (const part of [alone, paged]) {
    assert.equal(part.moments.length, 40);
    assert.equal(part.recording.diverged, null);
    for (const [k, moment] of part.moments.entries()) assert.deepEqual(moment, moments[k]);
  }
  made("whole.clothlab");
  assert.deepEqual(file("whole.clothlab"), file("all.clothlab"));
});

test("a film of a scene is that of its recording", () => {
  const { status, stdout } = record(["all.json", "--time", "1.5"], "scene.glb");
  assert.equal(status, 0);
  assert.match(stdout, /^scene\.glb: \d+ frames of all bodies, 1\.5 s, \d+ bytes\n$/);
  made("recorded.glb");
  assert.deepEqual(file("scene.glb"), file("recorded.glb"));
});

test("one frame is a mesh that does not move", async () => {
  made("still.glb", "--time", "0");
  const { json } = readGlb(file("still.glb"));
  assert.equal(json.animations, undefined);
  assert.equal((await validator.validateBytes(new Uint8Array(file("still.glb")))).issues.numErrors, 0);
  made("still.usda", "--time", "0");
  assert.equal(readUsda(file("still.usda").toString()).metadata.endTimeCode, 0);
});

for (const [what, [args, out, message]] of Object.entries({
  "a scene without a time": [["seed"], "a.glb", /--time: not given/],
  "a value for the scene of a recording": [
    ["all.clothlab", "--set", "/gravity=[0,0,0]"],
    "a.glb",
    /--set .*nothing is simulated/,
  ],
  "a rate for a recording that stays one": [
    ["all.clothlab", "--rate", "10"],
    "a.html",
    /--rate: a recording keeps its own/,
  ],
  "a recording into itself": [["all.clothlab"], "all.clothlab", /it is the recording itself/],
  "a recording that is not there": [["none.clothlab"], "a.glb", /none\.clothlab: No such file/],
  "more frames than a .glb has targets": [
    ["seed", "--time", "100"],
    "a.glb",
    /3032 frames; at most 2048.*--rate.*\.usda/,
  ],
}))
  test(`${what} exits 2 and says what is allowed`, () => {
    const before = statSync(join(folder, "all.clothlab")).mtimeMs;
    const { status, stderr, path } = record(args, out);
    assert.equal(status, 2, stderr);
    assert.match(stderr, message);
    if (out === "all.clothlab") assert.equal(statSync(path).mtimeMs, before);
    else assert.throws(() => statSync(path));
  });

test("a film that is shorter than was asked for says where its recording ends", () => {
  const ends = (name) => made(name, "--time", "60").stderr.match(/--time 60: the recording ends at ([\d.]+) s/)?.[1];
  const last = String(Number(moments.at(-1).time.toFixed(3)));
  for (const name of ["long.usda", "long.clothlab"]) assert.equal(String(Number(Number(ends(name)).toFixed(3))), last);
  assert.doesNotMatch(made("short.clothlab", "--time", "0.2").stderr, /the recording ends/);
});

test("a recording that is cut off or changed is refused wherever that is, and nothing is made of it", () => {
  const whole = file("half.clothlab", made("half.clothlab", "--time", "0.2"));
  for (const size of [0, 7, 15, 20, Math.floor(whole.length / 2), whole.length - 1]) {
    writeFileSync(join(folder, "cut.clothlab"), whole.subarray(0, size));
    const { status, stderr } = clothlab(["record", "cut.clothlab", "--out", "cut.glb"]);
    assert.equal(status, 2, `${size} bytes: ${stderr}`);
    assert.match(stderr, /cut\.clothlab, byte \d+ of the recording: .*; copy or download it again/);
  }
  for (const at of some(whole.length)) {
    const wrong = Buffer.from(whole);
    wrong[at] ^= 0x41;
    writeFileSync(join(folder, "wrong.clothlab"), wrong);
    assert.equal(clothlab(["record", "wrong.clothlab", "--out", "wrong.usda"]).status, 2, `byte ${at}`);
  }
  assert.throws(() => statSync(join(folder, "cut.glb")));
});
