import assert from "node:assert/strict";
import { test } from "node:test";
import { Client, runProgram, Server } from "./harness.mjs";

test("SIGTERM and SIGINT end the server cleanly, its clients told", async () => {
  for (const signal of ["SIGTERM", "SIGINT"]) {
    const server = await Server.start();
    const client = await Client.connect(server);
    await client.request("stream.subscribe");
    await client.frame();
    assert.equal(await server.stop(signal), 0);
    assert.equal((await client.closed).code, 1001);
    assert.equal(server.stdout, `listening on http://127.0.0.1:${server.port}/\n`);
  }
});

test("a port in use is an error that says so", async () => {
  const server = await Server.start();
  const { code, stdout, stderr } = await runProgram(["serve", "--port", String(server.port)]);
  assert.equal(code, 1);
  assert.equal(stdout, "");
  assert.match(stderr, new RegExp(`port ${server.port}`));
  assert.match(stderr, /--port/);
  await server.stop();
});

test("--bind beyond loopback without --token is refused", async () => {
  for (const address of ["0.0.0.0", "::", "192.168.1.1"]) {
    const { code, stderr } = await runProgram(["serve", "--port", "0", "--bind", address]);
    assert.equal(code, 2);
    assert.match(stderr, /--token/);
  }
});

test("--bind beyond loopback with --token serves", async () => {
  const server = await Server.start("--bind", "0.0.0.0", "--token", "t");
  const client = await Client.connect(server);
  assert.deepEqual(await client.request("auth", { token: "t" }), { role: "operator" });
  await client.close();
  assert.equal(await server.stop(), 0);
});

test("wrong usage and invalid scenes end with 2 and say what is wrong", async () => {
  const cases = [
    [["--scene", "no-such-preset"], /no-such-preset/],
    [["no-such-preset"], /no-such-preset: no such file/],
    [["--set", "/solver/dt=-1"], /\/solver\/dt/],
    [["--set", "/cloths/0/pins/0/at=corner:99,0"], /\/cloths\/0\/pins\/0\/at/],
    [["--port", "70000"], /port/],
    [["--view-token", "v"], /--token/],
    [["--tls-cert", "/no/such"], /--tls-key/],
    [["--bogus"], /bogus/],
    [["--asset-root", "/no/such/folder"], /asset-root/],
  ];
  for (const [args, expected] of cases) {
    const { code, stdout, stderr } = await runProgram(["serve", "--port", "0", ...args]);
    assert.equal(code, 2, args.join(" "));
    assert.equal(stdout, "");
    assert.match(stderr, expected);
  }
});

test("a device that does not exist ends with 3", async () => {
  const { code, stderr } = await runProgram(["serve", "--port", "0", "--gpu", "99"]);
  assert.equal(code, 3);
  assert.ok(stderr.length > 0);
});
