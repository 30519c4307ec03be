import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Client, patience, Server, sleep, withTimeout } from "./harness.mjs";

let server;
before(async () => (server = await Server.start("--token", "secret", "--view-token", "look", "--max-sessions", "2")));
after(() => server.stop());

test("with --token the server says nothing until auth has succeeded", async () => {
  const client = await Client.connect(server);
  const other = await Client.connect(server); // is told something meanwhile
  await other.request("auth", { token: "look" });
  await other.statuses(5);
  await other.close();
  assert.deepEqual(client.messages, []);
  const answer = client.request("auth", { token: "secret" });
  await client.notification("scene");
  assert.deepEqual(
    client.messages.slice(0, 2).map((message) => message.method),
    ["hello", "scene"],
  );
  assert.deepEqual(await answer, { role: "operator" });
  assert.equal((await client.notification("hello")).role, "operator");
  assert.equal((await client.request("sim.pause")).playing, false);
  await client.request("sim.play");
  await client.close();
});

test("before auth, and with a wrong token, everything answers -32001", async () => {
  const client = await Client.connect(server);
  for (const [method, params] of [
    ["ping", {}],
    ["scene.get", {}],
    ["sim.pause", {}],
    ["stream.subscribe", {}],
    ["auth", { token: "wrong" }],
    ["auth", { token: "" }],
    ["auth", { token: "secretx" }],
  ])
    assert.equal((await client.refusal(method, params)).code, -32001, method);
  assert.equal((await client.refusal('a"label')).code, -32001);
  assert.deepEqual(client.messages, []);
  await client.request("auth", { token: "secret" });
  await client.close();
  // A client must not be able to choose a metric's label.
  assert.ok(!(await server.get("/metrics", { authorization: "Bearer secret" })).body.includes('a"label'));
});

test("before auth a message may have 4 KiB, after it as much as the others'", async () => {
  const client = await Client.connect(server);
  assert.equal((await client.refusal("ping", { t: "x".repeat(4000) })).code, -32001);
  await client.request("auth", { token: "look" });
  await client.request("ping", { t: "x".repeat(5000) });
  await client.close();
  const stranger = await Client.connect(server);
  stranger.notify("ping", { t: "x".repeat(5000) });
  const { code, reason } = await withTimeout(stranger.closed, "the close");
  assert.equal(code, 1009);
  assert.match(reason, /4096 bytes before auth/);
});

test("a client that does not authenticate is closed with 1008 after 5 s", async () => {
  const client = await Client.connect(server);
  const from = performance.now();
  assert.equal((await withTimeout(client.closed, "the close")).code, 1008);
  assert.ok(performance.now() - from > 4000);
});

test("a viewer reads and watches; whatever changes something answers -32001", async () => {
  const client = await Client.connect(server);
  assert.deepEqual(await client.request("auth", { token: "look" }), { role: "viewer" });
  assert.equal((await client.notification("hello")).role, "viewer");
  for (const [method, params] of [
    ["scene.load", { preset: "seed" }],
    ["scene.patch", { patch: {} }],
    ["sim.play", {}],
    ["sim.pause", {}],
    ["sim.step", {}],
    ["sim.reset", {}],
    ["sim.speed", { factor: 1 }],
    ["lab.chart", {}],
    ["lab.stability", {}],
    ["lab.choose", { tolerance: 0.01 }],
    ["lab.simplify", {}],
    ["lab.compare", {}],
    ["lab.moments", { job: 1, from: 0 }],
    ["lab.cancel", { job: 1 }],
    ["lab.jobs", {}],
    ["lab.export", { job: 1, format: "json" }],
    ["record.start", {}],
    ["record.stop", {}],
  ])
    assert.equal((await client.refusal(method, params)).code, -32001, method);
  assert.equal((await client.request("scene.get")).document.name, "seed");
  assert.ok((await client.request("scene.presets")).presets.length > 0);
  assert.equal((await client.request("record.get")).state, "none");
  await client.request("stream.subscribe");
  await client.frame();
  await client.close();
});

test("auth into one session more than --max-sessions answers -32002, and the next one may", async () => {
  const [first, second] = [
    await Client.connect(server, { session: "a" }),
    await Client.connect(server, { session: "b" }),
  ];
  await first.request("auth", { token: "secret" });
  assert.equal((await second.refusal("auth", { token: "secret" })).code, -32002);
  assert.equal((await second.refusal("scene.get")).code, -32002);
  await first.close();
  await second.close();
});

test("the HTTP API and /metrics want the token as a Bearer token; the page and /healthz do not", async () => {
  for (const path of ["/api/scene", "/api/mesh.obj", "/api/snapshot.png", "/metrics"]) {
    const refused = await server.get(path);
    assert.equal(refused.status, 401);
    assert.equal(refused.headers["www-authenticate"], "Bearer");
    assert.equal((await server.get(path, { authorization: "Bearer wrong" })).status, 401);
  }
  for (const token of ["secret", "look"])
    for (const path of ["/api/scene", "/metrics"])
      assert.equal((await server.get(path, { authorization: `Bearer ${token}` })).status, 200);
  assert.equal((await server.get("/")).status, 200);
  assert.equal((await server.get("/healthz")).status, 200);
});

test("wrong tokens over HTTP and the WebSocket count together, then both refuse even the right one", async (t) => {
  const guarded = await Server.start("--token", "secret", "--max-wrong-tokens", "2", "--auth-timeout", "1");
  t.after(() => guarded.stop());
  const ask = (authorization, path = "/api/scene") => guarded.get(path, authorization ? { authorization } : {});
  for (let i = 0; i < 5; ++i) assert.equal((await ask()).status, 401);
  assert.equal((await ask("Basic c2VjcmV0OnNlY3JldA==")).status, 401);
  assert.equal((await ask("Bearer wrong")).status, 401);
  const client = await Client.connect(guarded);
  assert.equal((await client.refusal("auth", { token: "wrong" })).code, -32001);
  for (const [token, path] of [
    ["wrong", "/api/scene"],
    ["secret", "/api/scene"],
    ["secret", "/metrics"],
    ["secret", "/api/mesh.obj"],
  ]) {
    const { status, headers, body } = await ask(`Bearer ${token}`, path);
    assert.equal(status, 429, path);
    const seconds = Number(headers["retry-after"]);
    assert.ok(seconds >= 1 && seconds <= 30, headers["retry-after"]);
    assert.match(body.toString(), new RegExp(`for ${seconds} s`));
  }
  assert.equal((await client.refusal("auth", { token: "secret" })).code, -32002);
  assert.equal((await ask()).status, 401);
  assert.equal((await guarded.get("/")).status, 200);
  assert.equal((await withTimeout(client.closed, "the close")).code, 1008);
});

test("a viewer opens no session: auth answers -32001 until an operator has opened it", async (t) => {
  const guarded = await Server.start("--token", "secret", "--view-token", "look", "--max-sessions", "3");
  t.after(() => guarded.stop());
  const [first, second, third] = await Promise.all(
    ["new", "other", "third"].map((session) => Client.connect(guarded, { session })),
  );
  for (const [client, session] of [
    [first, "new"],
    [second, "other"],
    [third, "third"],
    [first, "new"],
  ]) {
    const error = await client.refusal("auth", { token: "look" });
    assert.equal(error.code, -32001);
    assert.equal(error.message, `no session ${session} is open; an operator opens it by connecting to it`);
  }
  assert.match((await first.refusal("scene.get")).message, /call auth/, "it has no role");
  assert.deepEqual(first.messages, []);
  assert.match(
    (await guarded.get("/metrics", { authorization: "Bearer look" })).body.toString(),
    /^clothlab_sessions 1$/m,
  );
  assert.deepEqual(await second.request("auth", { token: "secret" }), { role: "operator" });
  const operator = await Client.connect(guarded, { session: "new" });
  await operator.request("auth", { token: "secret" });
  assert.deepEqual(await first.request("auth", { token: "look" }), { role: "viewer" });
  assert.equal((await first.notification("hello")).session, "new");
  // An open session stays open while nobody is there.
  for (const client of [first, operator]) await client.close();
  const again = await Client.connect(guarded, { session: "new" });
  assert.deepEqual(await again.request("auth", { token: "look" }), { role: "viewer" });
  assert.equal((await withTimeout(third.closed, "the close")).code, 1008);
  for (const client of [second, again]) await client.close();
});

test("where all places are taken, the session longest unwatched makes room for an operator, none for a viewer", async (t) => {
  const guarded = await Server.start(
    "--token",
    "secret",
    "--view-token",
    "look",
    "--max-sessions",
    "2",
    "--unwatched-timeout",
    "1",
  );
  t.after(() => guarded.stop());
  const enter = async (session, token) => {
    const client = await Client.connect(guarded, { session });
    return client
      .request("auth", { token })
      .then(
        ({ role }) => role,
        ({ code }) => code,
      )
      .finally(() => client.close());
  };
  const open = async (session) =>
    (await guarded.get(`/api/scene?session=${session}`, { authorization: "Bearer look" })).status === 200;
  assert.equal(await enter("left", "secret"), "operator");
  for (const until = Date.now() + patience; !(await open("left")); await sleep(50)) assert.ok(Date.now() < until);
  await sleep(1500);
  assert.equal(await enter("new", "look"), -32001);
  assert.deepEqual([await open("left"), await open("new")], [true, false]);
  assert.equal(await enter("new", "secret"), "operator");
  assert.equal(await open("left"), false);
});
