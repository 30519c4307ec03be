// Colliders that are meshes: loaded, patched, uploaded, refused with the pairs, and read by a page or a script.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Client, Server } from "./harness.mjs";

let server;
before(async () => {
  server = await Server.start("--max-sessions", "16");
});
after(() => server.stop());

/// A pyramid of four sides 0.2 m wide and high, its base at y = 0; its first vertex is part of no face.
const vertices = [
  [7, 7, 7],
  [-0.1, 0, -0.1],
  [0.1, 0, -0.1],
  [0.1, 0, 0.1],
  [-0.1, 0, 0.1],
  [0, 0.2, 0],
];
const triangles = [
  [1, 2, 3],
  [1, 3, 4],
  [1, 5, 2],
  [2, 5, 3],
  [3, 5, 4],
  [4, 5, 1],
];
const obj = [
  ...vertices.map((v) => `v ${v.join(" ")}`),
  ...triangles.map((t) => `f ${t.map((corner) => corner + 1).join(" ")}`),
].join("\n");
const cloth = { name: "scarf", mesh: { grid: { columns: 5, rows: 5 } }, transform: { translate: [0, 1, -0.5] } };
const body = { name: "tent", mesh: { vertices, triangles }, friction: 0.4 };
const scene = { version: 1, name: "bodies", cloths: [cloth], colliders: [body] };

let sessions = 0;
async function enter() {
  const client = await Client.connect(server, { session: `body-${++sessions}` });
  await client.request("scene.load", { scene });
  return client;
}
const session = () => `session=body-${sessions}`;

/// The vertices and triangles of a binary PLY file of floats.
function readPly(bytes) {
  const end = bytes.indexOf("end_header\n") + "end_header\n".length;
  const head = bytes.subarray(0, end).toString("latin1");
  const [points, faces] = [/element vertex (\d+)/, /element face (\d+)/].map((of) => Number(of.exec(head)[1]));
  assert.equal(bytes.length, end + 12 * points + 13 * faces);
  const three = (read) => [0, 1, 2].map(read);
  return {
    vertices: Array.from({ length: points }, (_, i) => three((k) => bytes.readFloatLE(end + 12 * i + 4 * k))),
    triangles: Array.from({ length: faces }, (_, i) =>
      three((k) => bytes.readUInt32LE(end + 12 * points + 13 * i + 1 + 4 * k)),
    ),
  };
}

test("a scene has a mesh as a collider, whose place and motion are patched; a new place starts time again", async () => {
  const client = await enter();
  const { document } = await client.request("scene.get");
  assert.deepEqual(document.colliders[0].mesh, { ...body.mesh, mend: true });
  assert.deepEqual(document.colliders[0].transform, { translate: [0, 0, 0], rotate: [0, 0, 0], scale: 1 });
  const { step } = await client.request("sim.step", { steps: 3 });
  assert.ok(step >= 3);
  const patch = (op) => client.request("scene.patch", { patch: [{ op: "replace", ...op }] });
  assert.equal((await patch({ path: "/colliders/0/friction", value: 0.1 })).applies, "uniform");
  assert.equal((await client.request("sim.pause")).step, step);
  assert.equal((await patch({ path: "/colliders/0/transform/translate/0", value: 0.3 })).applies, "cloth");
  assert.equal((await client.request("sim.pause")).step, 0);
  await client.request("sim.step", { steps: 3 });
  const removed = await client.request("scene.patch", { patch: [{ op: "remove", path: "/colliders/0" }] });
  assert.equal(removed.applies, "kernel");
  assert.equal((await client.request("sim.pause")).step, 3);
  await client.close();
});

test("cloth that starts through a collider's mesh is refused with the pairs, and nothing changes", async () => {
  const client = await enter();
  const before = await client.request("scene.get");
  const patch = { cloths: [{ ...cloth, transform: { translate: [0, 0.15, -0.5] } }] };
  const { code, data } = await client.refusal("scene.patch", { patch });
  assert.equal(code, -32602);
  assert.equal(data.path, "/colliders/0");
  assert.match(data.found, /edge .* of .* meets triangle .* of/);
  const { when, count, complete, pairs } = data.crossings;
  assert.deepEqual([when, complete, pairs.length], ["start", true, count]);
  for (const { edge, triangle } of pairs) {
    const parts = [edge, triangle].map(({ cloth, collider, name }) => [cloth, collider, name]);
    parts.sort(([a], [b]) => (a === undefined) - (b === undefined));
    assert.deepEqual(parts, [
      [0, undefined, "scarf"],
      [undefined, 0, "tent"],
    ]);
    for (const part of [edge, triangle])
      if (part.collider === 0)
        part.vertices.forEach((vertex, i) =>
          part.at[i].forEach((x, axis) => assert.ok(Math.abs(x - vertices[vertex][axis]) < 1e-6)),
        );
  }
  const small = { mesh: { grid: { columns: 2, rows: 2, width: 0.01, height: 0.01 } } };
  const inside = await client.refusal("scene.patch", {
    patch: { cloths: [{ ...small, transform: { translate: [0, 0.05, 0] } }] },
  });
  assert.equal(inside.data.path, "/colliders/0");
  assert.match(inside.data.found, /inside it vertex 0 of/);
  assert.deepEqual(await client.request("scene.get"), before);
  await client.close();
});

test("a collider names an uploaded mesh, which can be replaced, and whose triangles any reader gets", async () => {
  const client = await enter();
  await client.request("mesh.upload", { name: "tent", obj });
  const named = { patch: [{ op: "replace", path: "/colliders/0/mesh", value: { obj: "tent" } }] };
  await client.request("scene.patch", named);
  assert.deepEqual((await client.request("scene.get")).document.colliders[0].mesh, {
    obj: "tent",
    node: null,
    mend: true,
  });
  const path = `/api/collider.ply?${session()}&name=tent`;
  const { status, headers, body: bytes } = await server.get(path);
  assert.equal(status, 200);
  assert.equal(headers["content-type"], "application/octet-stream");
  const mesh = readPly(bytes);
  assert.deepEqual(
    mesh.vertices,
    vertices.slice(1).map((v) => v.map(Math.fround)),
  );
  assert.deepEqual(
    mesh.triangles,
    triangles.map((t) => t.map((corner) => corner - 1)),
  );
  const told = client.nextNotification("scene");
  await client.request("mesh.upload", { name: "tent", obj: obj.replace("v 0 0.2 0", "v 0 0.3 0") });
  await told;
  assert.deepEqual(readPly((await server.get(path)).body).vertices[4], [0, Math.fround(0.3), 0]);
  // One that reaches the cloth is refused, and the one before stays.
  const { data } = await client.refusal("mesh.upload", { name: "tent", obj: obj.replace("v 0 0.2 0", "v 0 2 0") });
  assert.equal(data.path, "/colliders/0");
  assert.deepEqual(readPly((await server.get(path)).body).vertices[4], [0, Math.fround(0.3), 0]);
  await client.close();
});

test("only a collider with a mesh has such a file", async () => {
  const client = await enter();
  await client.request("scene.patch", {
    patch: [{ op: "add", path: "/colliders/-", value: { name: "ball", sphere: { center: [0, -2, 0], radius: 1 } } }],
  });
  for (const query of [`${session()}&name=ball`, `${session()}&name=none`, session(), "session=none&name=tent"])
    assert.equal((await server.get(`/api/collider.ply?${query}`)).status, 404, query);
  await client.close();
});
