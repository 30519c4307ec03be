import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { Client, Server } from "./harness.mjs";

let server, client;
before(async () => (server = await Server.start("--scene", "seed", "--set", "/gravity/1=-5")));
after(() => server.stop());
beforeEach(async () => {
  client = await Client.connect(server);
  await client.notification("scene");
  await client.request("scene.load", { preset: "seed" });
});
afterEach(() => client.close());

test("serve starts with the scene and the values of its command line", async () => {
  const other = await Client.connect(server, { session: "fresh" });
  const { document } = await other.notification("scene");
  assert.deepEqual(document.gravity, [0, -5, 0]);
  await other.close();
});

test("scene.get answers the document and its revision", async () => {
  const { document, revision } = await client.request("scene.get");
  assert.equal(document.name, "seed");
  assert.equal(document.cloths[0].material.structural, 20000);
  assert.ok(revision >= 1);
});

test("scene.presets lists the presets of the contract, the seed first", async () => {
  const { presets, about } = await client.request("scene.presets");
  assert.equal(presets[0], "seed");
  assert.deepEqual(Object.keys(about).sort(), [...presets].sort(), "each has its sentence");
  for (const name of [
    "flag",
    "curtain",
    "tablecloth",
    "drape",
    "twist",
    "hanging-strip",
    "cantilever",
    "trampoline",
    "fabrics",
    "skirt",
    "poncho",
    "mannequin",
    "knot",
    "funnel",
    "stack",
    "tablecloth-pull",
    "blowup",
  ])
    assert.ok(presets.includes(name), name);
});

test("scene.presets lists the fabrics, with what each is like and where its numbers are from", async () => {
  const { fabrics } = await client.request("scene.presets");
  assert.ok(fabrics.some(({ name }) => name === "cotton") && fabrics.some(({ name }) => name === "interlock"));
  for (const { name, feel, source } of fabrics) assert.ok(/^[a-z]+$/.test(name) && feel && source, name);
});

test("the name of a fabric is kept in the document, and sim.status has the numbers that are left to it", async () => {
  const { document } = await client.request("scene.get");
  const own = { material: document.cloths[0].material, mass: document.cloths[0].mass };
  const patched = async (...patch) => {
    await client.request("scene.patch", { patch });
    const shear = ({ solver }) => solver.from_fabrics[0]?.material.shear;
    return { shear, after: (is) => client.nextNotification("sim.status", (status) => is(shear(status))) };
  };
  const fabric = (name) => ({ op: "add", path: "/cloths/0/material/fabric", value: name });
  await (
    await patched(
      { op: "replace", path: "/cloths/0/material", value: { model: "springs", fabric: "cotton", bend: 0 } },
      { op: "remove", path: "/cloths/0/mass" },
    )
  ).after((shear) => shear === 97);
  await (await patched(fabric("silk"))).after((shear) => shear === 51);
  const { document: named } = await client.request("scene.get");
  assert.deepEqual(named.cloths[0].material, { model: "springs", fabric: "silk", bend: 0, strain_limit: null });
  assert.equal("mass" in named.cloths[0], false);
  const refusal = await client.request("scene.patch", { patch: [fabric("slik")] }).catch((error) => error);
  assert.equal(refusal.data.path, "/cloths/0/material/fabric");
  assert.match(refusal.data.allowed, /did you mean "silk"/);
  await client.request("scene.patch", {
    patch: [
      { op: "replace", path: "/cloths/0/material", value: own.material },
      { op: "add", path: "/cloths/0/mass", value: own.mass },
    ],
  });
});

test("a merge patch changes the scene and raises the revision by one", async () => {
  const before = await client.request("scene.get");
  const changed = client.nextNotification("scene.changed");
  const patch = { gravity: [0, -1.5, 0], solver: { dt: 0.0005 } };
  const answer = await client.request("scene.patch", { patch });
  assert.equal(answer.revision, before.revision + 1);
  assert.equal(answer.applies, "uniform");
  const hello = await client.notification("hello");
  assert.deepEqual(await changed, { revision: answer.revision, patch, by: hello.client });
  const after = await client.request("scene.get");
  assert.equal(after.revision, answer.revision);
  assert.deepEqual(after.document, {
    ...before.document,
    gravity: [0, -1.5, 0],
    solver: { ...before.document.solver, dt: 0.0005 },
  });
});

test("a JSON patch (RFC 6902) changes the scene, echoed as it was given", async () => {
  const changed = client.nextNotification("scene.changed");
  const patch = [
    { op: "test", path: "/name", value: "seed" },
    { op: "replace", path: "/cloths/0/material/damping", value: 1 },
  ];
  await client.request("scene.patch", { patch });
  assert.deepEqual((await changed).patch, patch);
  assert.equal((await client.request("scene.get")).document.cloths[0].material.damping, 1);
});

test("a patch says how deep it cuts, and only a rebuilt cloth resets time", async () => {
  const apply = async (patch) => (await client.request("scene.patch", { patch })).applies;
  await client.request("sim.step", { steps: 5 });
  const at = async () => (await client.request("sim.pause")).step;
  const step = await at();
  assert.ok(step >= 5);
  assert.equal(await apply({}), "none");
  assert.equal(await apply({ gravity: [0, -2, 0] }), "uniform");
  assert.equal(await apply({ self_collision: null }), "kernel");
  assert.equal(await at(), step);
  const notice = client.nextNotification("notice");
  assert.equal(
    await apply([
      { op: "replace", path: "/cloths/0/mesh/grid/columns", value: 30 },
      { op: "replace", path: "/cloths/0/pins", value: [] },
    ]),
    "cloth",
  );
  assert.equal(await at(), 0);
  assert.match((await notice).text, /rebuilt/);
  // another scene has another cloth: nobody needs to be told
  const { document: other } = await client.request("scene.get");
  other.cloths[0].mesh.grid.columns = 12;
  const seen = client.messages.length;
  assert.equal(await apply([{ op: "replace", path: "", value: other }]), "cloth");
  await client.statuses(2);
  const notices = client.messages.slice(seen).filter(({ method }) => method === "notice");
  assert.deepEqual(notices, []);
});

test("an invalid patch answers -32602 with the scene's pointer and changes nothing", async () => {
  const before = await client.request("scene.get");
  const cases = [
    [{ solver: { dt: -1 } }, "/solver/dt"],
    [{ solver: { dt: "x" } }, "/solver/dt"],
    [{ bogus: 1 }, "/bogus"],
    [{ colliders: [{ name: "b", sphere: { center: [0, 0, 0], radius: -1 } }] }, "/colliders/0/sphere/radius"],
    [[{ op: "replace", path: "/solver/dt", value: null }], "/solver/dt"],
    [[{ op: "replace", path: "/cloths/0/pins/0/at", value: "corner:99,0" }], "/cloths/0/pins/0/at"],
  ];
  for (const [patch, path] of cases) {
    const error = await client.refusal("scene.patch", { patch });
    assert.equal(error.code, -32602, JSON.stringify(patch));
    assert.equal(error.data.path, path);
    assert.ok(error.data.found.length > 0 && error.data.allowed.length > 0);
  }
  assert.deepEqual(await client.request("scene.get"), before);
});

test("a patch for a revision that is past answers -32003 with the current one", async () => {
  const { revision } = await client.request("scene.get");
  const patch = { gravity: [0, -3, 0] };
  await client.request("scene.patch", { patch, revision });
  const error = await client.refusal("scene.patch", { patch, revision });
  assert.equal(error.code, -32003);
  assert.deepEqual(error.data, { revision: revision + 1 });
});

test("scene.load takes a preset, and everybody gets the whole scene", async () => {
  const scene = client.nextNotification("scene", ({ document }) => document.name === "curtain");
  const answer = await client.request("scene.load", { preset: "curtain" });
  assert.equal(answer.applies, "cloth");
  assert.equal((await scene).document.name, "curtain");
  assert.equal((await scene).revision, answer.revision);
});

test("scene.load takes a scene of one's own, at time 0", async () => {
  const { document } = await client.request("scene.get");
  await client.request("sim.step", { steps: 3 });
  await client.request("scene.load", { scene: { ...document, name: "mine" } });
  assert.equal((await client.request("sim.pause")).step, 0);
  assert.equal((await client.request("scene.get")).document.name, "mine");
  const error = await client.refusal("scene.load", { scene: { ...document, version: 2 } });
  assert.equal(error.code, -32602);
  assert.equal(error.data.path, "/version");
});

test("a contact distance that crowds the neighbour lists is told by a notice", async () => {
  const notice = client.nextNotification("notice", ({ text }) => /self-collision/.test(text));
  await client.request("scene.patch", { patch: { self_collision: { thickness: 0.5 } } });
  await client.request("sim.play"); // the lists are built by the next step
  const { level, text } = await notice;
  assert.equal(level, "warning");
  assert.match(text, /thickness/);
});

test("a self-collision too thin for the mesh is told by a notice once, and what would hold with every status", async () => {
  const cloths = [{ mesh: { grid: { columns: 11, rows: 11, width: 0.5, height: 0.5 } } }];
  await client.request("scene.load", { scene: { version: 1, cloths, self_collision: { thickness: 0.045 } } });
  const { solver } = await client.nextNotification(
    "sim.status",
    (status) => status.solver.thickness_that_holds !== null,
  );
  assert.ok(Math.abs(solver.thickness_that_holds / 0.05 - 0.8485) < 0.001, "of the spacing");
  const before = client.messages.length;
  const notice = client.nextNotification("notice", ({ text }) => /too thin/.test(text));
  await client.request("scene.patch", { patch: { self_collision: { thickness: 0.02 } } });
  assert.match((await notice).text, /0\.02 m .*0\.0424 m/);
  await client.request("scene.patch", { patch: { self_collision: { thickness: 0.01 } } });
  await client.request("scene.patch", { patch: { self_collision: null } });
  await client.nextNotification("sim.status", (status) => status.solver.thickness_that_holds === null);
  assert.equal(
    client.messages.slice(before).filter((m) => m.method === "notice" && /too thin/.test(m.params.text)).length,
    1,
  );
});

test("a strain limit that the pins leave no room for is told by a notice", async () => {
  const notice = client.nextNotification("notice", ({ text }) => /strain_limit/.test(text));
  const cloths = [
    {
      mesh: { grid: { columns: 3, rows: 3 } },
      material: { strain_limit: 0.01 },
      pins: [{ at: "corner:0,0" }, { at: "corner:2,0", motion: { linear: { velocity: [0.2, 0, 0] } } }],
    },
  ];
  await client.request("scene.load", { scene: { version: 1, cloths } });
  await client.request("sim.play");
  assert.equal((await notice).level, "warning");
});

test("a scene of surfaces that starts with crossings is refused, with the pairs; the running one stays as it is", async () => {
  await client.request("scene.load", { preset: "fabrics" }); // cotton's border lies on silk's
  const before = (await client.request("scene.get")).revision;
  const error = await client.refusal("scene.patch", { patch: { self_collision: { kind: "surface" } } });
  assert.equal(error.code, -32602);
  assert.equal(error.data.path, "/self_collision/kind");
  assert.match(
    error.data.found,
    /^"surface", but the start has \d+ crossings: edge \d+-\d+ of \/cloths\/0 \("cotton"\) meets/,
  );
  assert.match(error.data.allowed, /^"points"/);
  const { when, count, complete, pairs } = error.data.crossings;
  assert.deepEqual([when, complete, pairs.length], ["start", true, Math.min(count, 64)]);
  const { document } = await client.request("scene.get");
  for (const { edge, triangle, place } of pairs) {
    assert.deepEqual([edge.vertices.length, triangle.vertices.length], [edge.at.length, triangle.at.length]);
    for (const { cloth, name } of [edge, triangle]) assert.equal(name, document.cloths[cloth].name);
    // The place is on the edge: as far from its ends, together, as these are from each other.
    const far = (a, b) => Math.hypot(...a.map((x, axis) => x - b[axis]));
    const [p, q] = edge.at;
    assert.ok(Math.abs(far(p, place) + far(place, q) - far(p, q)) < 1e-6, "within the rounding of floats near 1 m");
  }
  const [{ edge }] = pairs;
  const words = `edge ${edge.vertices.join("-")} of /cloths/${edge.cloth} ("${edge.name}") meets triangle`;
  assert.ok(error.data.found.includes(words), "the first pair is the one that the text names first");
  assert.equal((await client.request("scene.get")).revision, before);
  await client.request("scene.patch", { patch: { self_collision: { kind: "points" } } });
});

test("a patch that keeps the cloth stable changes the solver where it must, for everybody, and undo takes both back", async () => {
  const other = await Client.connect(server);
  await other.notification("scene");
  const { solver } = (await client.request("scene.get")).document;
  const fabric = (name) => ({ cloths: [{ mesh: { grid: {} }, material: { fabric: name, model: "springs" } }] });
  const operations = (name) => [
    { op: "replace", path: "/cloths/0/material", value: { fabric: name, model: "springs" } },
    { op: "remove", path: "/cloths/0/mass" },
  ];
  for (const patch of [operations("cotton"), fabric("denim")]) {
    const answer = await client.request("scene.patch", { patch, keep_stable: true });
    const { document } = await client.request("scene.get");
    assert.deepEqual(document.solver, answer.solver);
    assert.equal(document.solver.method, "implicit_euler");
    const told = await other.notification("scene.changed", ({ revision }) => revision === answer.revision);
    const values = Array.isArray(told.patch)
      ? Object.fromEntries(told.patch.map(({ path, value }) => [path.replace("/solver/", ""), value]))
      : told.patch.solver;
    for (const [key, value] of Object.entries(answer.solver)) assert.equal(values[key], value);
    await client.request("scene.undo");
    const back = (await client.request("scene.get")).document;
    assert.deepEqual([back.solver, back.cloths[0].material.fabric], [solver, undefined]);
  }
  // a little beyond the limit: the same method with a shorter step; within it, and unasked: as it is
  const stiffer = (factor) => ({ path: "/cloths/0/material/structural", op: "replace", value: 20000 * factor });
  const kept = await client.request("scene.patch", { patch: [stiffer(4)], keep_stable: true });
  assert.equal(kept.solver.method, solver.method);
  assert.ok(kept.solver.dt < solver.dt && kept.solver.dt >= 0.5 * solver.dt, `dt = ${kept.solver.dt} s`);
  assert.equal((await client.request("scene.patch", { patch: [stiffer(1)], keep_stable: true })).solver, undefined);
  assert.equal((await client.request("scene.patch", { patch: operations("cotton") })).solver, undefined);
  const { data } = await client.refusal("scene.patch", { patch: {}, keep_stable: "yes" });
  assert.deepEqual([data.path, data.allowed], ["/keep_stable", "true or false"]);
  await other.close();
});
