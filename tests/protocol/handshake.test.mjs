import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import net from "node:net";
import { once } from "node:events";
import { after, before, test } from "node:test";
import { Client, Server, withTimeout } from "./harness.mjs";

const schema = JSON.parse(readFileSync(new URL("../../server/scene/scene.schema.json", import.meta.url)));
let server;
before(
  async () =>
    (server = await Server.start(
      "--allow-origin",
      "https://friend.example",
      "--max-clients",
      "3",
      "--max-sessions",
      "2",
    )),
);
after(() => server.stop());

async function refused(options, status) {
  await assert.rejects(Client.connect(server, options), (error) => status === undefined || error.status === status);
}

/// Sends raw bytes; returns the answer until the server closes, or `enough` is seen.
async function raw(text, enough) {
  const socket = net.connect(server.port, "127.0.0.1");
  let answer = "";
  const done = new Promise((resolve) => {
    socket.on("data", (data) => {
      answer += data.toString("latin1");
      if (enough && answer.includes(enough)) resolve();
    });
    socket.on("close", resolve);
    socket.on("error", resolve);
  });
  await once(socket, "connect");
  socket.write(text);
  await withTimeout(done, "the server to answer or close");
  socket.destroy();
  return answer;
}

test("hello comes first, then the whole scene", async () => {
  const client = await Client.connect(server);
  const scene = await client.notification("scene");
  assert.deepEqual(
    client.messages.slice(0, 2).map((message) => message.method),
    ["hello", "scene"],
  );
  const hello = await client.notification("hello");
  assert.equal(hello.server, "clothlab");
  assert.match(hello.version, /^\d+\.\d+\.\d+$/);
  assert.equal(hello.session, "main");
  assert.equal(hello.role, "operator");
  assert.ok(hello.renderer.length > 0);
  assert.deepEqual(hello.methods, schema.properties.solver.properties.method.enum);
  assert.deepEqual(hello.encodings, ["f32", "q16", "c16"]);
  assert.equal(hello.limits.message_bytes, 65536);
  assert.equal(hello.limits.json_depth, 32);
  assert.equal(hello.limits.clients, 3);
  assert.equal(scene.document.name, "seed");
  assert.ok(Number.isInteger(scene.revision));
  await client.close();
});

test("a session is untouched for the first client alone, and only where no scene was named", async () => {
  const untouched = async (on, session) => {
    const client = await Client.connect(on, { session });
    const hello = await client.notification("hello");
    await client.close();
    return hello.untouched;
  };
  const plain = await Server.start();
  const named = await Server.start("--scene", "seed");
  const set = await Server.start("--set", "/solver/dt=0.0005");
  try {
    assert.deepEqual([await untouched(plain, "main"), await untouched(plain, "main")], [true, false]);
    assert.equal(await untouched(plain, "other"), true);
    for (const on of [named, set]) assert.equal(await untouched(on, "main"), false);
  } finally {
    await Promise.all([plain, named, set].map((each) => each.stop()));
  }
});

test("a handshake without the subprotocol is refused", () => refused({ protocols: [] }));
test("a handshake with another subprotocol is refused", () => refused({ protocols: ["chat"] }));
test("a handshake for the plain protocol's internal name is refused", () => refused({ protocols: ["http"] }));
test("a handshake anywhere but at /ws is refused", () => refused({ path: "/elsewhere" }, 404));
test("a foreign Origin is refused", () => refused({ headers: { origin: "http://evil.example" } }, 403));
test("the null Origin is refused", () => refused({ headers: { origin: "null" } }, 403));
test("the right host on another port is a foreign Origin", () =>
  refused({ headers: { origin: "http://127.0.0.1:1" } }, 403));

test("a page whose site's name was made to point at this machine is refused, though its Origin is its Host", async () => {
  const at = `rebound.example:${server.port}`;
  await refused({ headers: { host: at, origin: `http://${at}` } }, 403);
  await refused({ headers: { host: at } }, 403);
  // Known hosts: that of an origin which --allow-origin names; an address; localhost. Nobody else can own the last two.
  for (const [host, origin] of [
    ["friend.example", "https://friend.example"],
    [`localhost:${server.port}`, `http://localhost:${server.port}`],
    ["[::1]:80", "http://[::1]:80"],
  ]) {
    const client = await Client.connect(server, { headers: { host, origin } });
    await client.notification("hello");
    await client.close();
  }
});

test("a session's name with other characters than letters, digits, - and _ is refused", () =>
  refused({ session: "a.b" }, 400));
test("a session's name of more than 64 characters is refused", () => refused({ session: "a".repeat(65) }, 400));

test("the server's own Origin and an allowed one may connect", async () => {
  for (const origin of [`http://${server.host}`, "https://friend.example"]) {
    const client = await Client.connect(server, { headers: { origin } });
    await client.notification("hello");
    await client.close();
  }
});

test("one client more than --max-clients is refused, and let in when another has left", async () => {
  const clients = [];
  for (let i = 0; i < 3; ++i) clients.push(await Client.connect(server));
  await refused({}, 503);
  await clients[0].close();
  const next = await Client.connect(server);
  await next.notification("hello");
  for (const client of [...clients.slice(1), next]) await client.close();
});

test("one session more than --max-sessions is refused", async () => {
  const second = await Client.connect(server, { session: "second" });
  await refused({ session: "third" }, 503);
  await second.close();
});

test("an upgrade to h2c is refused", async () => {
  const answer = await raw(
    "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\n" +
      "HTTP2-Settings: AAMAAABkAAQAoAAAAAIAAAAA\r\n\r\n",
    "\r\n\r\n",
  );
  assert.doesNotMatch(answer, /^HTTP\/1.1 101/);
});

test("the word websocket in the handshake may be written in any case", async () => {
  const answer = await raw(
    "GET /ws HTTP/1.1\r\nHost: localhost\r\nConnection: upgrade\r\nUpgrade: WebSocket\r\nSec-WebSocket-Version: 13\r\n" +
      "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Protocol: clothlab.v1\r\n\r\n",
    "\r\n\r\n",
  );
  assert.match(answer, /^HTTP\/1.1 101/);
});

test("HTTP/2 with prior knowledge gets no HTTP/2", async () => {
  const answer = await raw("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\x04\0\0\0\0\0", "\r\n\r\n");
  assert.ok(!answer.startsWith("\0"), "that is a SETTINGS frame");
});

test("the server still answers after all of this", async () => {
  const client = await Client.connect(server);
  assert.deepEqual(await client.request("ping", { t: 1 }), { t: 1 });
  await client.close();
});
