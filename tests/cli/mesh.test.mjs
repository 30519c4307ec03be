// Scenes whose mesh is a file, on the command line.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
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
  assert.match(told(halves(0, true)).stderr, /1 corner lies on an edge .*: the edge was divided: line 9/);
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

const written = (name, value) => writeFileSync(join(folder, "scenes", name), value);

test("what people bring is mended with a note that counts it and says where, and is refused with mend false", () => {
  written("brought.obj", `\uFEFFHead scan\n${square}f 1 2 4\nstitch 1 2\nf 1 1 2\n`);
  const of = (mesh) => {
    written("brought.json", JSON.stringify({ version: 1, cloths: [{ mesh: { file: "brought.obj", ...mesh } }] }));
    return "scenes/brought.json";
  };
  for (const command of [["validate"], ["run", "--time", "0.01"]]) {
    const { status, stderr } = clothlab([command[0], of({}), ...command.slice(1)]);
    assert.equal(status, 0, stderr);
    for (const told of [
      /\/cloths\/0\/mesh: brought\.obj: 2 lines with words .*"Head" in line 1, "stitch" in line 8/,
      /\/cloths\/0\/mesh: brought\.obj: 1 triangle is there already and was left out: line 7/,
      /\/cloths\/0\/mesh: brought\.obj: 1 face without area was left out: line 9/,
    ])
      assert.match(stderr, told);
  }
  const { status, stderr } = clothlab(["validate", of({ mend: false })]);
  assert.equal(status, 2);
  assert.match(stderr, /\/cloths\/0\/mesh\/file.*brought\.obj, line 1: "Head"/);
});

test("a node of a .gltf file with its buffer beside it is a cloth, another one a body", () => {
  const buffer = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer);
  written("dress.bin", buffer);
  written(
    "dress.gltf",
    JSON.stringify({
      asset: { version: "2.0" },
      scenes: [{ nodes: [0, 1] }],
      nodes: [
        { name: "skirt", mesh: 0 },
        { name: "form", mesh: 0, scale: [2, 2, 2], translation: [5, 0, 0] },
      ],
      meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
      accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3" }],
      bufferViews: [{ buffer: 0, byteLength: 36 }],
      buffers: [{ byteLength: 36, uri: "dress.bin" }],
    }),
  );
  const of = (node) => ({ mesh: { file: "dress.gltf", node } });
  const scene = { version: 1, cloths: [of("skirt")], colliders: [of("form")] };
  written("dress.json", JSON.stringify(scene));
  const { status, stdout, stderr } = clothlab(["validate", "scenes/dress.json"]);
  assert.equal(status, 0, stderr);
  assert.match(stdout, /3 vertices.*1 collider/);
  written("dress.json", JSON.stringify({ ...scene, cloths: [of("hat")] }));
  assert.match(clothlab(["validate", "scenes/dress.json"]).stderr, /"hat".*one of "skirt", "form"/);
  rmSync(join(folder, "scenes/dress.bin"));
  written("dress.json", JSON.stringify(scene));
  assert.match(clothlab(["validate", "scenes/dress.json"]).stderr, /dress\.bin: no such file.*beside dress\.gltf/);
});

test("vertices in centimetres with a pattern in metres are told, each with what to set", () => {
  const corners = [
    [0, 0],
    [1, 0],
    [1, 1],
    [0, 1],
  ]; // prettier-ignore
  const lines = corners.map(([x, y]) => `v ${100 * x} ${100 * y} 0\nvt ${x} ${y}\n`);
  written("cm.obj", `${lines.join("")}f 1/1 2/2 3/3 4/4\n`);
  const told = (cloth) => {
    written("cm.json", JSON.stringify({ version: 1, cloths: [cloth] }));
    const { status, stderr } = clothlab(["validate", "scenes/cm.json"]);
    assert.equal(status, 0, stderr);
    return stderr;
  };
  const stderr = told({ mesh: { file: "cm.obj", pattern: "uv" } });
  assert.match(stderr, /\/cloths\/0\/transform: it is 100 m large.*"scale": 0\.01} makes it 1 m/);
  assert.match(stderr, /\/cloths\/0\/mesh\/pattern: .* 0\.01 times as long.*"pattern_scale": 100 /);
  const set = { mesh: { file: "cm.obj", pattern: "uv", pattern_scale: 100 }, transform: { scale: 0.01 } };
  assert.doesNotMatch(told(set), /\/cloths/);
});

/** A tube round the y axis, of so many centimetres. */
function tube(radius, from, to) {
  const [around, rings] = [24, 16];
  const lines = [];
  for (let ring = 0; ring <= rings; ++ring)
    for (let i = 0; i < around; ++i) {
      const angle = (2 * Math.PI * i) / around;
      const y = from + ((to - from) * ring) / rings;
      lines.push(`v ${(radius * Math.cos(angle)).toFixed(4)} ${y.toFixed(4)} ${(radius * Math.sin(angle)).toFixed(4)}`);
    }
  for (let ring = 0; ring < rings; ++ring)
    for (let i = 0; i < around; ++i) {
      const [a, b] = [ring * around + i + 1, ring * around + ((i + 1) % around) + 1];
      lines.push(`f ${a} ${a + around} ${b + around} ${b}`);
    }
  return `${lines.join("\n")}\n`;
}

test("--fit makes a scene of a garment and a body that runs, in metres, of cotton, with contact that fits", () => {
  written("sleeve.obj", tube(12, 60, 110));
  written("figure.obj", tube(10, 0, 170));
  const args = ["validate", "--fit", "scenes/fitted.json", "scenes/sleeve.obj"];
  const { status, stdout, stderr } = clothlab([...args, "--body", "scenes/figure.obj"]);
  assert.equal(status, 0, stderr);
  assert.match(stdout, /scenes\/fitted\.json: valid \(1 cloth/);
  assert.match(stderr, /scaled by 0\.01 all of them measure 1\.7 m/);
  const scene = JSON.parse(readFileSync(join(folder, "scenes/fitted.json"), "utf8"));
  const { cloths, colliders, self_collision: contact, solver } = scene;
  assert.deepEqual(cloths, [
    { name: "sleeve", mesh: { file: "sleeve.obj" }, material: { fabric: "cotton" }, transform: { scale: 0.01 } },
  ]);
  assert.deepEqual(colliders[0].mesh, { file: "figure.obj" });
  assert.equal(colliders[0].transform.scale, 0.01);
  assert.equal(contact.kind, "surface");
  assert.ok(contact.thickness > 0.001 && contact.thickness < 0.005, `${contact.thickness} m`); // of edges of 3 cm
  assert.equal(solver.method, "implicit_euler");
  const run = clothlab(["run", "scenes/fitted.json", "--time", "0.1", "--verify", "--report", "fitted-report.json"]);
  assert.equal(run.status, 0, run.stderr);
  const report = JSON.parse(readFileSync(join(folder, "fitted-report.json"), "utf8"));
  assert.equal(report.diverged, false);
  assert.equal(report.crossings, 0);

  const alone = clothlab(args);
  assert.equal(alone.status, 0, alone.stderr);
  const [{ pins }] = JSON.parse(readFileSync(join(folder, "scenes/fitted.json"), "utf8")).cloths;
  assert.ok(Math.abs(pins[0].at.box[0][1] - (1.1 - 0.03 * 0.5)) < 1e-3, "the highest 3 % are held");
  const outside = clothlab(["validate", "--fit", "scenes/fitted.json", "meshes/other.obj"]);
  assert.equal(outside.status, 2);
  assert.match(outside.stderr, /meshes\/other\.obj.*does not lie below the folder of scenes\/fitted\.json/);
  const absent = clothlab(["validate", "--fit", "scenes/fitted.json", "scenes/absent.obj"]);
  assert.equal(absent.status, 2);
  assert.match(absent.stderr, /scenes\/absent\.obj.*no such file/);
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
