// --trusted-proxy: behind a proxy, limits and logs go by the address that the proxy names.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Client, runProgram, Server } from "./harness.mjs";

const from = (server, list) => Client.connect(server, { headers: { "X-Forwarded-For": list } });

test("clients of a trusted proxy are told apart; what a client claims itself is not believed", async () => {
  const server = await Server.start("--max-clients-per-address", "1", "--trusted-proxy", "127.0.0.1");
  await from(server, "192.0.2.1");
  await from(server, "192.0.2.2");
  await from(server, "2001:db8::1");
  await assert.rejects(from(server, "192.0.2.1"), { status: 503 });
  for (const claimed of ["203.0.113.9", "198.51.100.1, 203.0.113.9"]) // the proxy appended the last
    await assert.rejects(from(server, `${claimed}, 192.0.2.2`), { status: 503 });
  await assert.rejects(from(server, "192.0.2.2, 127.0.0.1"), { status: 503 }); // through two proxies
  await assert.rejects(from(server, "2001:db8::2"), { status: 503 }); // of the same network
  assert.match(server.stderr, /event=client_connected .*address=192\.0\.2\.1 /);
  await Client.connect(server); // without the header: the proxy's own address
  await assert.rejects(from(server, "no address"), { status: 503 });
  assert.equal(await server.stop(), 0);
});

test("a client's address counts in any form that proxies write: with a port, in brackets, IPv4 within IPv6", async () => {
  const server = await Server.start("--max-clients-per-address", "1", "--trusted-proxy", "::ffff:127.0.0.1");
  await from(server, "::ffff:192.0.2.1");
  await from(server, "::FFFF:192.0.2.2"); // another address, not another of one network
  await from(server, "192.0.2.3:4711");
  await from(server, "[2001:db8::1]:4711");
  await from(server, "[2001:db8:1::1]");
  for (const same of ["192.0.2.1", "[::ffff:192.0.2.2]:80", "::ffff:c000:203", "192.0.2.3:80", "2001:db8::2"])
    await assert.rejects(from(server, same), { status: 503 }, same);
  await assert.rejects(from(server, "192.0.2.1, 127.0.0.1:8080"), { status: 503 });
  assert.match(server.stderr, /event=client_connected .*address=192\.0\.2\.3 /);
  assert.equal(await server.stop(), 0);
});

test("without --trusted-proxy the header is ignored, and so it is from another address than the proxy's", async () => {
  for (const trusted of [[], ["--trusted-proxy", "192.0.2.7"]]) {
    const server = await Server.start("--max-clients-per-address", "1", ...trusted);
    await from(server, "192.0.2.1");
    await assert.rejects(from(server, "192.0.2.2"), { status: 503 });
    assert.match(server.stderr, /event=client_connected .*address=127\.0\.0\.1 /);
    assert.equal(await server.stop(), 0);
  }
});

test("a trusted proxy that is no address is refused", async () => {
  const { code, stderr } = await runProgram(["serve", "--port", "0", "--trusted-proxy", "proxy.local"]);
  assert.equal(code, 2);
  assert.match(stderr, /--trusted-proxy: "proxy\.local"; an IPv4 or IPv6 address, e\.g\. 192\.0\.2\.7/);
});
