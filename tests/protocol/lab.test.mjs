// The lab over a socket: jobs on a small cloth, beside the session that shows it.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { thoroughTest } from "../thorough.mjs";
import { Client, Server, sleep } from "./harness.mjs";
import { strip as stripOf } from "./strip.mjs";

const strip = stripOf();
// Takes longer than any test waits: for jobs to cancel, to leave or to queue behind.
const long = {
  methods: ["explicit_euler", "symplectic_euler", "verlet", "rk4", "implicit_euler"],
  time: 20,
  budget: 600,
  fresh: true,
};
const short = { methods: ["verlet", "symplectic_euler"], time: 0.3, budget: 5, fresh: true };

let server;
before(async () => (server = await Server.start("--max-sessions", "32")));
after(() => server.stop());

// Sessions are paused but where a test wants one that plays: they go on after their test, and would leave little of a
// small machine to the lab, whose thread has the lowest priority.
let sessions = 0;
async function enter({ at = server, session = `lab-${++sessions}`, plays = false } = {}) {
  const client = await Client.connect(at, { session });
  await client.notification("scene");
  if (!plays) await client.request("sim.pause");
  await client.request("scene.load", { scene: strip });
  client.session = session;
  return client;
}
const runs = (client, job) => client.notification("lab.progress", (p) => p.job === job && p.state === "running");
const gauge = (name) => server.metric(`clothlab_lab_${name}`);

test("a chart arrives point by point, is finished, and can be exported as JSON, CSV and SVG", async () => {
  const client = await enter();
  const { job, ahead, cached } = await client.request("lab.chart", short);
  assert.equal(ahead, 0);
  assert.equal(cached, false);
  await runs(client, job);
  const end = await client.labResult(job);
  assert.equal(end.state, "finished");
  assert.equal(end.kind, "chart");
  assert.equal(end.stale, false);
  assert.equal(end.result.complete, true);
  assert.ok(end.result.points.length > 0);
  const partial = client.messages.filter((m) => m.method === "lab.result" && m.params.job === job).map((m) => m.params);
  for (const { result } of partial.slice(0, -1)) assert.equal(result.complete, false);
  const counts = partial.map(({ result }) => result.points.length);
  assert.deepEqual(
    counts,
    [...counts].sort((a, b) => a - b),
  );
  const exported = async (format, more) => (await client.request("lab.export", { job, format, ...more })).text;
  assert.deepEqual(JSON.parse(await exported("json")), end.result);
  assert.ok((await exported("csv")).split("\n").length > end.result.points.length);
  assert.match(await exported("svg"), /<svg/);
  assert.notEqual(await exported("svg", { axis: "energy" }), await exported("svg"));
  assert.deepEqual(
    (await client.request("lab.jobs")).jobs.map(({ job, state }) => ({ job, state })),
    [{ job, state: "finished" }],
  );
  await client.close();
});

thoroughTest("a sheet of finite elements is charted, mapped, chosen for and simplified, all but by pbd", async () => {
  const client = await enter();
  const sheet = { model: "fem", warp: 40, weft: 60, poisson: 0.2, shear: 10, bending: 1e-5, damping: 0.01 };
  const scene = { ...strip, cloths: [{ ...strip.cloths[0], material: sheet }] };
  await client.request("scene.load", { scene });
  const jobs = [
    ["lab.chart", { ...short, methods: undefined, iterations: [1] }],
    ["lab.stability", { columns: 2, field: "/cloths/0/material/warp" }],
    ["lab.choose", { tolerance: 0.1, time: 0.1 }],
    ["lab.simplify", { tolerance: 0.1, time: 0.1 }],
  ];
  for (const [method, params] of jobs) {
    const { job } = await client.request(method, params);
    const { state, result, error } = await client.labResult(job);
    assert.equal(state, "finished", `${method}: ${JSON.stringify(error)}`);
    assert.ok(!JSON.stringify(result).includes('"pbd"'), method);
  }
  const { job } = await client.request("lab.stability", { columns: 2, methods: ["pbd"] });
  const { state, error } = await client.labResult(job);
  assert.equal(state, "failed");
  assert.match(error.allowed, /xpbd/);
  await client.close();
});

test("a job measures the scene as the requests before it have left it", async () => {
  const client = await enter();
  const [{ revision }, { job }] = await Promise.all([
    client.request("scene.patch", { patch: { gravity: [0, -1, 0] } }),
    client.request("lab.chart", long),
  ]);
  const { jobs } = await client.request("lab.jobs");
  assert.equal(jobs[0].revision, revision);
  assert.equal(jobs[0].stale, false);
  await client.request("lab.cancel", { job });
  await client.close();
});

// Times are told, not judged: another program may have the processor. But a job that is cancelled ends long before its
// budget of 600 s: nothing waits for it.
test("of two jobs the second waits for the first, and a job that is cancelled ends before its time", async (t) => {
  const client = await enter();
  t.after(() => client.close());
  const waits = [];
  let next = await client.request("lab.chart", long);
  for (const at of [100, 600, 1500]) {
    // from the reference to the trials
    const { job } = next;
    await runs(client, job);
    next = await client.request("lab.chart", long);
    assert.equal(next.ahead, 1);
    await sleep(at);
    const begun = performance.now();
    assert.deepEqual(await client.request("lab.cancel", { job }), { job, cancelled: true });
    assert.equal((await client.labResult(job)).state, "cancelled");
    waits.push(performance.now() - begun);
    assert.deepEqual(await client.request("lab.cancel", { job }), { job, cancelled: false });
  }
  t.diagnostic(`cancelled after ${waits.map((wait) => wait.toFixed(0)).join(", ")} ms`);
  await client.request("lab.cancel", { job: next.job });
});

test("a job on a scene that changes meanwhile is stale; names and colours change nothing", async () => {
  const client = await enter();
  const { job } = await client.request("lab.chart", long);
  await runs(client, job);
  await client.request("scene.patch", { patch: { name: "other" } });
  assert.equal((await client.request("lab.jobs")).jobs[0].stale, false);
  await client.request("scene.patch", { patch: { gravity: [0, -3, 0] } });
  await client.notification("lab.progress", (p) => p.job === job && p.stale);
  assert.equal((await client.request("lab.jobs")).jobs[0].stale, true);
  await client.request("lab.cancel", { job });
  assert.equal((await client.labResult(job)).stale, true);
  await client.close();
});

test("a client that leaves leaves no job behind", async () => {
  const client = await enter();
  const { job } = await client.request("lab.chart", long);
  await client.request("lab.chart", long);
  await runs(client, job);
  assert.equal(await gauge("running"), 1);
  assert.equal(await gauge("queued"), 1);
  client.socket.terminate();
  await client.closed;
  while ((await gauge("running")) + (await gauge("queued")) > 0) await sleep(20); // or this test runs out of time
});

test("a job that asks for it pauses the session, tells all who are there, and lets it play on", async () => {
  const alone = await Server.start(); // a playing session of another test would disturb the job
  const client = await enter({ at: alone, session: "main", plays: true });
  const other = await Client.connect(alone, { session: "main" });
  await client.nextNotification("sim.status", (s) => s.playing && s.step > 0);
  for (const press of [null, "sim.pause"]) {
    const { job } = await client.request("lab.chart", { ...long, pause: true });
    await runs(client, job);
    await other.notification("notice", ({ text }) => /paused while the lab measures/.test(text));
    const { step } = await client.nextNotification("sim.status", (s) => !s.playing);
    assert.equal((await client.nextNotification("sim.status")).step, step);
    if (press) await other.request(press);
    await client.request("lab.cancel", { job });
    assert.equal((await client.labResult(job)).beside, false);
    await client.statuses(3);
    assert.equal((await client.nextNotification("sim.status")).playing, press === null);
  }
  await client.close();
  await other.close();
  await alone.stop();
});

test("a job beside a session that plays says so in its result", async () => {
  const client = await enter({ plays: true });
  const { job } = await client.request("lab.chart", short);
  assert.equal((await client.labResult(job)).beside, true);
  await client.close();
});

test("wrong parameters are refused with what is allowed, and so are other people's jobs", async () => {
  const client = await enter();
  const other = await enter();
  const { job } = await other.request("lab.chart", long);
  const cases = [
    ["lab.chart", { methods: ["fem"] }, "/methods", /verlet, rk4/],
    ["lab.chart", { methods: "verlet" }, "/methods", /list/],
    ["lab.chart", { iterations: [0] }, "/iterations", /\[1, 10000\]/],
    ["lab.chart", { time: 0 }, "/time", /\[0.01, 60/],
    ["lab.chart", { budget: 1e6 }, "/budget", /1200/],
    ["lab.chart", { pause: "yes" }, "/pause", /true or false/],
    ["lab.chart", { tolerance: 0.1 }, "/tolerance", /methods, iterations/],
    ["lab.stability", { columns: 1 }, "/columns", /\[2, 41\]/],
    ["lab.stability", { from: "low" }, "/from", /number/],
    ["lab.choose", {}, "/tolerance", /number/],
    ["lab.choose", { tolerance: 2 }, "/tolerance", /1.0\]/],
    ["lab.simplify", { tolerance: 0 }, "/tolerance", /number/],
    ["lab.cancel", { job: 1e6 }, "/job", /lab.jobs/],
    ["lab.cancel", { job }, "/job", /lab.jobs/],
    ["lab.export", { job, format: "json" }, "/job", /lab.jobs/],
    ["lab.export", { job, format: "png" }, "/format", /json, csv or svg/],
    ["lab.export", { job, format: "svg", axis: "speed" }, "/axis", /position, energy, strain, rest/],
  ];
  for (const [method, params, path, allowed] of cases) {
    const error = await client.refusal(method, params);
    assert.equal(error.code, -32602, `${method} ${JSON.stringify(params)}`);
    assert.equal(error.data.path, path);
    assert.match(error.data.allowed, allowed);
  }
  assert.deepEqual((await client.request("lab.jobs")).jobs, []);
  await client.close();
  await other.close();
});

test("more jobs than may wait are refused with -32002 and what to do", async () => {
  const client = await enter();
  const { limits } = await client.notification("hello");
  const { job } = await client.request("lab.chart", long);
  await runs(client, job);
  for (let i = 0; i < limits.lab.jobs_a_client; i++) await client.request("lab.chart", long);
  const error = await client.refusal("lab.chart", long);
  assert.equal(error.code, -32002);
  assert.match(error.message, /lab.cancel/);
  await client.close();
});

test("a server that is told to end while a job runs ends well, and does not wait for the job", async () => {
  const other = await Server.start();
  const client = await Client.connect(other);
  await client.notification("scene");
  const { job } = await client.request("lab.chart", { budget: 600 });
  await runs(client, job);
  await sleep(500);
  assert.equal(await other.stop(), 0); // which waits less long than the job's 600 s
});
