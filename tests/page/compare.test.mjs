// The parts of a comparison that need no browser: moments and the times between them, what is drawn of them, words,
// links.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./module.mjs";

const { Moments } = await load("compare/moments");
const { frameOf } = await load("compare/pack");
const { decode } = await load("link/protocol");
const { lengthText, presentText, rowsOf, runText, sideText } = await load("compare/words");
const { linkOf, wishIn } = await load("compare/link");
const { sceneIn, besideScene } = await load("text/share");
const { faultText, Job } = await load("compare/job");
const { halves } = await load("compare/views");

const base64 = (numbers) => Buffer.from(new Float32Array(numbers).buffer).toString("base64");
const answer = (from, a, b, moving = []) => ({ from, count: a.length / 3, a: base64(a), b: base64(b), moving });

test("moments are appended in order only, and a time lies between the two around it", () => {
  const moments = new Moments(25, 1);
  moments.append(answer(0, [0, 0, 0, 1, 2, 3], [0, 0, 0, 1, 2, 5]));
  moments.append(answer(2, [3, 2, 1], [3, 2, 1]));
  assert.equal(moments.count, 3);
  assert.equal(moments.end, 0.08);
  assert.throws(() => moments.append(answer(2, [0, 0, 0], [0, 0, 0])), /do not follow 3/);
  assert.throws(() => moments.append(answer(3, [0, 0, 0], [0, 0, 0, 1, 1, 1])), /do not follow/);
  assert.deepEqual(moments.place(0.04), { index: 1, share: 0 });
  assert.deepEqual(moments.place(3 * 0.04 - 0.04), { index: 2, share: 0 }, "rounding does not miss a moment");
  assert.deepEqual([moments.place(-1).index, moments.place(9).index], [0, 2]);
  const between = moments.place(0.05);
  assert.equal(between.index, 1);
  assert.ok(Math.abs(between.share - 0.25) < 1e-9);
  assert.deepEqual([...moments.positions("a", between)], [1.5, 2, 2.5]);
  assert.deepEqual([...moments.positions("b", moments.place(0.04))], [1, 2, 5]);
});

test("what is drawn of a moment is off by at most half a step of 16 bits, with the normals of its triangles", () => {
  // a roof: two triangles that share an edge, one of them facing up, the other to +x
  const places = new Float32Array([0, 1, 0, 0, 1, 1, -2, 1, 0, 0, -1, 0]);
  const triangles = new Uint32Array([0, 2, 1, 0, 1, 3]);
  const topology = { revision: 7, vertexCount: 4, cloths: [], triangles, textureCoordinates: new Float32Array(8) };
  const frame = frameOf(places, topology, 0.04, []);
  const { header, buffer } = frame;
  assert.equal(header.topologyRevision, 7);
  const words = new Uint16Array(buffer, 64);
  for (let i = 0; i < 12; ++i) {
    const [vertex, axis] = [Math.floor(i / 3), i % 3];
    const back = header.boxMinimum[axis] + (header.boxExtent[axis] * words[4 * vertex + axis]) / 65535;
    // half a step, and the rounding of 32-bit floats
    assert.ok(Math.abs(back - places[i]) <= header.boxExtent[axis] / 65535 / 2 + 1e-6, `${i}: ${back}`);
  }
  // as the vertex shader reads it (web/src/view/shaders.ts)
  const normal = (word) => {
    const signed = [word & 255, word >> 8].map((byte) => Math.max((byte > 127 ? byte - 256 : byte) / 127, -1));
    const [x, y] = signed;
    const z = 1 - Math.abs(x) - Math.abs(y);
    const fold = Math.max(-z, 0);
    const n = [x + (x >= 0 ? -fold : fold), y + (y >= 0 ? -fold : fold), z];
    const length = Math.hypot(...n);
    return n.map((each) => each / length);
  };
  const near = (found, expected) =>
    assert.ok(Math.hypot(...found.map((x, i) => x - expected[i])) < 0.02, `${found} is not ${expected}`);
  near(normal(words[4 * 2 + 3]), [0, 1, 0]);
  near(normal(words[4 * 3 + 3]), [1, 0, 0]);
  near(normal(words[4 * 0 + 3]), [Math.SQRT1_2, Math.SQRT1_2, 0]); // both have the same area
  // the view takes it as a frame that came: the same header as the wire's
  const wire = new ArrayBuffer(64 + 32);
  const view = new DataView(wire);
  view.setUint8(0, 2);
  view.setUint8(1, 1);
  view.setUint32(12, 4, true);
  view.setUint32(56, 32, true);
  assert.deepEqual(Object.keys(header).sort(), Object.keys(decode(wire).frame.header).sort());
});

const result = {
  truth: false,
  horizon_s: null,
  a: { method: "symplectic_euler", dt_s: 0.001, iterations: null },
  b: { method: "xpbd", dt_s: 0.004, iterations: 2 },
  times_s: [0, 0.04, 0.08],
  rms_m: [0, 0.00123456, 0.0005],
  most_m: [0, 0.0345678, 0.001],
};

test("lengths are told in millimetres, small ones in micrometres, and none as exactly none", () => {
  assert.equal(lengthText(0), "0\u00a0mm");
  assert.equal(lengthText(0.0345678), "34.6\u00a0mm");
  assert.equal(lengthText(4e-6), "4\u00a0µm");
});

test("figures are told in words: each side, the present moment, the whole run", () => {
  assert.equal(sideText("A", result), "A: Symplectic Euler, dt 1\u00a0ms");
  assert.equal(sideText("B", result), "B: XPBD, dt 4\u00a0ms, 2 iterations");
  assert.match(sideText("A", { ...result, truth: true }), /the truth, in double precision/);
  assert.equal(presentText(result, 0), "At 0.00 s: A and B are the same, to the last bit.");
  assert.equal(presentText(result, 1), "At 0.04 s: A and B are 1.23\u00a0mm apart (RMS), at most 34.6\u00a0mm.");
  assert.match(presentText({ ...result, horizon_s: 0.05 }, 2), /Beyond the horizon/);
  assert.doesNotMatch(presentText({ ...result, horizon_s: 0.05 }, 1), /horizon/);
  assert.equal(presentText(result, 3), "");
  assert.match(runText(result), /Up to 0.08 s they are at most 34.6\u00a0mm apart, at 0.04 s; at the end 0.5\u00a0mm/);
  assert.match(runText({ ...result, most_m: [0, 0, 0] }), /never differ/);
});

test("the table has the first and the last moment and not more than 27 rows", () => {
  for (const count of [1, 2, 26, 27, 126, 1501]) {
    const rows = rowsOf(count);
    assert.ok(rows.length <= 27, `${count}: ${rows.length}`);
    assert.deepEqual([rows[0], rows.at(-1)], [0, count - 1]);
    assert.equal(new Set(rows).size, rows.length);
  }
  assert.deepEqual(rowsOf(0), []);
});

test("a link carries the scene and the comparison, and says what is wrong with one that does not", async () => {
  const scene = { name: "seed", cloths: [{ name: "cloth" }] };
  const wish = { patch: [{ op: "replace", path: "/solver/dt", value: 0.002 }], truth: true, time: 3, view: "ghost" };
  const link = await linkOf(scene, wish);
  assert.match(link, /^#scene=[\w-]+&compare=[\w-]+$/);
  assert.deepEqual(await sceneIn(link, 65536), scene);
  const rest = besideScene(link);
  assert.match(rest, /^#compare=/);
  assert.deepEqual(await wishIn(rest, 65536), wish);
  assert.equal(besideScene("#scene=abc"), "");
  await assert.rejects(wishIn(rest.slice(0, -6), 65536), /damaged/);
  await assert.rejects(wishIn(rest, 20), /more than the 20 bytes/);
  const other = await linkOf(scene, { truth: true });
  await assert.rejects(wishIn(besideScene(other), 65536), /no comparison/);
});

test("a refusal says where, what was found, and what is allowed or to be done", () => {
  assert.equal(
    faultText({ path: "truth", found: "there is none for this scene: it is chaotic", allowed: "compare with present" }),
    "No truth: there is none for this scene: it is chaotic. Allowed, or what to do: Compare with present.",
  );
  assert.equal(faultText({ path: "/solver/dt", found: "-1", allowed: "above 0" }).slice(0, 15), "/solver/dt: -1.");
});

test("the parts of an area lie side by side where it is wide, one above the other where it is high", () => {
  assert.deepEqual(halves({ left: 100, top: 10, width: 800, height: 600 }), [
    { left: 100, top: 10, width: 400, height: 600 },
    { left: 500, top: 10, width: 400, height: 600 },
  ]);
  assert.deepEqual(halves({ left: 0, top: 10, width: 300, height: 400 })[1], {
    left: 0,
    top: 210,
    width: 300,
    height: 200,
  });
});

/// A lab that answers when it is told to.
function lab() {
  const asked = [];
  const here = {
    asked,
    request: (method, params) =>
      new Promise((resolve, reject) => asked.push({ method, params, resolve, reject: (e) => reject(e) })),
    changed: () => undefined,
  };
  return { here, asked };
}
const settle = () => new Promise((resolve) => setImmediate(resolve));
const told = (job, state, count) => ({
  job,
  state,
  result: { ...result, rate: 25, vertices: 1, times_s: result.times_s.slice(0, count) },
});

test("a comparison shows the figures of the moments that are here, and ends with the last of them", async () => {
  const { here, asked } = lab();
  const job = new Job(here);
  job.start({ patch: [], truth: false, time: 1 });
  job.told("result", told(4, "running", 2)); // before the answer that names the job
  job.told("result", told(3, "finished", 1)); // another one's
  assert.equal(job.result, null);
  asked[0].resolve({ job: 4, ahead: 0 });
  await settle();
  assert.deepEqual(asked[1].params, { job: 4, from: 0 });
  asked[1].resolve(answer(0, [0, 0, 0], [0, 0, 0]));
  await settle();
  assert.deepEqual([job.result.times_s.length, job.working], [1, true]);
  asked[2].resolve(answer(1, [0, 0, 0], [0, 0, 0]));
  await settle();
  job.told("result", told(4, "finished", 3));
  await settle();
  assert.deepEqual([asked[3].params.from, job.working], [2, true]);
  asked[3].resolve(answer(2, [0, 0, 0], [0, 0, 0]));
  await settle();
  assert.deepEqual([job.result.times_s.length, job.working, asked.length], [3, false, 4]);
});

test("one that was forgotten before the lab had answered is cancelled with the answer", async () => {
  const { here, asked } = lab();
  const job = new Job(here);
  job.start({ patch: [], truth: false, time: 1 });
  job.forget();
  asked[0].resolve({ job: 9, ahead: 2 });
  await settle();
  assert.deepEqual([asked[1].method, asked[1].params], ["lab.cancel", { job: 9 }]);
  assert.equal(job.working, false);
});

test("a lost connection ends it, and what it has found stays", async () => {
  const { here, asked } = lab();
  const job = new Job(here);
  job.start({ patch: [], truth: false, time: 1 });
  asked[0].resolve({ job: 4, ahead: 0 });
  await settle();
  job.told("result", told(4, "running", 1));
  asked[1].resolve(answer(0, [0, 0, 0], [0, 0, 0]));
  await settle();
  job.lost();
  assert.equal(job.working, false);
  assert.match(job.wrong, /connection was lost/);
  assert.equal(job.result.times_s.length, 1);
});
