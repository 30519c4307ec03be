// Meshes from files and by mesh.upload, over the WebSocket.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { figure, tube } from "../browser/garment.mjs";
import { Client, Server } from "./harness.mjs";

const leaf = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n";
const square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
const named = (obj) => [
  { op: "replace", path: "/cloths/0/mesh", value: { obj } },
  { op: "replace", path: "/cloths/0/pins", value: [{ at: "vertex:3" }] },
];

let server, folder;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), "clothlab-meshes-"));
  mkdirSync(join(folder, "root"));
  writeFileSync(join(folder, "root/leaf.obj"), leaf);
  writeFileSync(join(folder, "root/bad.obj"), "v 0 0 0\nv 1 nan 0\n");
  writeFileSync(join(folder, "secret.obj"), leaf);
  symlinkSync("../secret.obj", join(folder, "root/link.obj"));
  server = await Server.start("--asset-root", join(folder, "root"), "--max-sessions", "16");
});
after(async () => {
  await server.stop();
  rmSync(folder, { recursive: true });
});

/// A .gltf file with two nodes below a third: a triangle, and two triangles as a strip.
function twoNodes() {
  const places = [
    [0, 0, 0, 1, 0, 0, 0, 1, 0],
    [0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1],
  ].map((numbers) => Buffer.from(new Float32Array(numbers).buffer));
  const bytes = Buffer.concat(places);
  const uri = `data:application/octet-stream;base64,${bytes.toString("base64")}`;
  const place = (bufferView, count) => ({ bufferView, componentType: 5126, count, type: "VEC3" });
  return {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [
      { name: "all", children: [1, 2] },
      { name: "shirt", mesh: 0 },
      { name: "body", mesh: 1, translation: [3, 0, 0] },
    ],
    meshes: [
      { name: "shirt of triangles", primitives: [{ attributes: { POSITION: 0 } }] },
      { name: "body of strips", primitives: [{ attributes: { POSITION: 1 }, mode: 5 }] },
    ],
    accessors: [place(0, 3), place(1, 4)],
    bufferViews: places.map(({ length }, i) => ({ buffer: 0, byteOffset: 36 * i, byteLength: length })),
    buffers: [{ byteLength: bytes.length, uri }],
  };
}

let sessions = 0;
async function enter(at = server) {
  const client = await Client.connect(at, { session: `mesh-${++sessions}` });
  await client.notification("scene");
  return client;
}

test("a scene names a file below --asset-root, whose vertices its pins count", async () => {
  const client = await enter();
  await client.request("scene.patch", { patch: named("leaf.obj") });
  await client.request("stream.subscribe", { encoding: "f32" });
  const frame = await client.frame((frame) => frame.vertexCount === 3 || frame.vertices === 3);
  assert.ok(frame);
  await client.close();
});

test("what is wrong with a file is told by pointer, line, value and allowance, and the scene goes on", async () => {
  const client = await enter();
  const before = await client.request("scene.get");
  for (const [name, found] of [
    ["bad.obj", /bad\.obj, line 2: "nan" as y/],
    ["../secret.obj", /"\.\."/],
    ["link.obj", /symbolic link/],
    [join(folder, "secret.obj"), /absolute/],
    ["none.obj", /no such file/],
  ]) {
    const { code, data } = await client.refusal("scene.patch", { patch: named(name) });
    assert.equal(code, -32602, name);
    assert.equal(data.path, "/cloths/0/mesh/obj");
    assert.match(data.found, found);
    assert.ok(data.allowed.length > 0);
  }
  assert.deepEqual(await client.request("scene.get"), before);
  await client.close();
});

test("without --asset-root no file is opened for a client", async (t) => {
  const scene = { version: 1, cloths: [{ mesh: { obj: "leaf.obj" } }] };
  writeFileSync(join(folder, "root/scene.json"), JSON.stringify(scene));
  const closed = await Server.start("--scene", join(folder, "root/scene.json"));
  t.after(() => closed.stop());
  const client = await enter(closed);
  await client.request("scene.patch", { patch: { gravity: [0, -1, 0] } });
  const { data } = await client.refusal("scene.patch", { patch: named("bad.obj") });
  assert.match(data.allowed, /--asset-root/);
  await client.close();
});

test("an uploaded mesh is read, answered for and named by the scene of its session alone", async () => {
  const [client, other] = [await enter(), await enter()];
  const answer = await client.request("mesh.upload", { name: "leaf.obj", obj: square });
  assert.deepEqual(answer, {
    name: "leaf.obj",
    vertices: 4,
    triangles: 2,
    parts: 1,
    merged: 0,
    unused: 0,
    flipped: 0,
    pattern: false,
    box: [
      [0, 0, 0],
      [1, 1, 0],
    ],
    area: 1,
    pattern_area: 0,
    mean_edge: (4 + Math.SQRT2) / 5,
    no_cloth: null,
    borders: [{ vertices: [0, 1, 2, 3], middle: [0.5, 0.5, 0] }],
    ends: [
      [1, 2],
      [2, 3],
      [0, 1, 2, 3],
    ],
    notes: [],
    nodes: [],
    removed: [],
  });
  await client.request("scene.patch", { patch: named("leaf.obj") });
  const base64 = Buffer.from(square).toString("base64");
  await client.request("mesh.upload", { name: "é", obj: base64, encoding: "base64" });
  assert.match(
    (await other.refusal("scene.patch", { patch: named("é") })).data.found,
    /does not end in \.obj, \.ply, \.glb or \.gltf/,
  );
  for (const [params, path] of [
    [{ name: "", obj: square }, "/name"],
    [{ name: "a\n", obj: square }, "/name"],
    [{ name: "x".repeat(65), obj: square }, "/name"],
    [{ name: "a", obj: "v 0 0\n" }, "/obj"],
    [{ name: "a", obj: "a b", encoding: "base64" }, "/obj"],
    [{ name: "a", obj: square, encoding: "hex" }, "/encoding"],
  ])
    assert.equal((await client.refusal("mesh.upload", params)).data.path, path, JSON.stringify(params));
  await client.close();
  await other.close();
});

test("an upload's answer has its openings, areas and parts by their names, in the numbers of the file", async () => {
  const client = await enter();
  // the shirt's vertices come after one that no face has and one that is there twice
  const head = "v 9 9 9\nv 0 0 0\n";
  const shirt = tube({ around: 8, rows: 2, unit: 1, first: 3 });
  const body = figure({ around: 6, rows: 4, unit: 1, first: 27 });
  const whole = await client.request("mesh.upload", { name: "both.obj", obj: head + shirt + body });
  assert.deepEqual(
    whole.nodes.map(({ node, borders }) => [node, borders.length]),
    [
      ["shirt", 2],
      ["figure", 0],
    ],
  );
  const [{ borders, ends, area, box, mean_edge: edge, pattern_area: none }] = whole.nodes;
  const sorted = (list) => [...list].sort((a, b) => a - b);
  const [low, high] = [...borders].sort((one, other) => one.middle[1] - other.middle[1]);
  assert.deepEqual(sorted(low.vertices), [2, 3, 4, 5, 6, 7, 8, 9]);
  assert.deepEqual(sorted(high.vertices), [18, 19, 20, 21, 22, 23, 24, 25]);
  // all round in order: each is a neighbour of the one before
  for (const [i, vertex] of high.vertices.entries()) {
    const steps = (high.vertices[(i + 1) % 8] - vertex + 8) % 8;
    assert.ok(steps === 1 || steps === 7, `${high.vertices}`);
  }
  assert.ok(Math.abs(high.middle[1] - 1.45) < 1e-12);
  assert.deepEqual(ends[1], sorted(high.vertices));
  assert.deepEqual(box[1][1], 1.45);
  // eight sides of an ellipse, half-axes 0.24 and 0.18, round a height of 0.55
  const corner = (i) => [0.24 * Math.cos((Math.PI * i) / 4), 0.18 * Math.sin((Math.PI * i) / 4)];
  const round = Array.from({ length: 8 }, (_, i) => {
    const [[x, z], [u, w]] = [corner(i), corner(i + 1)];
    return Math.hypot(u - x, w - z);
  }).reduce((sum, length) => sum + length);
  assert.ok(Math.abs(area - 0.55 * round) < 2e-3 * area, `${area}`); // the file has three digits
  assert.ok(edge > 0.1 && edge < 0.4 && none === 0);
  // of glTF the nodes; one that holds all of the file, and a mesh that a node has told already, are no parts
  const gltf = await client.request("mesh.upload", { name: "two.gltf", obj: JSON.stringify(twoNodes()) });
  assert.deepEqual(
    gltf.nodes.map(({ node, vertices, box: [from] }) => [node, vertices, from]),
    [
      ["shirt", 3, [0, 0, 0]],
      ["body", 4, [3, 0, 1]],
    ],
  );
  // many vertices are told by some of them, evenly chosen
  const fine = await client.request("mesh.upload", { name: "fine.obj", obj: tube({ around: 200, rows: 2 }) });
  assert.equal(fine.borders[0].vertices.length, 64);
  await client.close();
});

test("an upload is mended, which its answer and a notice tell, and is strict where the scene wants it so", async () => {
  const client = await enter();
  const told = ["1 triangle is there already and was left out: line 6"];
  const { notes } = await client.request("mesh.upload", { name: "twice", obj: `${square}f 4 2 1\n` });
  assert.deepEqual(notes, told);
  const cloth = (mesh) => [{ op: "replace", path: "/cloths/0", value: { name: "cloth", mesh } }];
  const notice = client.notification("notice", ({ text }) => text === `/cloths/0/mesh: twice: ${told[0]}`);
  await client.request("scene.patch", { patch: cloth({ file: "twice" }) });
  await notice;
  const { data } = await client.refusal("scene.patch", { patch: cloth({ file: "twice", mend: false }) });
  assert.equal(data.path, "/cloths/0/mesh/file");
  assert.match(data.found, /twice, line 6: a triangle at the same place as that of line 5/);
  const parts = `o a\n${square}o b\nf 1 2 3\no c\nf 1 3 4\n`;
  await client.request("mesh.upload", { name: "parts", obj: parts });
  await client.request("scene.patch", { patch: cloth({ file: "parts", node: "b" }) });
  assert.equal((await client.request("scene.get")).document.cloths[0].mesh.node, "b");
  await client.close();
});

test("a mesh that the scene names can be replaced, and is not if its pins do not fit", async () => {
  const client = await enter();
  await client.request("mesh.upload", { name: "a", obj: leaf });
  await client.request("scene.patch", { patch: named("a") });
  const scene = client.nextNotification("scene");
  await client.request("mesh.upload", { name: "a", obj: square });
  await scene;
  const { data } = await client.refusal("mesh.upload", { name: "a", obj: "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" });
  assert.equal(data.path, "/cloths/0/pins/0/at");
  await client.request("scene.patch", { patch: { gravity: [0, -1, 0] } }); // the mesh before is still there
  await client.close();
});

test("an upload may have 8 MiB, other messages and other clients' may not", async () => {
  const comment = (bytes) => `#${"x".repeat(98)}\n`.repeat(bytes / 100);
  const client = await enter();
  const { vertices } = await client.request("mesh.upload", { name: "a", obj: square + comment(6 << 20) });
  assert.equal(vertices, 4);
  for (const [method, params] of [
    ["mesh.upload", { name: "a", obj: square + comment(9 << 20) }],
    ["ping", { t: "x".repeat(100_000) }],
    ["ping", { "mesh.upload": "mesh.upload", t: "x".repeat(100_000) }],
  ]) {
    const bold = await enter();
    bold.send(JSON.stringify({ jsonrpc: "2.0", id: 1, method, params }));
    assert.equal((await bold.closed).code, 1009, method);
  }
  await client.request("ping", {});
  await client.close();
});

test("uploads are there again after a restart with --state-dir", async () => {
  const state = join(folder, "state");
  const first = await Server.start("--state-dir", state);
  const client = await Client.connect(first, { session: "kept" });
  await client.notification("scene");
  await client.request("mesh.upload", { name: "my shirt", obj: square });
  await client.request("scene.patch", { patch: named("my shirt") });
  await client.close();
  await first.stop();
  const second = await Server.start("--state-dir", state);
  const again = await Client.connect(second, { session: "kept" });
  const { document } = await again.notification("scene");
  assert.equal(document.cloths[0].mesh.obj, "my shirt");
  await again.close();
  await second.stop();
});
