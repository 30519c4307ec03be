// inspect.*: springs, finite elements and contacts, against what the frames of the same step say.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Client, Server } from "./harness.mjs";
import { arrays, finiteElements, nearByBruteForce, nearest, same } from "./inspected.mjs";

let server;
before(async () => (server = await Server.start("--max-sessions", "16")));
after(() => server.stop());

let sessions = 0;
/// A client on a session of its own with this scene, paused after so many steps; its frame of that moment.
async function enter(scene, steps = 0) {
  const client = await Client.connect(server, { session: `inspect-${++sessions}` });
  await client.notification("scene");
  await client.request("sim.pause");
  await client.request("scene.load", typeof scene === "string" ? { preset: scene } : { scene });
  await client.request("stream.subscribe", { encoding: "f32", rate: 120, in_flight: 8 });
  return { client, at: await stepTo(client, steps) };
}
async function stepTo(client, step) {
  const { step: now } = step > 0 ? await client.request("sim.step", { steps: step }) : { step: 0 };
  return client.frame((frame) => frame.step === now);
}
const statusAt = (client, step) => client.nextNotification("sim.status", (status) => status.step === step);

/// All pages of a list.
async function all(client, method, layout) {
  const found = Object.fromEntries(Object.keys(layout).map((key) => [key, []]));
  for (let first = 0, total = 1; first < total; ) {
    const answer = await client.request(method, { first });
    assert.equal(answer.first, first);
    ({ total } = answer);
    assert.ok(answer.count > 0 || total === 0);
    const decoded = arrays(answer, layout);
    for (const [key, values] of Object.entries(decoded)) for (const value of values) found[key].push(value);
    first += answer.count;
    if (total === 0) break;
  }
  return found;
}
const springLayout = { vertices: [Uint32Array, 2], rest_length: [Float32Array, 1], kind: [Uint8Array, 1] };
const elementLayout = { vertices: [Uint32Array, 3], shares: [Float32Array, 4] };
const count = (list, value) => list.filter((each) => each === value).length;

const floats = 2 ** -24; // the largest rounding of a float, as a share of it
const size = (positions) => Math.max(...positions.flat().map(Math.abs));
const minus = (a, b) => a.map((value, axis) => value - b[axis]);
const along = (...terms) => [0, 1, 2].map((axis) => terms.reduce((sum, [share, v]) => sum + share * v[axis], 0));

/// The largest strain of springs, computed here.
const largestOfSprings = ({ vertices, rest_length }, x) =>
  Math.max(
    ...rest_length.map((rest, i) =>
      Math.abs(Math.hypot(...minus(x[vertices[2 * i]], x[vertices[2 * i + 1]])) / rest - 1),
    ),
  );
const largestOfElements = ({ vertices, shares }, x) => {
  let most = 0;
  for (let i = 0; 3 * i < vertices.length; ++i) {
    const [a, b, c] = vertices.slice(3 * i, 3 * i + 3).map((vertex) => x[vertex]);
    const [p, q, r, s] = shares.slice(4 * i, 4 * i + 4);
    const [u, v] = [minus(b, a), minus(c, a)];
    for (const image of [along([p, u], [r, v]), along([q, u], [s, v])])
      most = Math.max(most, Math.abs(Math.hypot(...image) - 1));
  }
  return most;
};

test("a grid's springs are those of its material, with kinds and rest lengths, and strain as the server says", async () => {
  const { client, at } = await enter("seed", 700);
  const springs = await all(client, "inspect.springs", springLayout);
  assert.deepEqual(
    [0, 1, 2].map((kind) => count(springs.kind, kind)),
    [2 * 25 * 24, 2 * 24 * 24, 2 * 25 * 23],
  );
  const rest = [1 / 24, Math.SQRT2 / 24, 2 / 24];
  springs.rest_length.forEach((length, i) => assert.ok(Math.abs(length / rest[springs.kind[i]] - 1) < 2 * floats));
  const { max_strain: told } = await statusAt(client, 700);
  const error = (8 * floats * size(at.positions)) / rest[0]; // ends and rest length in floats, and their sums
  assert.ok(told > 100 * error);
  assert.ok(Math.abs(largestOfSprings(springs, at.positions) - told) < error);
  await client.request("scene.patch", { patch: { cloths: [{ ...(await cloth(client)), material: noShear }] } });
  const fewer = await all(client, "inspect.springs", springLayout);
  assert.equal(count(fewer.kind, 1), 0, "springs without stiffness are none");
  assert.equal((await client.request("inspect.elements")).total, 0);
  await client.close();
});
const cloth = async (client) => (await client.request("scene.get")).document.cloths[0];
const noShear = { model: "springs", structural: 20000, shear: 0, bend: 2000, damping: 2 };

test("finite elements have the strain that the server says", async () => {
  const { client } = await enter("seed");
  await client.request("scene.patch", {
    patch: finiteElements,
  });
  const at = await stepTo(client, 600);
  const elements = await all(client, "inspect.elements", elementLayout);
  assert.equal(elements.vertices.length, 3 * 2 * 24 * 24);
  assert.equal((await client.request("inspect.springs")).total, 0);
  const { max_strain: told } = await statusAt(client, at.step);
  const error = 16 * floats * size(at.positions) * 24 * Math.SQRT2;
  assert.ok(told > 100 * error, `${told}`);
  assert.ok(Math.abs(largestOfElements(elements, at.positions) - told) < error);
  await client.close();
});

test("of a triangle mesh the springs along edges are structural, and those across edges bend", async () => {
  const vertices = [0, 1, 2].flatMap((z) => [0, 1, 2].map((x) => [x * 0.1 + 0.01 * z, 0, z * 0.1]));
  const triangles = [0, 1, 3, 4].flatMap((i) => [
    [i, i + 3, i + 4],
    [i, i + 4, i + 1],
  ]);
  const edges = new Set(
    triangles
      .flatMap(([a, b, c]) => [
        [a, b],
        [b, c],
        [c, a],
      ])
      .map((edge) => edge.sort((v, w) => v - w).join()),
  );
  const scene = { version: 1, name: "mesh", cloths: [{ name: "mesh", mesh: { vertices, triangles } }] };
  const { client } = await enter(scene);
  const { vertices: ends, kind } = await all(client, "inspect.springs", springLayout);
  assert.ok(count(kind, 0) > 0 && count(kind, 2) > 0);
  kind.forEach((of, i) =>
    assert.equal(of === 0, edges.has([ends[2 * i], ends[2 * i + 1]].sort((v, w) => v - w).join())),
  );
  await client.close();
});

test("a long list comes in several answers; beyond its end there is nothing", async () => {
  const { client } = await enter("seed");
  const { total: few } = await client.request("inspect.springs");
  assert.deepEqual(
    await client
      .request("inspect.springs", { first: few + 5 })
      .then(({ first, count: got, vertices }) => [first, got, vertices]),
    [few, 0, ""],
  );
  const grid = { columns: 128, rows: 100, width: 1, height: 1 };
  await client.request("scene.patch", {
    patch: [
      { op: "replace", path: "/cloths/0/mesh", value: { grid } },
      { op: "replace", path: "/cloths/0/pins", value: [] },
    ],
  });
  const first = await client.request("inspect.springs");
  assert.equal(first.count, 65536);
  const springs = await all(client, "inspect.springs", springLayout);
  assert.equal(springs.rest_length.length, first.total);
  assert.equal(
    new Set(springs.rest_length.map((_, i) => `${springs.vertices[2 * i]} ${springs.vertices[2 * i + 1]}`)).size,
    first.total,
  );
  for (const params of [{ first: -1 }, { first: 0.5 }, { from: 0 }])
    assert.equal((await client.refusal("inspect.springs", params)).code, -32602);
  assert.equal((await client.refusal("inspect.contacts", { most: 4097 })).data.path, "/most");
  await client.close();
});

const sheet = (name, height, pins) => ({
  name,
  mesh: { grid: { columns: 7, rows: 7, width: 0.3, height: 0.3 } },
  transform: { translate: [0, height, height - 0.15], rotate: [0, 900 * height, 0], scale: 1 },
  mass: { per_vertex: 0.002 },
  material: { model: "springs", structural: 60, shear: 30, bend: 2, damping: 0.01 },
  pins,
});
const edges = ["edge:row:0", "edge:row:6", "edge:column:0", "edge:column:6"].map((at) => ({ at }));
/// A sheet that lies on another one, whose edges are held.
const stack = (self_collision, more = {}) => ({
  version: 1,
  name: "stack",
  cloths: [sheet("held", 0, edges), sheet("lying", 0.02, [])],
  self_collision,
  solver: { method: "symplectic_euler", dt: 0.001 },
  ...more,
});

const cases = {
  surface: [stack({ kind: "surface", thickness: 0.008 }), 200],
  points: [stack({ kind: "points", thickness: 0.03 }), 200],
  "a sphere, a plane, a capsule and a box, which move": [
    {
      ...stack(null),
      colliders: [
        {
          name: "ball",
          sphere: { center: [0, -0.105, 0], radius: 0.1 },
          motion: { oscillate: { axis: [0, 1, 0], amplitude: 0.02, frequency: 1 } },
        },
        { name: "floor", plane: { point: [0, -0.02, 0], normal: [0.1, 1, 0] } },
        { name: "rod", capsule: { a: [-0.2, -0.03, 0.09], b: [0.2, -0.03, 0.09], radius: 0.02 } },
        { name: "box", box: { center: [-0.06, -0.05, -0.08], half: [0.03, 0.04, 0.03], rotate: [0, 30, 10] } },
      ],
    },
    250,
  ],
};
for (const [name, [scene, steps]] of Object.entries(cases))
  test(`contact of ${name}: all pairs nearer than they are kept are told, as places that are theirs`, async () => {
    const { client, at } = await enter(scene, steps);
    const answer = await client.request("inspect.contacts", { most: 4096 });
    assert.deepEqual([answer.step, answer.searched, answer.count], [steps, true, answer.total]);
    const { document } = await client.request("scene.get");
    const told = nearest(answer);
    const { close, near } = nearByBruteForce(document, at.positions, client.topologies.at(-1), answer.time);
    assert.ok(close.length >= 5, `${close.length} pairs are nearer than they are kept`);
    for (const pair of close)
      assert.ok(
        told.some((one) => same(one, pair)),
        `not told: ${JSON.stringify(pair)}`,
      );
    for (const pair of told) {
      const known = near.find((one) => same(one, pair));
      assert.ok(known, `no such pair: ${JSON.stringify(pair)}`);
      const rounding = 1e-6; // of floats, a millionth of a metre
      assert.ok(Math.abs(pair.gap - known.gap) < rounding && Math.abs(pair.keep - known.keep) < rounding);
      assert.ok(pair.gap < 1.5 * pair.keep);
      assert.ok(Math.abs(Math.hypot(...minus(...pair.nearest)) - Math.abs(pair.gap)) < 4 * rounding);
      const first = pair.parts[0].map(([vertex, share]) => [share, at.positions[vertex]]);
      assert.ok(Math.hypot(...minus(along(...first), pair.nearest[0])) < rounding);
    }
    const order = told.map(({ gap, keep }) => gap / keep);
    assert.deepEqual(
      order,
      [...order].sort((a, b) => a - b),
    );
    const few = await client.request("inspect.contacts", { most: 3 });
    assert.deepEqual([few.total, few.count], [answer.total, 3]);
    assert.deepEqual(nearest(few), told.slice(0, 3));
    await client.close();
  });

test("cloth on a body of triangles: the body's vertices count after the cloths'", async () => {
  const body = {
    vertices: [
      [-1, -0.03, -1],
      [1, -0.03, -1],
      [0, -0.03, 2],
    ],
    triangles: [[0, 2, 1]],
  };
  const { client, at } = await enter(
    { ...stack(null), cloths: [sheet("lying", 0, [])], colliders: [{ name: "table", mesh: body }] },
    300,
  );
  const told = nearest(await client.request("inspect.contacts"));
  assert.ok(told.length >= 25, `${told.length} pairs`);
  for (const { kind, gap, keep, parts, nearest: places } of told) {
    assert.equal(kind, 1);
    assert.deepEqual(parts[1].map(([vertex]) => vertex).sort(), [49, 50, 51]);
    const height = at.positions[parts[0][0][0]][1] + 0.03;
    assert.ok(Math.abs(gap - height) < 1e-6 && gap < 1.5 * keep);
    assert.ok(Math.abs(places[1][1] + 0.03) < 1e-6);
  }
  await client.close();
});

test("a mesh that lies in another order in memory is told in the scene's", async () => {
  // More vertices than a cache holds, numbered without any order: the server steps them in an order of its own.
  const side = 70,
    many = side * side;
  const number = (i) => ((2741 * i) % many) + 1; // a permutation: 2741 is a prime
  const lines = [];
  for (let i = 0; i < many; ++i) lines[number(i) - 1] = `v ${(i % side) * 0.01} 0 ${Math.floor(i / side) * 0.01}`;
  for (let i = 0; i < many - side; ++i)
    if (i % side < side - 1)
      lines.push(
        `f ${number(i)} ${number(i + side)} ${number(i + 1)}`,
        `f ${number(i + 1)} ${number(i + side)} ${number(i + side + 1)}`,
      );
  const { client } = await enter("seed");
  await client.request("mesh.upload", { name: "shuffled", obj: lines.join("\n") });
  const body = {
    vertices: [
      [-1, -0.003, -1],
      [2, -0.003, -1],
      [0, -0.003, 3],
    ],
    triangles: [[0, 2, 1]],
  };
  const stands = { ...sheet("shuffled", 0, []), mesh: { obj: "shuffled" } };
  await client.request("scene.load", {
    scene: { ...stack(null), cloths: [stands], colliders: [{ name: "table", mesh: body }] },
  });
  const at = await stepTo(client, 60);
  const springs = await all(client, "inspect.springs", springLayout);
  const { max_strain: told } = await statusAt(client, 60);
  const error = (8 * floats * size(at.positions)) / 0.01;
  assert.ok(Math.abs(largestOfSprings(springs, at.positions) - told) < error);
  assert.ok(Math.min(...springs.rest_length) > 0.0099 && Math.max(...springs.rest_length) < 0.0301);
  const pairs = nearest(await client.request("inspect.contacts", { most: 4096 }));
  assert.ok(pairs.length > 1000, `${pairs.length} pairs`);
  for (const { parts, gap } of pairs) assert.ok(Math.abs(gap - (at.positions[parts[0][0][0]][1] + 0.003)) < 1e-6);
  await client.close();
});

test("before the first step nothing is searched; a reset forgets", async () => {
  const { client } = await enter(cases.surface[0]);
  const seen = async () => {
    const { searched, total } = await client.request("inspect.contacts");
    return [searched, total > 0];
  };
  assert.deepEqual(await seen(), [false, false]);
  await client.request("sim.step", { steps: 200 });
  assert.deepEqual(await seen(), [true, true]);
  await client.request("sim.reset");
  assert.deepEqual(await seen(), [false, false]);
  await client.close();
});

test("the motion is bit for bit the same, whether or not somebody looks at it", async () => {
  for (const scene of [cases.surface[0], cases.points[0]]) {
    const bytes = [];
    for (const looks of [false, true]) {
      const { client } = await enter(scene);
      const done = client.request("sim.step", { steps: 600 });
      while (
        looks &&
        !(await Promise.race([done.then(() => true), client.request("inspect.contacts").then(() => false)]))
      )
        await client.request("inspect.springs");
      await done;
      const { positions, normals } = await client.frame(({ step }) => step === 600);
      bytes.push(Buffer.from(new Float32Array([...positions, ...normals].flat()).buffer).toString("base64"));
      await client.close();
    }
    assert.equal(bytes[0], bytes[1]);
  }
});
