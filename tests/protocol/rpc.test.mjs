import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { Client, Server, withTimeout } from "./harness.mjs";

let server, client;
before(async () => (server = await Server.start()));
after(() => server.stop());
beforeEach(async () => {
  client = await Client.connect(server);
  await client.notification("scene");
});
afterEach(() => client.close());

async function errorFor(text) {
  const from = client.messages.length;
  client.send(text);
  return client.errorWithoutId(from);
}
const request = (fields) => JSON.stringify({ jsonrpc: "2.0", id: 1, method: "ping", ...fields });
const stillAlive = async () => assert.deepEqual(await client.request("ping", { t: "x" }), { t: "x" });

test("ping answers with what it was sent", async () => {
  assert.deepEqual(await client.request("ping", { t: 12.5 }), { t: 12.5 });
});

test("text that is not JSON answers -32700 and the connection lives", async () => {
  for (const text of [
    "",
    "{",
    "hello",
    '{"a":1}}',
    "NaN",
    "{}garbage",
    "{}\0garbage",
    request({}) + "\0",
    request({}) + "\0{}",
    request({}) + " x",
    '{"jsonrpc":"2.0","id":1,"method":"ping","params":{"t":NaN}}',
  ])
    assert.equal((await errorFor(text)).code, -32700, text);
  await stillAlive();
});

test("JSON nested deeper than 32 answers an error and the connection lives", async () => {
  const deep = '{"jsonrpc":"2.0","method":"ping","params":{"t":' + "[".repeat(40) + "]".repeat(40) + "}}";
  assert.ok([-32700, -32600].includes((await errorFor(deep)).code));
  assert.ok([-32700, -32600].includes((await errorFor("[".repeat(60_000))).code));
  await stillAlive();
});

test("batches answer -32600", async () => {
  assert.equal((await errorFor(`[${request({})}]`)).code, -32600);
  assert.equal((await errorFor("[]")).code, -32600);
  await stillAlive();
});

test("a message that is no request is answered with -32600", async () => {
  for (const text of [
    "1",
    "null",
    '"x"',
    JSON.stringify({ jsonrpc: "2.0", id: null }),
    request({ id: {} }),
    request({ id: null, jsonrpc: "1.0" }),
    request({ id: null, method: 5 }),
  ])
    assert.equal((await errorFor(text)).code, -32600, text);
  await stillAlive();
});

test("a binary message answers -32600", async () => {
  assert.equal((await errorFor(Buffer.from("{}"))).code, -32600);
  await stillAlive();
});

test("an unknown method answers -32601 with the methods there are", async () => {
  const error = await client.refusal("scene.explode", {});
  assert.equal(error.code, -32601);
  assert.ok(error.data.allowed.includes("scene.patch"));
});

test("bad parameters answer -32602 with where, what was found and what is allowed", async () => {
  const cases = [
    ["stream.subscribe", { rate: 0 }, "/rate"],
    ["stream.subscribe", { rate: "fast" }, "/rate"],
    ["stream.subscribe", { rate: 1000 }, "/rate"],
    ["stream.subscribe", { in_flight: 9 }, "/in_flight"],
    ["stream.subscribe", { in_flight: 1.5 }, "/in_flight"],
    ["stream.subscribe", { encoding: "jpeg" }, "/encoding"],
    ["stream.subscribe", { speed: 1 }, "/speed"],
    ["sim.step", { steps: 0 }, "/steps"],
    ["sim.step", { steps: -1 }, "/steps"],
    ["sim.step", { steps: 1e300 }, "/steps"],
    // biome-ignore lint/correctness/noPrecisionLoss: 2^64, as it is sent
    ["sim.step", { steps: 18446744073709551615 }, "/steps"],
    ["sim.speed", {}, "/factor"],
    ["sim.speed", { factor: 0 }, "/factor"],
    ["sim.speed", { factor: 101 }, "/factor"],
    ["sim.play", { now: true }, "/now"],
    ["scene.load", {}, "/preset"],
    ["scene.load", { preset: 3 }, "/preset"],
    ["scene.load", { preset: "no-such" }, "/preset"],
    ["scene.load", { preset: "seed", scene: {} }, "/preset"],
    ["scene.patch", {}, "/patch"],
    ["scene.patch", { patch: 4 }, "/patch"],
    ["scene.patch", { patch: {}, revision: -1 }, "/revision"],
    ["stream.ack", { frame: -1 }, "/frame"],
    ["auth", {}, "/token"],
    ["ping", [1], ""],
  ];
  for (const [method, params, path] of cases) {
    const error = await client.refusal(method, params);
    assert.equal(error.code, -32602, `${method} ${JSON.stringify(params)}`);
    assert.equal(error.data.path, path, `${method} ${JSON.stringify(params)}`);
    assert.equal(typeof error.data.found, "string");
    assert.ok(error.data.allowed.length > 0);
  }
  await stillAlive();
});

test("positional parameters answer -32602, which says that they are to be named", async () => {
  for (const params of [[], [1], 3, "x"]) {
    const error = await client.refusal("ping", params);
    assert.equal(error.code, -32602);
    assert.match(error.message, /^invalid params: .*; an object of named parameters$/);
    assert.doesNotMatch(error.message, /document/);
  }
  // With an id, even null, it is a request.
  assert.equal((await errorFor(request({ id: null, params: [1] }))).code, -32602);
});

test("a notification is never answered, not even with an error", async () => {
  const before = client.messages.length;
  client.notify("no.such.method");
  client.notify("stream.ack", { frame: "x" });
  client.notify("ping");
  client.notify("ping", [1]);
  client.notify("no.such.method", [1]);
  client.notify("sim.step", 3);
  await stillAlive();
  assert.ok(client.messages.slice(before).every((message) => message.method !== undefined));
});

test("a message in fragments is one message", async () => {
  const text = request({ id: 4711, params: { t: "ab" } });
  const answer = new Promise((resolve, reject) => client.pending.set(4711, { resolve, reject }));
  client.socket.send(text.slice(0, 20), { fin: false });
  client.socket.send(text.slice(20), { fin: true });
  assert.deepEqual(await withTimeout(answer, "the answer"), { t: "ab" });
});

test("a message of 64 KiB is read, a longer one closes the connection with 1009", async () => {
  const padding = 65536 - request({ params: { t: "" } }).length;
  const from = client.messages.length;
  client.send(request({ params: { t: "x".repeat(padding) } }));
  await client.until(
    () => client.messages.slice(from),
    (message) => message.id === 1 && message.result,
    "the answer",
  );
  const other = await Client.connect(server);
  other.send(request({ params: { t: "x".repeat(padding + 1) } }));
  assert.equal((await withTimeout(other.closed, "the close")).code, 1009);
});

test("a long message in short fragments closes the connection with 1009 too", async () => {
  const other = await Client.connect(server);
  for (let i = 0; i < 70; ++i) other.socket.send("x".repeat(1000), { fin: false });
  assert.equal((await withTimeout(other.closed, "the close")).code, 1009);
});

test("a flood of messages closes the connection with 1008, and nobody else's", async () => {
  // With the usual rate a slow machine would read more slowly than the rate allows.
  const narrow = await Server.start("--max-message-rate", "100");
  const other = await Client.connect(narrow);
  const bystander = await Client.connect(narrow);
  await other.notification("hello");
  for (let i = 0; i < 40_000 && !other.over; ++i) other.send('{"jsonrpc":"2.0","method":"ping"}');
  assert.equal((await withTimeout(other.closed, "the close")).code, 1008);
  assert.equal((await bystander.request("ping", { t: 1 })).t, 1);
  await narrow.stop();
});
