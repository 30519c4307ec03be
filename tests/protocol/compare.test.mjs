// Two settings of a scene stepped together by the lab: their distance is that of the positions that `clothlab run`
// writes for each, whatever their steps; what cannot be compared is refused with the reason.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { thoroughTest } from "../thorough.mjs";
import { Client, Server } from "./harness.mjs";
import { strip as stripOf } from "./strip.mjs";

const program = process.env.CLOTHLAB;
const strip = stripOf();
let server, folder;
before(async () => {
  server = await Server.start("--max-sessions", "32");
  folder = mkdtempSync(join(tmpdir(), "clothlab-compare-"));
});
after(async () => {
  await server.stop();
  rmSync(folder, { recursive: true });
});

let sessions = 0;
async function enter(scene = strip) {
  const client = await Client.connect(server, { session: `compare-${++sessions}` });
  await client.notification("scene");
  await client.request("sim.pause");
  await client.request("scene.load", { scene });
  client.scene = (await client.request("scene.get")).document;
  return client;
}
async function compare(client, params) {
  const { job } = await client.request("lab.compare", params);
  return client.labResult(job);
}
/// Why the lab refuses to compare.
async function refusal(client, params) {
  const { state, error, result } = await compare(client, params);
  assert.equal(state, "failed", JSON.stringify(params));
  assert.equal(result, null);
  return error;
}
const numbers = (base64) => {
  const bytes = Buffer.from(base64, "base64");
  return new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
};
/// All moments of a comparison, each side as a list of [vertex][3] in one array.
async function moments(client, job) {
  const all = { a: [], b: [], moving: [] };
  for (;;) {
    const { count, a, b, moving, from } = await client.request("lab.moments", { job, from: all.a.length });
    assert.equal(from, all.a.length);
    if (count === 0) return all;
    for (const [side, text] of [
      ["a", a],
      ["b", b],
    ]) {
      const together = numbers(text);
      for (let i = 0; i < count; ++i)
        all[side].push(together.subarray((i * together.length) / count, ((i + 1) * together.length) / count));
    }
    all.moving.push(...moving);
  }
}
/// The positions that the command line writes every `every` seconds.
function run(scene, time, every, settings) {
  const file = join(folder, "scene.json");
  const out = join(folder, "out.pc2");
  writeFileSync(file, JSON.stringify(scene));
  const sets = settings.flatMap((setting) => ["--set", setting]);
  execFileSync(program, ["run", file, "--time", `${time}`, "--every", `${every}`, "--out", out, ...sets], {
    stdio: "ignore",
  });
  const bytes = readFileSync(out);
  const [points, samples] = [bytes.readInt32LE(16), bytes.readInt32LE(28)];
  return Array.from(
    { length: samples },
    (_, k) =>
      new Float32Array(
        bytes.buffer.slice(bytes.byteOffset + 32 + 12 * points * k, bytes.byteOffset + 32 + 12 * points * (k + 1)),
      ),
  );
}
function apart(a, b) {
  let [squares, most] = [0, 0];
  for (let i = 0; i < a.length; i += 3) {
    const square = [0, 1, 2].reduce((sum, axis) => sum + (a[i + axis] - b[i + axis]) ** 2, 0);
    squares += square;
    most = Math.max(most, Math.sqrt(square));
  }
  return { rms: Math.sqrt((3 * squares) / a.length), most };
}

test("the same settings are exactly 0 apart, bit for bit", async () => {
  const client = await enter();
  const { state, result, job } = await compare(client, { time: 1 });
  assert.equal(state, "finished");
  assert.equal(result.complete, true);
  assert.equal(result.times_s.length, 26);
  assert.deepEqual(result.times_s.slice(0, 3), [0, 0.04, 0.08]);
  assert.deepEqual(new Set([...result.rms_m, ...result.most_m]), new Set([0]));
  const { a, b, moving } = await moments(client, job);
  assert.equal(a.length, 26);
  assert.deepEqual(a, b);
  assert.notDeepEqual(a[0], a[25], "it moves");
  assert.deepEqual(new Set(moving), new Set([null]));
  await client.close();
});

test("another time step is as far away as the positions that the command line writes for both", async () => {
  const client = await enter();
  const solver = { method: "verlet", dt: 0.0005 };
  const { result, job } = await compare(client, { patch: { solver }, time: 0.4 });
  assert.deepEqual([result.a.dt_s, result.b.dt_s, result.b.method], [client.scene.solver.dt, 0.0005, "verlet"]);
  const ours = await moments(client, job);
  const theirs = {
    a: run(client.scene, 0.4, 0.04, []),
    b: run(client.scene, 0.4, 0.04, ["/solver/method=verlet", "/solver/dt=0.0005"]),
  };
  assert.equal(theirs.a.length, 11);
  for (let k = 0; k < 11; ++k) {
    // the same steps on the same device: the same bits
    assert.deepEqual(ours.a[k], theirs.a[k], `A at moment ${k}`);
    assert.deepEqual(ours.b[k], theirs.b[k], `B at moment ${k}`);
    const { rms, most } = apart(theirs.a[k], theirs.b[k]);
    // the same sum of doubles, whatever its order
    assert.ok(Math.abs(result.rms_m[k] - rms) <= 1e-12 + 1e-12 * rms, `${k}: ${result.rms_m[k]} is not ${rms}`);
    assert.ok(Math.abs(result.most_m[k] - most) <= 1e-12 + 1e-12 * most, `${k}: ${result.most_m[k]} is not ${most}`);
  }
  assert.ok(result.rms_m[10] > result.rms_m[1] && result.rms_m[1] > 0, "it grows");
  await client.close();
});

test("where no step ends at a moment, a side is on the line between the steps around it", async () => {
  const client = await enter();
  const dt = 0.0007; // 40 ms are 57.14 steps
  const { job } = await compare(client, { patch: { solver: { dt } }, time: 0.12 });
  const { b } = await moments(client, job);
  const steps = run(client.scene, 0.14, dt, [`/solver/dt=${dt}`]);
  for (let k = 1; k <= 3; ++k) {
    const at = (0.04 * k) / dt;
    const [from, to, share] = [steps[Math.floor(at)], steps[Math.ceil(at)], at - Math.floor(at)];
    for (let i = 0; i < from.length; ++i) {
      const between = from[i] + share * (to[i] - from[i]);
      // three roundings of a 32-bit float of at most 4 m
      assert.ok(Math.abs(b[k][i] - between) <= 3 * 2.4e-7, `moment ${k}: ${b[k][i]} is not ${between}`);
    }
  }
  await client.close();
});

test("several moments may lie between two steps, and each gets its own place", async () => {
  const client = await enter();
  const dt = 0.1;
  const { job } = await compare(client, { patch: { solver: { method: "implicit_euler", dt } }, time: 0.2 });
  const { b } = await moments(client, job);
  // moments at 0.04 and 0.08 are between the start and the first step: equally far from each other
  const at = (k) => b[k].at(-2);
  assert.ok(Math.abs(at(2) - at(1) - (at(1) - at(0))) < 1e-6, `${at(0)} ${at(1)} ${at(2)}`);
  assert.notEqual(at(1), at(0));
  await client.close();
});

test("the truth in A's place is nearer to a better setting, as the lab's error says", async () => {
  const client = await enter();
  const coarse = await compare(client, { truth: true, time: 0.3, patch: { solver: { method: "vbd", dt: 0.004 } } });
  assert.equal(coarse.state, "finished", JSON.stringify(coarse.error));
  assert.equal(coarse.result.truth, true);
  assert.ok(coarse.result.horizon_s > 0);
  assert.equal(coarse.result.rms_m[0], 0);
  const fine = await compare(client, { truth: true, time: 0.3, patch: { solver: { method: "rk4", dt: 0.0005 } } });
  const [worse, better] = [coarse, fine].map(({ result }) => result.rms_m.at(-1));
  // RK4 of order 4 is left with rounding; VBD of order 1 with its step
  assert.ok(better < 1e-5 && worse > 100 * better, `${better} ${worse}`);
  await client.close();
});

test("what cannot be compared is refused, with the reason and what to do", async () => {
  const client = await enter();
  const refused = (params) => refusal(client, params);
  const grid = client.scene.cloths[0].mesh.grid;
  const mesh = [{ op: "replace", path: "/cloths/0/mesh/grid/columns", value: grid.columns + 2 }];
  const other = await refused({ patch: mesh });
  assert.match(other.found, /vertices, A's/);
  assert.match(other.allowed, /leaves the cloths' meshes as they are/);
  const turned = [
    { op: "replace", path: "/cloths/0/mesh/grid/columns", value: grid.rows },
    { op: "replace", path: "/cloths/0/mesh/grid/rows", value: grid.columns },
    { op: "replace", path: "/cloths/0/pins", value: [] },
  ];
  if (grid.columns !== grid.rows) assert.match((await refused({ patch: turned })).found, /triangles between other/);
  const wrong = await refused({ patch: { solver: { dt: -1 } } });
  assert.equal(wrong.path, "/solver/dt");
  const large = structuredClone(client.scene);
  Object.assign(large.cloths[0].mesh.grid, { columns: 160, rows: 160 });
  large.cloths[0].pins = [];
  await client.request("scene.load", { scene: large });
  const long = await refused({ time: 60 });
  assert.equal(long.path, "/time");
  assert.match(long.allowed, /at most \d/);
  Object.assign(large.cloths[0].mesh.grid, { columns: 260, rows: 260 });
  await client.request("scene.load", { scene: large });
  assert.match((await refused({})).allowed, /at most 65536/);
  for (const [params, path] of [
    [{ patch: 1 }, "/patch"],
    [{ truth: 1 }, "/truth"],
    [{ time: 61 }, "/time"],
    [{ rate: 61 }, "/rate"],
    [{ rate: 2.5 }, "/rate"],
  ]) {
    const { code, data } = await client.refusal("lab.compare", params);
    assert.deepEqual([code, data.path], [-32602, path]);
  }
  await client.close();
});

thoroughTest("where there is no truth a comparison with it is refused, with the reason and what to do", async () => {
  const client = await enter();
  // so stiff and large that the reference can afford less than a fiftieth of the time
  const stiff = structuredClone(client.scene);
  Object.assign(stiff.cloths[0].mesh.grid, { columns: 200, rows: 200 });
  stiff.cloths[0].pins = [];
  Object.assign(stiff.cloths[0].material, { structural: 1e12 });
  await client.request("scene.load", { scene: stiff });
  const none = await refusal(client, { truth: true, time: 0.5 });
  assert.match(none.found, /there is none for this scene: a second of the reference takes/);
  assert.equal(none.path, "truth");
  assert.match(none.allowed, /compare with the present settings/);
  await client.close();
});

test("a side that blows up ends the comparison, with a note", async () => {
  const client = await enter();
  const { state, result } = await compare(client, { time: 5, patch: { solver: { method: "verlet", dt: 0.02 } } });
  assert.equal(state, "finished");
  assert.equal(result.complete, true);
  assert.ok(result.b.blew_up_at_s > 0 && result.a.blew_up_at_s === null);
  assert.match(result.notes.at(-1), /^B blew up after .* where the comparison ends: /);
  assert.ok(result.times_s.at(-1) < result.b.blew_up_at_s);
  await client.close();
});

test("moving colliders are told for each moment, as they are in frames", async () => {
  const scene = structuredClone(strip);
  const motion = { oscillate: { axis: [1, 0, 0], amplitude: 0.1, frequency: 1 } };
  scene.colliders = [{ name: "ball", sphere: { center: [2, -2, 0], radius: 0.2 }, motion }];
  const client = await enter(scene);
  const { job } = await compare(client, { time: 0.2 });
  const { moving } = await moments(client, job);
  for (const [k, told] of moving.entries()) {
    assert.equal(told[0].index, 0);
    const x = 2 + 0.1 * Math.sin(2 * Math.PI * 0.04 * k);
    assert.ok(Math.abs(told[0].sphere.center[0] - x) < 1e-6, `${k}: ${told[0].sphere.center[0]} is not ${x}`);
  }
  await client.close();
});

test("it makes no session, and the last comparison of a client is kept until it leaves", async () => {
  const client = await enter();
  const before = await server.metric("clothlab_sessions");
  const first = await compare(client, { time: 0.2 });
  const second = await compare(client, { time: 0.2, patch: { gravity: [0, -5, 0] } });
  assert.equal(await server.metric("clothlab_sessions"), before);
  assert.equal((await client.request("lab.moments", { job: second.job, from: 0 })).count, 6);
  assert.equal((await client.request("lab.moments", { job: second.job, from: 6 })).count, 0);
  assert.equal((await client.refusal("lab.moments", { job: second.job, from: 7 })).code, -32602);
  assert.equal((await client.refusal("lab.moments", { job: first.job, from: 0 })).code, -32602);
  const other = await enter();
  assert.equal((await other.refusal("lab.moments", { job: second.job, from: 0 })).code, -32602);
  const csv = (await client.request("lab.export", { job: second.job, format: "csv" })).text.trim().split("\n");
  assert.deepEqual([csv[0], csv.length], ["time_s,rms_m,most_m,scene_hash,device,date", 7]);
  assert.match((await client.refusal("lab.export", { job: second.job, format: "svg" })).data.allowed, /json or csv/);
  // of all clients the last four are kept
  const others = [];
  for (let i = 0; i < 4; ++i) {
    const one = await enter();
    others.push({ one, ...(await compare(one, { time: 0.08 })) });
  }
  assert.equal((await client.refusal("lab.moments", { job: second.job, from: 0 })).code, -32602);
  for (const { one, job } of others) assert.equal((await one.request("lab.moments", { job, from: 0 })).count, 3);
  for (const each of [client, other, ...others.map(({ one }) => one)]) await each.close();
});

test("a cancelled one keeps what it has found, and says that it is not complete", async () => {
  const client = await enter();
  const { job } = await client.request("lab.compare", { time: 60, patch: { solver: { dt: 0.00005 } } });
  await client.notification("lab.result", (told) => told.job === job);
  await client.request("lab.cancel", { job });
  const end = await client.labResult(job);
  assert.deepEqual([end.state, end.result.complete], ["cancelled", false]);
  assert.ok(end.result.times_s.length > 0);
  await client.close();
});
