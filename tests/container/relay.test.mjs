// A relay in the container: what docker/README.md and docker/kubernetes/relay.yaml start.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { NatsServer } from "../protocol/bus.mjs";
import { Client, withTimeout } from "../protocol/harness.mjs";
import { Container } from "./image.mjs";

let bus, server, relay;
before(async () => {
  bus = await NatsServer.start();
  server = await Container.start({ env: { CLOTHLAB_TOKEN: "operators", CLOTHLAB_PUBLISH: bus.url } });
  relay = await Container.start({
    args: ["relay", "--port", "8081", "--max-clients", "2000", "--max-clients-per-address", "2000"],
    env: { CLOTHLAB_FROM: bus.url, CLOTHLAB_VIEW_TOKEN: "look" },
  });
});
after(async () => {
  await server?.stop();
  await bus?.stop();
});

test("it listens on every address, and the health check finds it well", async () => {
  assert.equal(relay.stdout, "listening on http://0.0.0.0:8081/\n");
  const well = relay.exec("/usr/local/bin/healthcheck", "8081");
  assert.deepEqual([well.code, well.stdout], [0, "HTTP/1.1 200 OK\n"], well.stderr);
  assert.match((await relay.get("/")).body.toString(), /<script type="module" src="\/?app\.js/);
});

test("a viewer with the token gets the scene and frames through it, one without gets nothing", async () => {
  const viewer = await Client.connect(relay);
  assert.equal((await viewer.refusal("scene.get")).code, -32001);
  assert.deepEqual(await viewer.request("auth", { token: "look" }), { role: "viewer" });
  assert.equal((await viewer.notification("hello")).relay, true);
  await viewer.request("stream.subscribe");
  const first = await viewer.frame();
  assert.equal(first.vertexCount, 625);
  await viewer.frame((frame) => frame.time > first.time + 0.2);
  await viewer.close();
});

test("it is not root, has no capability and writes nowhere, and no password is in its arguments", () => {
  const { Uid, CapEff, NoNewPrivs } = relay.status;
  assert.notEqual(Number(Uid.split("\t")[0]), 0);
  assert.deepEqual([BigInt(`0x${CapEff}`), NoNewPrivs], [0n, "1"]);
  const { stdout } = relay.exec("bash", "-c", "cat /proc/1/cmdline");
  assert.match(stdout, /^clothlab\0relay\0/);
  for (const secret of ["look", bus.url]) assert.ok(!stdout.includes(secret), stdout.replaceAll("\0", " "));
  assert.doesNotMatch(relay.stderr, /limit_lowered/); // descriptors for as many viewers as relay.yaml asks
});

test("SIGTERM: its viewers are told to connect again, and it ends with 0", async () => {
  const viewer = await Client.connect(relay);
  await viewer.request("auth", { token: "look" });
  const closed = withTimeout(viewer.closed, "the viewer's close");
  assert.equal((await relay.stop()).code, 0, relay.stderr);
  assert.equal((await closed).code, 1012);
});
