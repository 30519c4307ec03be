import assert from "node:assert/strict";
import { once } from "node:events";
import { chmodSync, chownSync, readdirSync, writeFileSync } from "node:fs";
import net from "node:net";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { makeCertificate } from "../certificate.mjs";
import { Client, sleep, withTimeout } from "../protocol/harness.mjs";
import { Container, newVolume, user } from "./image.mjs";

const token = "a-token-of-the-test";

let container;
before(
  async () => (container = await Container.start({ env: { CLOTHLAB_TOKEN: token, CLOTHLAB_VIEW_TOKEN: "look" } })),
);
after(() => container.stop());

async function operator(from = container, session = undefined) {
  const client = await Client.connect(from, { session });
  await client.request("auth", { token });
  return client;
}

test("it listens on every address, port 8080, and serves the page and /healthz", async () => {
  assert.equal(container.stdout, "listening on http://0.0.0.0:8080/\n");
  assert.equal((await container.get("/healthz")).status, 200);
  const page = await container.get("/");
  assert.equal(page.status, 200);
  assert.match(page.body.toString(), /<script type="module" src="\/?app\.js/);
  assert.equal((await container.get("/app.js")).status, 200);
});

test("it streams frames of the seed scene, computed by Mesa's software OpenGL", async () => {
  const client = await operator();
  assert.match((await client.notification("hello")).renderer, /llvmpipe/);
  await client.request("stream.subscribe");
  const first = await client.frame();
  assert.equal(first.vertexCount, 625);
  assert.ok((await client.frame((frame) => frame.time > first.time + 0.2)).sequence > first.sequence);
  await client.close();
});

test("the server is process 1, not root, without any capability, on a root it cannot write", async () => {
  const { Uid, Gid, Groups, CapEff, CapPrm, CapBnd, NoNewPrivs, NSpid } = container.status;
  assert.deepEqual(
    [Uid, Gid].map((ids) => ids.split("\t")),
    Array(2).fill(Array(4).fill(String(user))),
  );
  assert.ok(user > 0);
  assert.equal(Groups.trim(), "");
  for (const capabilities of [CapEff, CapPrm, CapBnd]) assert.equal(BigInt(`0x${capabilities}`), 0n);
  assert.equal(NoNewPrivs, "1");
  assert.equal(NSpid.split("\t").at(-1), "1");
  assert.equal(container.exec("id").stdout, `uid=${user}(clothlab) gid=${user}(clothlab) groups=${user}(clothlab)\n`);
  const { stdout } = container.exec("find", "/", "-xdev", "-writable", "!", "-type", "l");
  assert.equal(stdout, "/tmp\n/var/lib/clothlab\n");
});

test("shaders that Mesa has compiled are kept in the volume", async () => {
  const kept = readdirSync(container.volume, { recursive: true });
  assert.ok(
    kept.some((name) => name.startsWith("cache/mesa_shader_cache")),
    kept.join("\n"),
  );
});

test("the tokens are in no process's arguments", () => {
  const { stdout } = container.exec("bash", "-c", "cat /proc/[0-9]*/cmdline");
  assert.match(stdout, /^clothlab\0serve\0/);
  for (const secret of [token, "look"]) assert.ok(!stdout.includes(secret), stdout.replaceAll("\0", " "));
  assert.equal(container.environment.CLOTHLAB_TOKEN, token);
});

test("a client without a token sees nothing; a viewer's token lets it look", async () => {
  const client = await Client.connect(container);
  assert.equal((await client.refusal("scene.get")).code, -32001);
  assert.deepEqual(await client.request("auth", { token: "look" }), { role: "viewer" });
  await client.close();
});

test("without a token one is made, told with the address to open, and another at the next start", async () => {
  const tokens = [];
  for (let start = 0; start < 2; ++start) {
    const other = await Container.start({ args: ["--port", "8081", "--bind", "127.0.0.1"] });
    assert.equal(other.stdout, "listening on http://127.0.0.1:8081/\n");
    const [, made] = /no CLOTHLAB_TOKEN was given, so this one was made for this start: (\S+)\n/.exec(other.stderr);
    assert.match(made, /^[\w-]{24}$/);
    assert.match(other.stderr, /open http:\/\/127\.0\.0\.1:8080 /);
    const client = await Client.connect(other);
    assert.deepEqual(await client.request("auth", { token: made }), { role: "operator" });
    tokens.push(made);
    assert.equal((await other.stop()).code, 0);
  }
  assert.notEqual(tokens[0], tokens[1]);
});

test("a token is read from the file that CLOTHLAB_TOKEN_FILE names, its line break left out", async () => {
  const volume = newVolume();
  writeFileSync(join(volume, "token"), `${token}\n`);
  const other = await Container.start({
    args: ["serve", "--port=8081"],
    volume,
    env: { CLOTHLAB_TOKEN_FILE: "/var/lib/clothlab/token" },
  });
  const client = await operator(other);
  await client.close();
  assert.doesNotMatch(other.stderr, /token was given/);
  assert.equal((await other.stop()).code, 0);
});

test("a token file that is missing, empty, unreadable, or beside CLOTHLAB_TOKEN, is an error that says so", async () => {
  const volume = newVolume(),
    folder = "/var/lib/clothlab";
  writeFileSync(join(volume, "empty"), "\n");
  writeFileSync(join(volume, "locked"), "x");
  chmodSync(join(volume, "locked"), 0);
  for (const [env, expected] of [
    [{ CLOTHLAB_TOKEN_FILE: "/run/secrets/token" }, /CLOTHLAB_TOKEN_FILE: \/run\/secrets\/token is not a file; mount/],
    [{ CLOTHLAB_TOKEN_FILE: `${folder}/empty` }, /CLOTHLAB_TOKEN_FILE: .*empty is empty/],
    [{ CLOTHLAB_TOKEN_FILE: `${folder}/locked` }, new RegExp(`locked cannot be read by user ${user}`)],
    [{ CLOTHLAB_TOKEN_FILE: `${folder}/empty`, CLOTHLAB_TOKEN: "t" }, /both CLOTHLAB_TOKEN and CLOTHLAB_TOKEN_FILE/],
    [{ CLOTHLAB_TOKEN: "t", CLOTHLAB_VIEW_TOKEN_FILE: "/no" }, /CLOTHLAB_VIEW_TOKEN_FILE: \/no is not a file/],
  ]) {
    const { code, stdout, stderr } = await Container.finish({ args: ["serve", "--port", "8081"], env, volume });
    assert.equal(code, 2);
    assert.equal(stdout, "");
    assert.match(stderr, expected);
  }
});

test("any other command of clothlab runs too", async () => {
  const info = await Container.finish({ args: ["info"] });
  assert.equal(info.code, 0);
  assert.match(info.stdout, /^\* 0: llvmpipe/m);
  const run = await Container.finish({ args: ["run", "seed", "--time", "0.1", "--report", "/tmp/report.json"] });
  assert.equal(run.code, 0, run.stderr);
  assert.equal((await Container.finish({ args: ["no-such-command"] })).code, 2);
});

test("the health check succeeds while the server answers, and fails when it does not", async () => {
  const check = ["/usr/local/bin/healthcheck"];
  const well = container.exec(...check);
  assert.deepEqual([well.code, well.stdout], [0, "HTTP/1.1 200 OK\n"], well.stderr);

  const gone = await Container.finish({ command: [...check, "8082"] });
  assert.notEqual(gone.code, 0);

  // Answers as /healthz does when a session's thread hangs; later answers nothing at all.
  const listener = net
    .createServer((socket) => {
      socket.on("error", () => {}); // a client that reads one line and leaves resets the connection
      socket.end("HTTP/1.1 503 Service Unavailable\r\n\r\n");
    })
    .listen(8082);
  await once(listener, "listening");
  assert.equal((await Container.finish({ command: [...check, "8082"] })).code, 1);
  listener.removeAllListeners("connection");
  const silent = await Container.finish({ command: [...check, "8082"] });
  assert.equal(silent.code, 1);
  assert.match(silent.stderr, /no answer within 3 s/);
  listener.close();
});

test("with --tls-cert the health check asks by HTTPS", async () => {
  const volume = newVolume();
  const { key, certificate, made } = makeCertificate(volume);
  assert.ok(made, "openssl makes a certificate");
  for (const file of [key, certificate]) chownSync(file, user, user);
  const inside = "/var/lib/clothlab";
  const other = await Container.start({
    args: ["--port", "8081", "--tls-cert", `${inside}/certificate.pem`, "--tls-key", `${inside}/key.pem`],
    env: { CLOTHLAB_TOKEN: token },
    volume,
  });
  assert.equal(other.stdout, "listening on https://0.0.0.0:8081/\n");
  const well = other.exec("/usr/local/bin/healthcheck", "8081");
  assert.deepEqual([well.code, well.stdout], [0, "HTTP/1.1 200 OK\n"], well.stderr);
  const client = await Client.connect(other, { scheme: "wss" });
  await client.request("auth", { token });
  await client.close();
  assert.equal((await other.stop()).code, 0);
});

test("a session is restored in another container with the same volume", async () => {
  const volume = newVolume(),
    options = { args: ["--port", "8081"], env: { CLOTHLAB_TOKEN: token }, volume };
  let other = await Container.start(options);
  const before = await operator(other);
  await before.request("scene.patch", { patch: { gravity: [0, -1.6, 0] } });
  assert.equal((await other.stop()).code, 0);
  other = await Container.start(options);
  const client = await operator(other);
  assert.deepEqual((await client.request("scene.get")).document.gravity, [0, -1.6, 0]);
  await other.stop();
});

test("without a volume that can be written it serves, and says that sessions are not kept", async () => {
  const volume = newVolume();
  chownSync(volume, 0, 0);
  chmodSync(volume, 0o755);
  const other = await Container.start({ args: ["--port", "8081"], volume });
  assert.match(other.stderr, /\/var\/lib\/clothlab cannot be written, so sessions are not kept/);
  assert.equal((await other.get("/healthz")).status, 200);
  await other.stop();
});

test("SIGTERM: every viewer is told with 1001, and it ends with 0 within 5 s, even while the lab measures", async (context) => {
  const other = await Container.start({ args: ["--port", "8081"], env: { CLOTHLAB_TOKEN: token } });
  const viewers = [await operator(other), await operator(other), await operator(other, "second")];
  for (const viewer of viewers) await viewer.request("stream.subscribe");
  await viewers[0].request("lab.chart", {});
  await viewers[0].notification("lab.progress");
  await sleep(500);
  const closes = viewers.map((viewer) => withTimeout(viewer.closed, "a viewer's close"));
  const { code, seconds } = await other.stop();
  assert.equal(code, 0, other.stderr);
  context.diagnostic(`${seconds.toFixed(2)} s`);
  assert.ok(seconds < 5, `${seconds} s`);
  for (const close of closes) assert.equal((await close).code, 1001);
});
