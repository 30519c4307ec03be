// Errors on the wire, in HTTP (RFC 7230) and in WebSocket frames (RFC 6455): the client is told of each, and no other
// client is affected.
import assert from "node:assert/strict";
import { once } from "node:events";
import net from "node:net";
import { after, before, test } from "node:test";
import { gunzipSync } from "node:zlib";
import { Client, Server, sleep, withTimeout } from "./harness.mjs";

let server;
before(async () => (server = await Server.start()));
after(() => server.stop());

const host = "Host: localhost\r\n";
const get = (headers, path = "/healthz") => `GET ${path} HTTP/1.1\r\n${headers}\r\n`;

class Socket {
  static async open() {
    const socket = new Socket();
    socket.bytes = Buffer.alloc(0);
    socket.net = net.connect(server.port, "127.0.0.1");
    socket.net.on("data", (data) => (socket.bytes = Buffer.concat([socket.bytes, data])));
    socket.net.on("error", () => {});
    socket.closed = new Promise((resolve) => socket.net.on("close", () => resolve(socket.bytes.toString("latin1"))));
    await once(socket.net, "connect");
    return socket;
  }
  write(data) {
    this.net.write(data);
  }
  /// All data received so far, once `enough` accepts it.
  async until(enough) {
    for (let over = false; !enough(this.bytes); await sleep(10)) {
      if (over) assert.fail(`closed after ${JSON.stringify(this.bytes.toString("latin1"))}`);
      over = this.net.destroyed;
    }
    return this.bytes;
  }
}

/// The answer to these bytes from a server that then closes the connection.
async function refusal(bytes) {
  const socket = await Socket.open();
  socket.write(bytes);
  const text = await withTimeout(socket.closed, "the connection to be closed");
  const [, status, reason] = /^HTTP\/1\.\d (\d+)[^\r]*\r\n[\s\S]*?\r\n\r\n([\s\S]*)$/.exec(text) ?? [];
  return { status: Number(status), reason, text };
}
/// The number of answers with status 200 to these bytes, on a connection that stays open.
async function answers(bytes, count) {
  const socket = await Socket.open();
  socket.write(bytes);
  const seen = () => socket.bytes.toString("latin1").split("HTTP/1.1 200 OK").length - 1;
  await withTimeout(
    socket.until(() => seen() >= count),
    `${count} answers`,
  );
  await sleep(50);
  socket.net.destroy();
  return seen();
}

test("a request may have 16 KiB of headers, as of a browser's cookies for localhost; more is told with 431", async () => {
  for (const [name, size] of [
    ["Cookie", 5000],
    ["Cookie", 16_000],
    ["User-Agent", 8000],
    ["X-Other", 8000],
  ])
    assert.equal(await answers(get(`${host}${name}: ${"a".repeat(size)}\r\n`), 1), 1, `${size} bytes of ${name}`);
  for (const size of [16_400, 40_000]) {
    const { status, reason } = await refusal(get(`${host}Cookie: ${"a".repeat(size)}\r\n`));
    assert.equal(status, 431);
    assert.match(reason, /have \d{5} bytes, and may have 16384; .*remove some/);
  }
  const { text } = await refusal(get(`${host}Cookie: ${"a".repeat(100_000)}\r\n`));
  assert.equal(text, "", "beyond 48 KiB it is not read");
  assert.equal((await server.get("/healthz")).status, 200);
});

test("a long Host is no missing one: it is refused as any other strange name", async () => {
  const socket = await Socket.open();
  socket.write(get(`Host: ${"a".repeat(9000)}.evil.example\r\n`, "/api/scene"));
  assert.match((await socket.until((bytes) => bytes.includes("\r\n\r\n"))).toString(), /^HTTP\/1\.1 403/);
  socket.net.destroy();
});

test("HTTP/1.1 without a Host, or with two, is told with 400; HTTP/1.0 needs none", async () => {
  for (const headers of [
    "",
    "Host:\r\n",
    `${host}Host: evil.example\r\n`,
    `${host}${host}`,
    "Host: localhost, evil.example\r\n",
  ]) {
    const { status, reason } = await refusal(get(headers));
    assert.equal(status, 400, JSON.stringify(headers));
    assert.match(reason, /Host header/);
  }
  assert.equal((await refusal("GET /healthz HTTP/1.0\r\n\r\n")).status, 200);
});

test("a request with a body is refused and its connection closed, so that nothing in the body is taken for a request", async () => {
  const hidden = get(host, "/api/scene");
  for (const headers of [
    `Content-Length: ${hidden.length}\r\n`,
    "Transfer-Encoding: chunked\r\n",
    "Content-Length: 4\r\nTransfer-Encoding: chunked\r\n",
    "Content-Length: -1\r\n",
    "Content-Length: 5x\r\n",
    "Content-Length: 0\r\nContent-Length: 5\r\n",
  ]) {
    const { status, text } = await refusal(get(host + headers) + hidden);
    assert.equal(status, 400, headers);
    assert.equal(text.split("HTTP/1.").length, 2, `one answer to ${headers}`);
  }
  const { status, text } = await refusal(
    `POST /api/scene HTTP/1.1\r\n${host}Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n${hidden}`,
  );
  assert.equal(status, 405);
  assert.equal(text.split("HTTP/1.").length, 2);
  assert.equal(
    await answers(get(`${host}Content-Length: 0\r\n`) + get(host) + get(host), 3),
    3,
    "no body, and requests one after the other",
  );
});

test("requests in one packet are answered one after the other, also behind a picture or mesh that a session makes", async () => {
  const viewer = await Client.connect(server);
  await viewer.notification("hello"); // the session has begun
  for (const paths of [
    ["/app.js", "/healthz", "/app.js"],
    ["/api/mesh.obj", "/healthz", "/api/scene"],
    ["/api/snapshot.png", "/api/mesh.obj", "/healthz"],
  ])
    assert.equal(await answers(paths.map((path) => get(host, path)).join(""), 3), 3, paths.join(" "));
  await viewer.close();
});

test("CONNECT is no way to keep a connection that speaks no HTTP", async () => {
  for (const target of ["localhost:80", "/ws"]) {
    const socket = await Socket.open();
    socket.write(`CONNECT ${target} HTTP/1.1\r\n${host}\r\n`);
    await sleep(100);
    socket.write("anything");
    assert.doesNotMatch(await withTimeout(socket.closed, "it to be closed", 5000), /^HTTP\/1\.\d 2/);
  }
});

test("the page is compressed for whom Accept-Encoding says it may be", async () => {
  for (const [accepts, packed] of [
    ["gzip", true],
    ["gzip;q=0", false],
    ["gzip; q=0.0, *", false],
    ["*", true],
    ["*;q=0", false],
    ["identity;q=0", false],
    ["identity;q=0, gzip;q=0.1", true],
    ["gzip;q=0.5, identity", false],
    ["GZIP", true],
    ["notgzip", false],
  ]) {
    const { status, headers, body } = await server.get("/", { "accept-encoding": accepts });
    assert.equal(status, 200);
    assert.equal(headers["content-encoding"], packed ? "gzip" : undefined, accepts);
    assert.match((packed ? gunzipSync(body) : body).toString(), /<html/i);
  }
});

test("a header whose name begins a known one, or a method's, is one like any other, however the bytes come", async () => {
  for (const name of [
    "X-Auth",
    "Accept-CH",
    "Accept-",
    "If",
    "Sec-WebSocket",
    "Ht",
    "A",
    "Get",
    "Put",
    "Patch-Level",
    "Delete-After",
    "Uri-Args",
  ])
    for (const line of [`${host}${name}: 1\r\n`, `${name}: a:b\r\n${host}`])
      assert.equal(await answers(get(line), 1), 1, JSON.stringify(line));
  const socket = await Socket.open();
  for (const byte of get(`X-Auth: 1\r\nPut-After: 2\r\n${host}If: 3\r\n`)) {
    socket.write(byte);
    await sleep(1);
  }
  await socket.until((bytes) => bytes.includes("200 OK"));
  socket.net.destroy();
});

test("a line of a head that is no header is told with 400", async () => {
  for (const line of ["X-Auth", "something", " folded", "Host", "A"]) {
    const { status, reason } = await refusal(get(`${host}${line}\r\n`));
    assert.equal(status, 400, line);
    assert.match(reason, /has no colon/);
  }
});

const handshake = (change = {}) => {
  const headers = {
    Host: "localhost",
    Connection: "Upgrade",
    Upgrade: "websocket",
    "Sec-WebSocket-Version": 13,
    "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
    "Sec-WebSocket-Protocol": "clothlab.v1",
    ...change,
  };
  return (
    "GET /ws HTTP/1.1\r\n" +
    Object.entries(headers)
      .filter(([, value]) => value !== null)
      .map(([name, value]) => `${name}: ${value}\r\n`)
      .join("") +
    "\r\n"
  );
};

test("a handshake that lacks what it needs is told what, and closed", async () => {
  for (const [change, expected, said] of [
    [{ "Sec-WebSocket-Protocol": null }, 400, /no Sec-WebSocket-Protocol; connect with the subprotocol clothlab\.v1/],
    [{ "Sec-WebSocket-Protocol": "chat" }, 400, /clothlab\.v1/],
    [{ "Sec-WebSocket-Protocol": "http" }, 400, /clothlab\.v1/],
    [{ "Sec-WebSocket-Version": 8 }, 426, /version 13/],
    [{ "Sec-WebSocket-Version": null }, 426, /version 13/],
    [{ "Sec-WebSocket-Key": null }, 400, /16 bytes in base64/],
    [{ "Sec-WebSocket-Key": "AAAA" }, 400, /16 bytes/],
    [{ "Sec-WebSocket-Key": "A".repeat(200) }, 400, /16 bytes/],
    [{ Connection: null }, 400, /Connection: Upgrade/],
    [{ Host: null }, 400, /Host header/],
    [{ Cookie: "a".repeat(20_000) }, 431, /16384/],
    [{ "Sec-WebSocket-Protocol": `clothlab.v1${", other".repeat(30)}` }, 400, /may offer 120/],
    [{ Connection: `${"other, ".repeat(30)}Upgrade` }, 400, /much else/],
  ]) {
    const { status, reason, text } = await refusal(handshake(change));
    assert.equal(status, expected, JSON.stringify(change).slice(0, 80));
    assert.match(reason, said);
    if (expected === 426) assert.match(text, /^sec-websocket-version: 13\r$/im);
  }
  for (const hurried of ["\x81\x80mask", "\x81\x05hello\r\n\r\n", "\r\n\r\n", "\x81\x7e\r\nUpgrade: x\r\n\r\n"]) {
    const early = await refusal(Buffer.from(handshake() + hurried, "latin1"));
    assert.equal(early.status, 400, JSON.stringify(hurried));
    assert.match(early.reason, /wait for its answer/);
  }
});

test("a subprotocol among many, a key beside much else and a cookie of 10 kB are a good handshake", async () => {
  for (const change of [
    { "Sec-WebSocket-Protocol": "chat, clothlab.v1" },
    { Cookie: "a".repeat(10_000) },
    { Connection: "keep-alive, Upgrade" },
  ]) {
    const socket = await Socket.open();
    socket.write(handshake(change));
    assert.match((await socket.until((bytes) => bytes.includes("\r\n\r\n"))).toString("latin1"), /^HTTP\/1\.1 101/);
    socket.net.destroy();
  }
});

function frame(opcode, payload, { masked = true, final = true, reserved = 0 } = {}) {
  const bytes = Buffer.from(payload),
    mask = Buffer.from([1, 2, 3, 4]);
  const length = bytes.length < 126 ? [bytes.length] : [126, bytes.length >> 8, bytes.length & 255];
  length[0] |= masked ? 0x80 : 0;
  return Buffer.concat([
    Buffer.from([(final ? 0x80 : 0) | reserved | opcode, ...length]),
    ...(masked ? [mask, bytes.map((byte, i) => byte ^ mask[i & 3])] : [bytes]),
  ]);
}

/// The server's frames after a handshake: {opcode, payload}.
function heard(bytes) {
  const all = [];
  let rest = bytes.subarray(bytes.indexOf("\r\n\r\n") + 4);
  while (rest.length >= 2) {
    const short = rest[1] & 127,
      head = short === 126 ? 4 : 2,
      size = short === 126 && rest.length >= 4 ? rest.readUInt16BE(2) : short;
    if (short === 127 || rest.length < head + size) break;
    all.push({ opcode: rest[0] & 15, payload: rest.subarray(head, head + size) });
    rest = rest.subarray(head + size);
  }
  return all;
}
const said = (bytes, opcode) => heard(bytes).find((message) => message.opcode === opcode)?.payload;

async function connected() {
  const socket = await Socket.open();
  socket.write(handshake());
  await socket.until((bytes) => bytes.includes("\r\n\r\n"));
  return socket;
}
const text = JSON.stringify({ jsonrpc: "2.0", id: 4711, method: "ping", params: { t: 1 } });

test("a frame that breaks the protocol closes its connection with 1002, and nothing in it is done", async () => {
  const good = frame(1, text);
  const cases = {
    "an unmasked message": [frame(1, text, { masked: false })],
    "an unmasked ping": [frame(9, "x", { masked: false })],
    "an unmasked long message": [frame(1, " ".repeat(300) + text, { masked: false })],
    "an unmasked continuation": [
      frame(1, text.slice(0, 9), { final: false }),
      frame(0, text.slice(9), { masked: false }),
    ],
    "an unmasked close": [frame(8, Buffer.from([3, 232]), { masked: false })],
    "an unmasked message, byte by byte": [...frame(1, text, { masked: false })].map((byte) => Buffer.from([byte])),
    "an unmasked message in front of a masked one": [Buffer.concat([frame(1, text, { masked: false }), good])],
    "a reserved bit": [frame(1, text, { reserved: 0x40 })],
    "another reserved bit": [frame(1, text, { reserved: 0x10 })],
    "a reserved opcode": [frame(3, text)],
    "a reserved control opcode": [frame(11, "")],
    "a continuation of nothing": [frame(0, text)],
    "a message within a message": [frame(1, "{", { final: false }), good],
    "a control frame in pieces": [frame(9, "x", { final: false })],
    "a long control frame": [frame(9, "x".repeat(126))],
  };
  for (const [what, frames] of Object.entries(cases)) {
    const socket = await connected();
    for (const part of frames) {
      socket.write(part);
      if (frames.length > 2) await sleep(2);
    }
    const bytes = await withTimeout(
      socket.until((all) => said(all, 8)),
      `the close after ${what}`,
    );
    assert.equal(said(bytes, 8).readUInt16BE(0), 1002, what);
    assert.ok(
      !heard(bytes).some(({ opcode, payload }) => opcode === 1 && payload.includes(`"id":4711`)),
      `${what} is not answered`,
    );
    // Statuses come ten times a second to who may still get them.
    const after = await withTimeout(Promise.race([socket.closed, sleep(300)]), what).then(() => heard(socket.bytes));
    assert.equal(after.at(-1).opcode, 8, `nothing is sent after the close frame for ${what}`);
    socket.net.destroy();
  }
});

test("a masked frame in front of an unmasked one is answered", async () => {
  const socket = await connected();
  socket.write(frame(1, text));
  await socket.until((bytes) => heard(bytes).some(({ payload }) => payload.includes(`"id":4711`)));
  socket.write(frame(1, text, { masked: false }));
  const close = said(
    await withTimeout(
      socket.until((bytes) => said(bytes, 8)),
      "the close",
    ),
    8,
  );
  assert.match(close.toString("latin1", 2), /masked/);
  await withTimeout(socket.closed, "the connection to end");
});

test("control frames between the pieces of a message are answered, and the message is", async () => {
  const socket = await connected();
  socket.write(
    Buffer.concat([
      frame(1, text.slice(0, 9), { final: false }),
      frame(9, "between"),
      frame(10, ""),
      frame(0, "", { final: false }),
      frame(0, text.slice(9)),
    ]),
  );
  const bytes = await withTimeout(
    socket.until((all) => heard(all).some(({ payload }) => payload.includes(`"id":4711`))),
    "the answer",
  );
  assert.equal(said(bytes, 10).toString(), "between");
  socket.net.destroy();
});
