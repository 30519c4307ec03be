// --publish and `clothlab relay`: a session's frames go once to a bus, and from there to any number of viewers.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { NatsClient, NatsServer, noBus } from "./bus.mjs";
import { Client, patience, runProgram, Server, sleep } from "./harness.mjs";

const skip = noBus();
let bus, origin, relay;

before(async () => {
  if (skip) return;
  // The least that nats-server allows is far less than a topology, which then travels in parts.
  bus = await NatsServer.start("max_payload: 16384");
  origin = await Server.start("--publish", bus.url);
  relay = await Server.launch("relay", "--from", bus.url);
});
after(async () => {
  for (const server of [relay, origin]) await server?.stop();
  await bus?.stop();
});

const byPosition = (frame) => JSON.stringify(frame.positions?.slice?.(0, 3) ?? frame.positions);

async function watch(server, { session, encoding = "q16", ...more } = {}) {
  const client = await Client.connect(server, { session });
  await client.request("stream.subscribe", { encoding, ...more });
  return client;
}

test("a viewer of a relay gets hello as a viewer, the scene, the topology and frames as a viewer of the server does", {
  skip,
}, async () => {
  const [here, there] = [await watch(origin, { encoding: "f32" }), await watch(relay, { encoding: "f32" })];
  const hello = await there.notification("hello");
  assert.equal(hello.role, "viewer");
  assert.equal(hello.relay, true);
  assert.equal((await here.notification("hello")).relay, false);
  assert.deepEqual(hello.renderer, (await here.notification("hello")).renderer);
  assert.deepEqual((await there.notification("scene")).document, (await here.notification("scene")).document);
  await there.notification("sim.status", ({ time }) => time > 0);
  assert.equal((await there.notification("viewers", ({ count }) => count === 2)).count, 2);
  await here.notification("viewers", ({ count }) => count === 2);
  const frame = await there.frame((each) => each.time > 0.2);
  assert.equal(frame.vertexCount, 625);
  const { kind, topologyRevision, ...topology } = there.topologies[0];
  assert.equal(topologyRevision, frame.topologyRevision);
  assert.deepEqual(topology.triangles, here.topologies[0].triangles);
  // The same step gives the same bytes, wherever it is read.
  await here.request("sim.pause");
  const step = (await here.request("sim.step", { steps: 3 })) && (await here.nextNotification("sim.status")).step;
  const [mine, yours] = await Promise.all([here, there].map((client) => client.frame((each) => each.step === step)));
  assert.deepEqual(byPosition(yours), byPosition(mine));
  await here.request("sim.play");
  await Promise.all([here.close(), there.close()]);
});

test("a viewer that comes to a relay late gets the present scene, and frames at once even if nothing moves", {
  skip,
}, async () => {
  const operator = await watch(origin, { session: "late" });
  await operator.request("scene.load", { preset: "hanging-strip" });
  const early = await watch(relay, { session: "late" });
  await early.frame();
  await operator.request("sim.pause");
  await operator.request("scene.patch", { patch: { gravity: [0, -3, 0] } });
  await operator.request("scene.patch", { patch: [{ op: "replace", path: "/solver/dt", value: 0.0005 }] });
  const changed = await early.notification("scene.changed", ({ patch }) => Array.isArray(patch));
  const { document, revision } = await operator.request("scene.get");
  assert.equal(changed.revision, revision);
  assert.deepEqual(await early.request("scene.get"), { document, revision });
  for (const encoding of ["q16", "c16", "f32"]) {
    const late = await watch(relay, { session: "late", encoding });
    const scene = await late.notification("scene");
    assert.deepEqual(scene, { document, revision });
    await late.frame();
    await late.close();
  }
  await Promise.all([operator.close(), early.close()]);
});

test("another mesh, a field, a preset with moving colliders: a relay's viewers see them", { skip }, async () => {
  const operator = await Client.connect(origin, { session: "change" });
  const viewer = await watch(relay, { session: "change" });
  await viewer.frame((frame) => frame.vertexCount === 625);
  await operator.request("scene.load", { preset: "twist" });
  await viewer.notification("scene", ({ document }) => document.name === "twist");
  const frame = await viewer.frame((each) => each.vertexCount !== 625);
  assert.equal(viewer.topologies.at(-1).topologyRevision, frame.topologyRevision);
  await viewer.request("stream.subscribe", { encoding: "q16", field: "strain" });
  await viewer.nextFrame((each) => each.range > 0);
  await operator.request("scene.load", { preset: "tablecloth-pull" });
  await operator.request("scene.patch", {
    patch: [
      {
        op: "add",
        path: "/colliders/-",
        value: {
          sphere: { center: [3, 1, 0], radius: 0.1 },
          motion: { oscillate: { axis: [0, 1, 0], amplitude: 0.1, frequency: 1 } },
        },
      },
    ],
  });
  await viewer.nextNotification("colliders");
  await Promise.all([operator.close(), viewer.close()]);
});

test("the mesh of a collider comes through the relay, once for all", { skip }, async () => {
  const operator = await Client.connect(origin, { session: "body" });
  const vertices = [
    [0, 0, 0],
    [1, 0, 0],
    [0, 0, 1],
    [0, 1, 0],
  ];
  const triangles = [
    [0, 1, 2],
    [0, 3, 1],
    [0, 2, 3],
    [1, 3, 2],
  ];
  await operator.request("scene.patch", {
    patch: [
      {
        op: "add",
        path: "/colliders/-",
        value: { name: 'a "stone"', mesh: { vertices, triangles }, transform: { translate: [4, 0, 0] } },
      },
    ],
  });
  const viewer = await watch(relay, { session: "body" });
  await viewer.notification("scene");
  const path = "/api/collider.ply?session=body&name=a%20%22stone%22";
  const asked = await origin.get(path);
  assert.equal(asked.status, 200);
  const answers = await Promise.all([1, 2, 3].map(() => relay.get(path)));
  answers.push(await relay.get(path));
  for (const { status, body } of answers) {
    assert.equal(status, 200);
    assert.deepEqual(body, asked.body);
  }
  assert.equal((await relay.get("/api/collider.ply?session=body&name=none")).status, 404);
  assert.deepEqual(
    JSON.parse((await relay.get("/api/scene?session=body")).body),
    (await operator.request("scene.get")).document,
  );
  const refused = await relay.get("/api/snapshot.png?session=body");
  assert.equal(refused.status, 404);
  assert.match(refused.body.toString(), /a relay only passes on what viewers see/);
  await Promise.all([operator.close(), viewer.close()]);
});

test("viewers of a relay change nothing and ask nothing of the session; hello lists what they may", {
  skip,
}, async () => {
  const viewer = await Client.connect(relay);
  const { requests } = await viewer.notification("hello");
  const expected = [
    "auth",
    "ping",
    "scene.get",
    "scene.presets",
    "stream.ack",
    "stream.subscribe",
    "stream.unsubscribe",
  ];
  assert.deepEqual(requests, expected);
  for (const method of ["sim.pause", "scene.patch", "lab.chart", "mesh.upload", "grab.start", "record.start"])
    assert.match((await viewer.refusal(method, {})).message, /a viewer may only look/);
  for (const method of ["inspect.contacts", "timeline.get", "record.get"])
    assert.match((await viewer.refusal(method, {})).message, /a relay only passes frames on/);
  assert.deepEqual((await viewer.refusal("sim.fly", {})).data.allowed, expected);
  assert.deepEqual(await viewer.request("ping", { t: 1 }), { t: 1 });
  await viewer.close();
});

test("a session that no server has open is refused with its reason, and the relay goes on", { skip }, async () => {
  const viewer = await Client.connect(relay, { session: "nowhere" });
  const { code } = await viewer.closed;
  assert.equal(code, 1011);
  assert.match(
    (await viewer.notification("notice")).text,
    /session nowhere: no server on the bus has it open; an operator opens it/,
  );
  assert.equal((await relay.get("/healthz")).status, 200);
  assert.equal(await relay.metric("clothlab_sessions_failed_total"), 0); // or each typing error would be an alert
});

test("nothing is published while no relay wants it, and only what it wants", { skip }, async () => {
  const operator = await watch(origin, { session: "quiet" });
  const listener = await NatsClient.connect(bus);
  listener.subscribe("clothlab.quiet.>", 1);
  await operator.nextFrame();
  await sleep(300);
  assert.deepEqual(listener.messages, []);
  // What a script of one's own does, without a relay: README.md of server/relay.
  listener.publish(
    "clothlab.quiet.want",
    JSON.stringify({ relay: "mine", forms: { q16: 10 } }),
    "clothlab.quiet.for.mine",
  );
  await listener.until(({ subject }) => subject === "clothlab.quiet.q16", "a frame");
  const state = await listener.until(({ data }) => data[0] === 0x7b && data.includes('"document"'), "the state");
  assert.deepEqual(JSON.parse(state.data).document, (await operator.request("scene.get")).document);
  await listener.until(({ subject }) => subject === "clothlab.quiet.text", "a status");
  const began = listener.messages.length;
  await sleep(1500);
  const frames = listener.messages.slice(began).filter(({ subject }) => subject.endsWith(".q16")).length;
  assert.ok(frames > 2 && frames <= 18, `${frames} frames in 1.5 s at 10 a second`);
  await sleep(3500); // the lease of the want ends
  listener.messages.length = 0;
  await sleep(600);
  assert.deepEqual(listener.messages, []);
  for (const wrong of [
    "",
    "[1]",
    "{",
    '{"forms":{"q16":"fast"}}',
    '{"relay":7}',
    '{"relay":"x","forms":{"q16":-1}}',
    "\0\xff",
  ])
    listener.publish("clothlab.quiet.want", wrong, "clothlab.quiet.for.mine");
  await operator.nextFrame();
  listener.end();
  await operator.close();
});

test("a flood of requests on the bus, of one relay or of new ones, stops neither the session nor another relay", {
  skip,
}, async () => {
  const [mine, theirs] = [await watch(origin, { session: "flood" }), await watch(relay, { session: "flood" })];
  await theirs.nextFrame();
  const flood = await NatsClient.connect(bus);
  const want = (name, i) => JSON.stringify({ relay: name, viewers: i % 7, forms: { q16: 10 + (i % 100) } });
  const from = mine.frames.at(-1).time;
  for (let sent = 0, second = performance.now(); sent < 30_000; ) {
    for (const until = Math.min(30_000, (performance.now() - second) * 9); sent < until; ++sent) {
      const name = sent % 2 ? `new-${sent}` : "one";
      flood.publish("clothlab.flood.want", want(name, sent), `clothlab.flood.for.${name}`);
      if (sent % 10 === 0) flood.publish("clothlab.flood.collider", "none", `clothlab.flood.for.${name}`);
    }
    await sleep(5);
  }
  // In each second of it frames have come, here and through the relay, and requests are answered.
  for (const { frames } of [mine, theirs])
    for (const part of [1, 2, 3])
      assert.ok(
        frames.some(({ time }) => time > from + part - 1 && time <= from + part + 0.5),
        `second ${part}`,
      );
  assert.deepEqual(await mine.request("ping", { t: 1 }), { t: 1 });
  const told = mine.messages.filter(({ method }) => method === "viewers").length;
  assert.ok(told < 60, `the number of viewers was told ${told} times`);
  flood.end();
  await Promise.all([mine.close(), theirs.close()]);
});

const until = async (so, what) => {
  for (const end = Date.now() + patience; !(await so()); await sleep(50)) assert.ok(Date.now() < end, what);
};

test("an outage of the bus does not slow the session, and heals by itself", { skip }, async () => {
  const [mine, theirs] = [await watch(origin, { session: "outage" }), await watch(relay, { session: "outage" })];
  await theirs.nextFrame();
  await bus.stop();
  await until(async () => (await origin.metric("clothlab_bus_connected")) === 0, "the server notices");
  const from = await mine.nextFrame();
  await mine.frame((frame) => frame.time > from.time + 1);
  assert.equal((await origin.get("/healthz")).status, 200);
  const notice = await theirs.notification("notice");
  assert.match(notice.text, /the session's server does not answer; the cloth stands still/);
  await bus.run();
  await theirs.nextNotification("notice", ({ text }) => text === "the session's server answers again");
  await theirs.nextFrame((frame) => frame.time > from.time + 1);
  await Promise.all([mine.close(), theirs.close()]);
});

test("a bus that stops reading does not slow the session either", { skip }, async () => {
  const [mine, theirs] = [await watch(origin, { session: "stuck" }), await watch(relay, { session: "stuck" })];
  await theirs.nextFrame();
  bus.child.kill("SIGSTOP");
  const from = await mine.nextFrame();
  await mine.frame((frame) => frame.time > from.time + 3);
  assert.equal((await origin.get("/healthz")).status, 200);
  bus.child.kill("SIGCONT");
  await theirs.nextFrame((frame) => frame.time > from.time + 3);
  await Promise.all([mine.close(), theirs.close()]);
});

test("a server that is killed and started again goes on for the viewers of its relays, who stay connected", {
  skip,
}, async () => {
  const port = String(origin.port);
  const theirs = await watch(relay);
  await theirs.nextFrame();
  const last = theirs.frames.at(-1).sequence;
  await origin.stop("SIGKILL");
  origin = await Server.start("--publish", bus.url, "--port", port, "--scene", "hanging-strip");
  await theirs.nextNotification("scene", ({ document }) => document.name === "hanging-strip");
  const frame = await theirs.nextFrame((each) => each.vertexCount !== 625);
  assert.ok(frame.sequence > last);
  assert.equal(theirs.topologies.at(-1).topologyRevision, frame.topologyRevision);
  assert.equal(theirs.over, undefined);
  await theirs.close();
});

test("a relay with a token lets in who has it, and started before the bus it waits for it", { skip }, async () => {
  const other = await NatsServer.start();
  await other.stop();
  const waiting = await Server.launch("relay", "--from", other.url, "--view-token", "see");
  assert.equal((await waiting.get("/api/scene")).status, 401);
  await other.run();
  const server = await Server.start("--publish", other.url);
  const viewer = await Client.connect(waiting);
  assert.match((await viewer.refusal("scene.get", {})).message, /requires a token/);
  assert.match((await viewer.refusal("auth", { token: "" })).message, /not valid/);
  assert.deepEqual(await viewer.request("auth", { token: "see" }), { role: "viewer" });
  await viewer.request("stream.subscribe");
  await viewer.frame();
  for (const each of [waiting, server]) assert.equal(await each.stop(), 0);
  assert.equal((await viewer.closed).code, 1012);
  await other.stop();
});

test("a bus that asks for a password gets it from the URL; a wrong one is told, and never shown", {
  skip,
}, async () => {
  const closed = await NatsServer.start("authorization { user: cloth, password: secret }");
  const url = (password) => `nats://cloth:${password}@127.0.0.1:${closed.port}`;
  for (const password of ["wrong", ""]) {
    const { code, stderr } = await runProgram(["relay", "--port", "0", "--from", url(password)]);
    assert.equal(code, 1);
    assert.match(stderr, /the bus at nats:\/\/127\.0\.0\.1:\d+: .*Authorization/i);
    assert.doesNotMatch(stderr, /wrong/);
  }
  const server = await Server.launch("relay", "--from", url("secret"));
  assert.equal(await server.metric("clothlab_bus_connected"), 1);
  assert.equal(await server.stop(), 0);
  await closed.stop();
});

test("wrong addresses of a bus are told, with what is allowed", { skip }, async () => {
  for (const args of [
    ["serve", "--port", "0", "--publish", "localhost:4222"],
    ["relay", "--port", "0", "--from", "http://localhost"],
  ]) {
    const { code, stderr } = await runProgram(args);
    assert.equal(code, 1);
    assert.match(stderr, /the bus: "[^"]+"; an address such as nats:\/\/127\.0\.0\.1:4222/);
  }
  const { code, stderr } = await runProgram(["relay"]);
  assert.equal(code, 2);
  assert.match(stderr, /--from is required/);
});

test("/metrics of a server on a bus tells what it sent, of one without a bus nothing of it", { skip }, async () => {
  assert.equal(await origin.metric("clothlab_bus_connected"), 1);
  assert.ok((await origin.metric("clothlab_bus_bytes_sent_total")) > 0);
  const alone = await Server.start();
  assert.ok(Number.isNaN(await alone.metric("clothlab_bus_connected")));
  assert.equal(await alone.stop(), 0);
});
