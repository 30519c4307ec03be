// inspect.vertices: which vertex in frames each vertex of a mesh's file is.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Client, Server } from "./harness.mjs";
import { arrays } from "./inspected.mjs";
import { seamed } from "./seamed.mjs";

let server;
before(async () => (server = await Server.start()));
after(() => server.stop());

const none = 0xffffffff;
const sheet = seamed();
const grid = { name: "grid", mesh: { grid: { columns: 3, rows: 4, width: 0.2, height: 0.3 } } };

let sessions = 0;
/// A client on a session of its own with these cloths, paused at the start, and its frame then.
async function enter(cloths, files) {
  const client = await Client.connect(server, { session: `vertices-${++sessions}` });
  await client.notification("scene");
  await client.request("sim.pause");
  for (const [name, obj] of Object.entries(files)) await client.request("mesh.upload", { name, obj });
  await client.request("scene.load", { scene: { version: 1, name: "numbered", cloths } });
  await client.request("stream.subscribe", { encoding: "f32", rate: 120, in_flight: 8 });
  return { client, start: await client.frame(({ step }) => step === 0) };
}
async function numbers(client, params) {
  const answer = await client.request("inspect.vertices", params);
  return { ...answer, vertices: [...arrays(answer, { vertices: [Uint32Array, 1] }).vertices] };
}
const renumbered = async (client) => (await client.nextNotification("sim.status")).renumbered;
const apart = (a, b) => Math.hypot(...a.map((value, axis) => value - b[axis]));

for (const kind of ["obj", "gltf"])
  test(`the vertices of a file with a seam and a stray one are told as frames have them (.${kind})`, async () => {
    const file = `sheet.${kind}`;
    const pinned = sheet.numberAt(9, 12); // in the second panel, below
    const hangs = {
      name: "sheet",
      mesh: { file },
      mass: { per_vertex: 0.002 },
      material: { structural: 200, shear: 50, bend: 5, damping: 0.05 },
      pins: [{ at: `vertex:${pinned}` }],
    };
    const { client, start } = await enter([grid, hangs], { [file]: sheet[kind] });
    const first = 3 * 4; // after the grid's
    assert.equal(start.positions.length, first + sheet.vertices);
    const revision = client.topologies.at(-1).topologyRevision;
    const told = await numbers(client, { cloth: 1 });
    assert.deepEqual(
      { ...told, vertices: undefined },
      {
        topology_revision: revision,
        cloth: 1,
        total: sheet.places.length,
        first: 0,
        count: sheet.places.length,
        vertices: undefined,
      },
    );
    assert.deepEqual(
      told.vertices,
      sheet.inFrames.map((vertex) => (vertex === none ? none : first + vertex)),
    );
    told.vertices.forEach((vertex, number) => {
      if (vertex !== none) assert.ok(apart(start.positions[vertex], sheet.places[number]) < 1e-6, `vertex ${number}`);
    });
    assert.deepEqual(await renumbered(client), { topology_revision: revision, cloths: [1] });
    await client.request("sim.step", { steps: 200 });
    const { positions } = await client.frame(({ step }) => step === 200);
    const fallen = (vertex) => start.positions[vertex][1] - positions[vertex][1];
    assert.ok(Math.abs(fallen(told.vertices[pinned])) < 1e-6, "the pin holds the vertex that is told");
    assert.ok(fallen(told.vertices[sheet.numberAt(3, 3)]) > 0.01, "others fall");
    await client.close();
  });

test("of a grid, and of a file without seams, every vertex has its own number, and the status lists neither", async () => {
  const plain = { name: "plain", mesh: { file: "plain.obj" } };
  const obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n";
  const { client } = await enter([grid, plain], { "plain.obj": obj });
  const own = [...Array(12).keys()];
  assert.deepEqual((await numbers(client)).vertices, own);
  assert.deepEqual((await numbers(client, { cloth: 1 })).vertices, [12, 13, 14, 15]);
  assert.deepEqual((await renumbered(client)).cloths, []);
  assert.deepEqual((await numbers(client, { cloth: 0, first: 10 })).vertices, own.slice(10));
  assert.deepEqual((await numbers(client, { first: 100 })).vertices, []);
  const wrong = await client.refusal("inspect.vertices", { cloth: 2 });
  assert.deepEqual([wrong.code, wrong.data.path, wrong.data.found], [-32602, "/cloth", "2"]);
  assert.match(wrong.data.allowed, /cloth 0 to 1/);
  assert.equal((await client.refusal("inspect.vertices", { first: -1 })).data.path, "/first");
  await client.close();
});

test("a long list comes in several answers", async () => {
  const strays = 70_000; // more than an answer has
  const obj = `${"v 9 9 9\n".repeat(strays)}v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n`;
  const { client } = await enter([{ name: "few", mesh: { file: "few.obj" } }], { "few.obj": obj });
  const { total, count, vertices } = await numbers(client);
  assert.deepEqual([total, count], [strays + 3, 65536]);
  assert.ok(vertices.every((vertex) => vertex === none));
  const rest = await numbers(client, { first: count });
  assert.deepEqual([rest.first, rest.count], [count, strays + 3 - count]);
  assert.deepEqual(rest.vertices.slice(-4), [none, 0, 1, 2]);
  await client.close();
});
