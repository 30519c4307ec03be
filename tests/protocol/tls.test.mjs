// HTTPS and WSS: the certificate, the lowest version of TLS, and no HTTP/2.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import tls from "node:tls";
import { makeCertificate } from "../certificate.mjs";
import { Client, runProgram, Server, withTimeout } from "./harness.mjs";

const folder = mkdtempSync(join(tmpdir(), "clothlab-tls-"));
const { key, certificate, made } = makeCertificate(folder);
const skip = made ? false : "there is no openssl to make a certificate with";

let server;
before(async () => {
  if (!skip) server = await Server.start("--tls-cert", certificate, "--tls-key", key);
});
after(async () => {
  await server?.stop();
  rmSync(folder, { recursive: true });
});

/// The parameters on which a TLS client with these options and the server agree; rejects if they do not.
function handshake(options) {
  const agreed = new Promise((resolve, reject) => {
    const socket = tls.connect({ host: "127.0.0.1", port: server.port, rejectUnauthorized: false, ...options }, () => {
      resolve({ version: socket.getProtocol(), alpn: socket.alpnProtocol });
      socket.destroy();
    });
    socket.on("error", reject);
  });
  return withTimeout(agreed, "the TLS handshake");
}

test("with --tls-cert and --tls-key it serves HTTPS and WSS", { skip }, async () => {
  assert.match(server.stdout, /^listening on https:/);
  const client = await Client.connect(server, { scheme: "wss" });
  await client.request("stream.subscribe");
  await client.frame();
  await client.close();
});

test("TLS 1.2 and 1.3 are spoken, 1.0 and 1.1 are not", { skip }, async () => {
  for (const version of ["TLSv1.2", "TLSv1.3"])
    assert.equal((await handshake({ minVersion: version, maxVersion: version })).version, version);
  // SECLEVEL=0 lets the client offer these versions: the server refuses them.
  for (const version of ["TLSv1", "TLSv1.1"])
    await assert.rejects(
      handshake({ minVersion: version, maxVersion: version, ciphers: "DEFAULT@SECLEVEL=0" }),
      /protocol version/i,
      version,
    );
});

test("under TLS too an unmasked frame closes its connection with 1002", { skip }, async () => {
  const socket = tls.connect({ host: "127.0.0.1", port: server.port, rejectUnauthorized: false });
  socket.on("error", () => {});
  let bytes = Buffer.alloc(0);
  const heard = (what) =>
    withTimeout(new Promise((resolve) => socket.on("data", () => bytes.includes(what) && resolve())), what.toString());
  socket.on("data", (data) => (bytes = Buffer.concat([bytes, data])));
  socket.write(
    "GET /ws HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n" +
      "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Protocol: clothlab.v1\r\n\r\n",
  );
  await heard("hello");
  socket.write(Buffer.concat([Buffer.from([0x81, 2]), Buffer.from("{}")]));
  await heard(Buffer.from([0x03, 0xea]));
  assert.ok(bytes.includes("are to be masked"));
  assert.ok(!bytes.includes('"id":null'), "the message is not answered");
  socket.destroy();
});

test("HTTP/2 is not agreed on, HTTP/1.1 is", { skip }, async () => {
  assert.equal((await handshake({ ALPNProtocols: ["h2", "http/1.1"] })).alpn, "http/1.1");
  const alone = await handshake({ ALPNProtocols: ["h2"] }).catch((error) => ({ alpn: false, error }));
  assert.equal(alone.alpn, false);
});

test("a certificate that is none is an error that names the flags", { skip }, async () => {
  const wrong = join(folder, "wrong.pem");
  writeFileSync(wrong, "not a certificate");
  const { code, stderr } = await runProgram(["serve", "--port", "0", "--tls-cert", wrong, "--tls-key", key]);
  assert.equal(code, 1);
  assert.match(stderr, /--tls-cert and --tls-key are PEM files/);
});
