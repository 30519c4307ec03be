import assert from "node:assert/strict";
import { randomBytes } from "node:crypto";
import { cpSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import http from "node:http";
import net from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { once } from "node:events";
import { after, before, test } from "node:test";
import { brotliDecompressSync, gunzipSync } from "node:zlib";
import gltf from "gltf-validator";
import { Client, Server, sleep, withTimeout } from "./harness.mjs";

async function eventually(look, good, what) {
  for (let tries = 0; tries < 12000; ++tries) {
    if (good(await look())) return;
    await sleep(10);
  }
  assert.fail(`waited for ${what}`);
}

let server;
before(async () => (server = await Server.start()));
after(() => server.stop());

test("the page comes as HTML, with the headers that keep it to itself", async () => {
  const { status, headers, body } = await server.get("/");
  assert.equal(status, 200);
  assert.equal(headers["content-type"], "text/html; charset=utf-8");
  assert.match(body.toString(), /<html/i);
  const policy = headers["content-security-policy"];
  assert.match(policy, /script-src 'self'(;|$)/);
  assert.match(policy, /default-src 'none'/);
  assert.doesNotMatch(policy, /unsafe|\*|https?:|wss?:/, "nothing inline, nothing from elsewhere");
  for (const [name, value] of [
    ["x-content-type-options", "nosniff"],
    ["x-frame-options", "SAMEORIGIN"],
    ["referrer-policy", "no-referrer"],
    ["cross-origin-opener-policy", "same-origin"],
    ["cross-origin-resource-policy", "same-origin"],
  ])
    assert.equal(headers[name], value);
  assert.match(headers["permissions-policy"], /camera=\(\)/);
  assert.doesNotMatch(
    body.toString(),
    /<script(?![^>]*src=)|<style|\son\w+=|\sstyle=/i,
    "the page has no inline code or style",
  );
});

test("the page comes compressed to who understands it, and not again to who has it", async () => {
  const plain = await server.get("/");
  for (const [accepts, coding, unpack] of [
    ["gzip", "gzip", gunzipSync],
    ["gzip, deflate, br", "br", brotliDecompressSync],
  ]) {
    const packed = await server.get("/", { "accept-encoding": accepts });
    assert.equal(packed.headers["content-encoding"], coding);
    assert.deepEqual(unpack(packed.body), plain.body);
  }
  assert.equal((await server.get("/index.html.br")).status, 404);
  const known = await server.get("/", { "if-none-match": plain.headers.etag });
  assert.equal(known.status, 304);
  assert.equal(known.body.length, 0);
});

test("HEAD answers as GET does, without the body", async () => {
  const [head, get] = [await server.get("/", {}, "HEAD"), await server.get("/")];
  assert.equal(head.status, 200);
  assert.equal(head.headers["content-length"], get.headers["content-length"]);
  assert.equal(head.body.length, 0);
});

test("a missing file is a readable 404; nothing outside the page's folder can be reached", async () => {
  for (const path of [
    "/nothing",
    "/web",
    "/assets/",
    "/..%2f..%2fetc/passwd",
    "/%2e%2e/%2e%2e/CMakeLists.txt",
    "/%252e%252e/etc/passwd",
    "/..%5c..%5cetc/passwd",
    "//etc/passwd",
    "/.git/config",
  ]) {
    const { status, body } = await server.get(path);
    assert.equal(status, 404, path);
    assert.ok(body.length > 0);
  }
  // libwebsockets 4.3 (Debian 13) closes the connection upon a NUL in a target, 4.1 (Debian 12) passes it on.
  const status = await server.get("/%00/etc/passwd").then(
    (answer) => answer.status,
    (error) => error.code,
  );
  assert.ok([404, "ECONNRESET"].includes(status), String(status));
  const socket = net.connect(server.port, "127.0.0.1");
  await once(socket, "connect");
  socket.write("GET /../../../../etc/passwd HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  let text = "";
  socket.on("data", (data) => (text += data));
  await withTimeout(once(socket, "close"), "the answer");
  assert.doesNotMatch(text, /root:/);
});

test("a symbolic link in the page's folder is not followed", async () => {
  const data = mkdtempSync(join(tmpdir(), "clothlab-data-"));
  try {
    const root = fileURLToPath(new URL("../../", import.meta.url));
    for (const part of ["shaders", "server/scene/presets", "web/dist"])
      cpSync(join(root, part), join(data, part), { recursive: true });
    symlinkSync("/etc/passwd", join(data, "web/dist/passwd.txt"));
    symlinkSync("/etc", join(data, "web/dist/etc"));
    process.env.CLOTHLAB_DATA = data;
    const linked = await Server.start().finally(() => delete process.env.CLOTHLAB_DATA);
    for (const path of ["/passwd.txt", "/etc/passwd", "/etc/hostname"])
      assert.equal((await linked.get(path)).status, 404, path);
    assert.equal((await linked.get("/")).status, 200);
    await linked.stop();
  } finally {
    rmSync(data, { recursive: true });
  }
});

test("the clients for scripts are served as they are in the source, whether the page is built or not", async () => {
  for (const [path, type] of [
    ["/clothlab.py", "text/x-python; charset=utf-8"],
    ["/clothlab.mjs", "text/javascript; charset=utf-8"],
  ]) {
    const { status, headers, body } = await server.get(path);
    assert.equal(status, 200, path);
    assert.equal(headers["content-type"], type);
    assert.deepEqual(body, readFileSync(new URL(`../../web/clients${path}`, import.meta.url)));
    assert.equal(headers["cache-control"], "no-cache", "another version of the server has another client");
    assert.equal((await server.get(path, { "if-none-match": headers.etag })).status, 304);
    assert.equal((await server.get(path, { "accept-encoding": "gzip" })).headers["content-encoding"], "gzip");
  }
  assert.equal((await server.get("/README.md")).status, 404);
});

test("pages of an --allow-origin may frame the page and read the answers; no others", async (t) => {
  const allowed = ["http://localhost:8888", "https://notebook.example"];
  const friendly = await Server.start(...allowed.flatMap((of) => ["--allow-origin", of]), "--allow-origin", "a;b *");
  t.after(() => friendly.stop());
  const { headers } = await friendly.get("/");
  assert.match(
    headers["content-security-policy"],
    /frame-ancestors 'self' http:\/\/localhost:8888 https:\/\/notebook\.example$/,
    "what is no origin gets into no header",
  );
  assert.equal(headers["x-frame-options"], undefined, "it can name no origin");
  const reader = async (from, origin, path = "/clothlab.mjs") =>
    (await from.get(path, { origin })).headers["access-control-allow-origin"];
  for (const origin of allowed) {
    assert.equal(await reader(friendly, origin), origin);
    assert.equal(await reader(friendly, origin, "/api/scene"), origin);
    assert.equal(await reader(server, origin), undefined);
  }
  for (const origin of ["http://localhost:8889", "https://localhost:8888", "null", "a;b *"])
    assert.equal(await reader(friendly, origin), undefined, origin);
  assert.equal(headers["access-control-allow-origin"], undefined);
});

const everywhere = ["/", "/ws", "/nothing", "/metrics", "/api/scene", "/api/mesh.obj", "/api/snapshot.png"];

test("without a token nothing but /healthz is answered under another name than an address, localhost or an --allow-origin's", async (t) => {
  const friendly = await Server.start(
    "--allow-origin",
    "https://Friend.example",
    "--allow-origin",
    "http://near.example:81",
  );
  t.after(() => friendly.stop());
  const ask = async (host, path = "/") => (await friendly.get(path, { host })).status;
  for (const path of everywhere) {
    const { status, headers, body } = await friendly.get(path, { host: "rebound.example:8080" });
    assert.equal(status, 403, path);
    assert.equal(headers["content-type"], "text/plain; charset=utf-8");
    assert.match(
      body.toString(),
      /not as rebound\.example:8080: .*localhost.*--allow-origin http:\/\/rebound\.example:8080.*--token/,
    );
  }
  assert.equal(await ask("rebound.example", "/healthz"), 200);
  for (const host of [
    "127.0.0.1",
    "127.0.0.1:8080",
    "192.0.2.7:1",
    "[::1]",
    "[::1]:8080",
    "[2001:DB8::7]",
    "localhost",
    "LocalHost:8080",
    "localhost.",
    "cloth.localhost",
    "a.b.localhost.:80",
    "friend.example",
    "FRIEND.example",
    "near.example:81",
  ])
    assert.equal(await ask(host), 200, host);
  for (const host of [
    "127.0.0.1.evil.example",
    "127.0.0.1.",
    "localhost.evil.example",
    "evil-localhost",
    "localhost..",
    "localhost:80:80",
    "localhost:",
    "localhost:x",
    ":80",
    ".",
    "[::1",
    "::1",
    "[::1]x",
    "x[::1]",
    "[::1]:x",
    "[]",
    "[127.0.0.1]",
    "[fe80::1%25lo]",
    "127.1",
    "1.2.3.4.5",
    "0x7f000001",
    "2130706433",
    "user@127.0.0.1",
    "user@cloth.localhost",
    "evil.example/.localhost",
    "friend.example:80",
    "friend.example.",
    "x.friend.example",
    "near.example",
    "https://friend.example",
  ])
    assert.equal(await ask(host), 403, host);
  const { body } = await friendly.get("/", { host: `<b>${"x".repeat(1000)}` });
  assert.match(body.toString(), /not as \?b\?x{197}: /);
});

test("a client that sends no Host is no browser, and is answered", async () => {
  const socket = net.connect(server.port, "127.0.0.1");
  socket.write("GET /api/scene HTTP/1.0\r\n\r\n");
  const [data] = await withTimeout(once(socket, "data"), "the answer");
  assert.match(data.toString(), /^HTTP\/1.\d 200/);
  socket.destroy();
});

test("with a token any name will do: a hostile site's page does not know it", async (t) => {
  const guarded = await Server.start("--token", "secret");
  t.after(() => guarded.stop());
  const headers = { host: "cloth.example" };
  assert.equal((await guarded.get("/", headers)).status, 200);
  assert.equal((await guarded.get("/api/scene", headers)).status, 401);
  assert.equal((await guarded.get("/api/scene", { ...headers, authorization: "Bearer secret" })).status, 200);
  const client = await Client.connect(guarded, { headers: { ...headers, origin: "http://cloth.example" } });
  assert.equal((await client.request("auth", { token: "secret" })).role, "operator");
  await client.close();
});

test("other verbs than GET and HEAD answer 405 with what is allowed", async () => {
  for (const method of ["POST", "PUT", "DELETE"]) {
    const { status, headers } = await server.get("/api/scene", { "content-length": "0" }, method);
    assert.equal(status, 405, method);
    assert.equal(headers.allow, "GET, HEAD");
  }
});

test("/ws without an upgrade says what it is, or why a handshake would be refused", async () => {
  const { status, body } = await server.get("/ws");
  assert.equal(status, 426);
  assert.match(body.toString(), /clothlab\.v1/);
  const refused = await server.get("/ws?session=a%20b");
  assert.equal(refused.status, 400);
  assert.match(refused.body.toString(), /^a session's name has/);
});

test("/healthz is 200 while the sessions' threads beat", async () => {
  const { status, body } = await server.get("/healthz");
  assert.equal(status, 200);
  assert.equal(body.toString(), "ok\n");
});

test("/metrics counts sessions, clients, viewers, steps, frames and bytes, and the latency of frames", async () => {
  const client = await Client.connect(server);
  await client.request("stream.subscribe");
  await client.until(
    () => client.frames.slice(10),
    () => true,
    "10 frames",
  );
  const text = (await server.get("/metrics")).body.toString();
  const value = (name) => Number(new RegExp(`^${name} (\\S+)$`, "m").exec(text)[1]);
  assert.equal(value("clothlab_sessions"), 1);
  assert.equal(value("clothlab_clients"), 1);
  assert.equal(value("clothlab_viewers"), 1);
  assert.ok(value("clothlab_steps_total") > 0);
  assert.ok(value("clothlab_frames_sent_total") >= 10);
  assert.ok(value("clothlab_bytes_sent_total") > 10 * 5000);
  const count = value("clothlab_frame_latency_seconds_count");
  assert.ok(count >= 10);
  const buckets = [...text.matchAll(/^clothlab_frame_latency_seconds_bucket\{le="(\S+)"\} (\S+)$/gm)].map(
    ([, bound, below]) => [bound === "+Inf" ? Infinity : Number(bound), Number(below)],
  );
  const holds95 = buckets.findIndex(([, below]) => below >= 0.95 * count);
  const p95 = value("clothlab_frame_latency_p95_seconds");
  assert.ok(p95 > (buckets[holds95 - 1]?.[0] ?? 0) && p95 <= buckets[holds95][0], `${p95} s`);
  await client.close();
});

/// The samples of a metrics text, by name: [{labels, value}]; fails if the text breaks a rule of Prometheus's format or
/// naming.
function readMetrics(text) {
  const types = new Map(),
    samples = new Map();
  for (const line of text.trimEnd().split("\n")) {
    const comment = /^# (HELP|TYPE) ([a-z][a-z0-9_]*) (.+)$/.exec(line);
    if (comment) {
      const [, what, name, rest] = comment;
      if (what === "TYPE") types.set(name, rest);
      assert.match(name, /^(?:clothlab|process)_/);
      assert.equal(
        types.get(name) === "counter" || what === "HELP",
        name.endsWith("_total") || what === "HELP",
        `${name}: only counters end in _total`,
      );
      assert.doesNotMatch(
        name,
        /_(ms|us|milliseconds|microseconds|count|sum|bucket)(_|$)/,
        "base units, and no name of a histogram's own",
      );
      continue;
    }
    const sample = /^([a-z_0-9]+)(?:\{([^}]*)\})? (\S+)$/.exec(line);
    assert.ok(sample, line);
    const [, name, labels = "", value] = sample;
    const family = types.has(name) ? name : name.replace(/_(bucket|sum|count)$/, "");
    assert.ok(types.has(family), `${name} has a TYPE`);
    assert.ok(Number.isFinite(Number(value)), line);
    if (!samples.has(name)) samples.set(name, []);
    samples.get(name).push({
      labels: Object.fromEntries([...labels.matchAll(/([a-z_]+)="([^"]*)"/g)].map(([, key, of]) => [key, of])),
      value: Number(value),
    });
  }
  for (const [name, type] of types) {
    if (type !== "histogram") continue;
    const of = (labels) => JSON.stringify({ ...labels, le: undefined });
    for (const { labels, value } of samples.get(`${name}_count`) ?? []) {
      const buckets = samples.get(`${name}_bucket`).filter((bucket) => of(bucket.labels) === of(labels));
      const edges = buckets.map((bucket) => Number(bucket.labels.le.replace("+Inf", "Infinity"))),
        counts = buckets.map((bucket) => bucket.value);
      assert.deepEqual(
        edges,
        [...new Set(edges)].sort((a, b) => a - b),
      );
      assert.deepEqual(
        counts,
        [...counts].sort((a, b) => a - b),
        "buckets are cumulative",
      );
      assert.deepEqual([edges.at(-1), counts.at(-1)], [Infinity, value]);
    }
  }
  return samples;
}

test("/metrics follows Prometheus' format, and has what each pass takes on the GPU and each method to its answer", async () => {
  const client = await Client.connect(server);
  await client.request("stream.subscribe");
  await client.request("ping", { t: 1 });
  assert.equal((await client.refusal("no.such.method")).code, -32601);
  const told = await client.notification(
    "sim.status",
    ({ pass_seconds }) => pass_seconds.symplectic_euler > 0 && pass_seconds.neighbour_search > 0,
  );
  assert.deepEqual(Object.keys(told.pass_seconds).sort(), [...told.passes].sort(), "a listed pass is a dispatched one");
  const counts = async (name, label) => {
    const samples = readMetrics((await server.get("/metrics")).body.toString());
    return Object.fromEntries((samples.get(`${name}_count`) ?? []).map(({ labels, value }) => [labels[label], value]));
  };
  const requests = await counts("clothlab_request_seconds", "method");
  assert.ok(requests.ping >= 1 && requests["stream.subscribe"] >= 1);
  assert.ok(!("no.such.method" in requests), "no label of a client's choice");
  let passes = {};
  for (let tries = 0; tries < 100 && !(passes.diagnose && passes.pack_frame); ++tries) {
    passes = await counts("clothlab_gpu_pass_seconds", "pass");
    await sleep(100);
  }
  for (const pass of ["symplectic_euler", "neighbour_search", "diagnose", "pack_frame"])
    assert.ok(passes[pass] >= 1, pass);
  assert.ok(!("strain_limit" in passes), "the seed has none");
  // A stage that the scene no longer has is no longer timed.
  await client.request("scene.patch", { patch: { self_collision: null } });
  await client.notification(
    "sim.status",
    ({ passes, pass_seconds }) =>
      !passes.includes("neighbour_search") &&
      !("neighbour_search" in pass_seconds) &&
      pass_seconds.symplectic_euler > 0,
  );
  await client.request("scene.load", { preset: "seed" });
  await client.close();
});

test("/api/scene is the document as scene.get answers it", async () => {
  const client = await Client.connect(server);
  const { document } = await client.request("scene.get");
  const { status, headers, body } = await server.get("/api/scene");
  assert.equal(status, 200);
  assert.equal(headers["content-type"], "application/json");
  assert.deepEqual(JSON.parse(body), document);
  await client.close();
});

test("/api/mesh.obj is the present cloth", async () => {
  const client = await Client.connect(server);
  await client.request("sim.pause");
  await client.request("sim.reset");
  const { status, body } = await server.get("/api/mesh.obj?session=main");
  assert.equal(status, 200);
  const lines = body.toString().split("\n");
  const vertices = lines.filter((line) => line.startsWith("v ")).map((line) => line.split(" ").slice(1).map(Number));
  assert.equal(vertices.length, 625);
  assert.deepEqual(vertices[0], [-0.5, 1, 0]);
  const faces = lines.filter((line) => line.startsWith("f "));
  assert.equal(faces.length, 1152);
  assert.ok(faces.every((face) => face.match(/\d+/g).every((index) => index >= 1 && index <= 625)));
  await client.request("sim.play");
  await client.close();
});

test("/api/mesh.glb is the present cloths as binary glTF", async () => {
  const { status, headers, body } = await server.get("/api/mesh.glb?session=main");
  assert.equal(status, 200);
  assert.equal(headers["content-type"], "model/gltf-binary");
  assert.equal(body.subarray(0, 4).toString(), "glTF");
  assert.equal(body.readUInt32LE(8), body.length);
  const { issues } = await gltf.validateBytes(new Uint8Array(body));
  assert.equal(issues.numErrors + issues.numWarnings, 0);
});

test("the API of a session that is not open answers 404 and opens none", async () => {
  for (const path of ["/api/scene", "/api/mesh.obj", "/api/mesh.glb", "/api/snapshot.png"])
    assert.equal((await server.get(`${path}?session=nobody`)).status, 404);
  assert.equal(await server.metric("clothlab_sessions"), 1);
});

test("/api/snapshot.png is a picture of the size asked for", async () => {
  const { status, headers, body } = await server.get("/api/snapshot.png?width=320&height=200");
  assert.equal(status, 200);
  assert.equal(headers["content-type"], "image/png");
  assert.equal(body.subarray(1, 4).toString(), "PNG");
  assert.equal(body.readUInt32BE(16), 320);
  assert.equal(body.readUInt32BE(20), 200);
  for (const query of ["width=0&height=10", "width=10&height=5000", "width=x&height=10", "width=1e2&height=10"])
    assert.equal((await server.get(`/api/snapshot.png?${query}`)).status, 400, query);
});

/// Asks for `count` pictures at once; `answers` collects the answers.
function askForPictures(count, side) {
  const answers = [];
  const requests = Array.from({ length: count }, () =>
    http.get(
      { host: "127.0.0.1", port: server.port, path: `/api/snapshot.png?width=${side}&height=${side}` },
      (response) => {
        answers.push({ status: response.statusCode, again: response.headers["retry-after"] });
        response.resume();
      },
    ),
  );
  for (const request of requests) request.on("error", () => {});
  return { answers, abandon: () => requests.forEach((request) => request.destroy()) };
}
const exportsWaiting = () => server.metric("clothlab_exports_waiting");

test("pictures keep nobody waiting: the session answers while they are made, and of twelve at once four are refused", async () => {
  const client = await Client.connect(server);
  const { answers, abandon } = askForPictures(12, 2048);
  await eventually(
    () => answers.length,
    (count) => count >= 4,
    "the refusals",
  );
  await client.request("scene.patch", { patch: { name: "beside pictures" } });
  assert.deepEqual(
    answers,
    Array(4).fill({ status: 503, again: "1" }),
    "the session answered before the first picture was made",
  );
  abandon();
  await eventually(exportsWaiting, (count) => count === 0, "the pictures to be dropped");
  await client.close();
});

test("a picture that nobody waits for any more is not made", async () => {
  const before = await server.metric("clothlab_exports_total");
  const { abandon } = askForPictures(8, 1024);
  await eventually(exportsWaiting, (count) => count >= 4, "the pictures to wait");
  abandon();
  await eventually(exportsWaiting, (count) => count === 0, "the pictures to be dropped");
  const made = (await server.metric("clothlab_exports_total")) - before;
  assert.ok(made < 8, `${made} were made`);
  assert.equal((await server.get("/api/mesh.obj")).status, 200);
});

/// Reads what `path` answers at this rate [bytes/s], as a slow line does; `stop` ends the reading after so many bytes.
async function readSlowly(port, path, rate, stop = Number.POSITIVE_INFINITY) {
  const socket = net.connect({ port, host: "127.0.0.1" });
  let bytes = 0;
  socket.on("error", () => {});
  const closed = once(socket, "close");
  await once(socket, "connect");
  socket.write(`GET ${path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n`);
  const from = performance.now();
  socket.on("data", (data) => {
    bytes += data.length;
    socket.pause();
    if (bytes < stop) setTimeout(() => socket.resume(), Math.max(0, from + (1000 * bytes) / rate - performance.now()));
  });
  return { socket, closed, bytes: () => bytes };
}

test("who reads slowly but steadily gets all of an answer, however long it takes; who reads nothing is cut off", async (t) => {
  const data = mkdtempSync(join(tmpdir(), "clothlab-data-"));
  t.after(() => rmSync(data, { recursive: true, force: true }));
  const root = fileURLToPath(new URL("../../", import.meta.url));
  for (const part of ["shaders", "server/scene/presets"])
    cpSync(join(root, part), join(data, part), { recursive: true });
  const size = 16 * 1024 * 1024;
  cpSync(join(root, "web/clients"), join(data, "web/dist"), { recursive: true });
  writeFileSync(join(data, "web/dist/large.png"), randomBytes(size));
  process.env.CLOTHLAB_DATA = data;
  const impatient = await Server.start("--header-timeout", "1", "--idle-timeout", "2").finally(
    () => delete process.env.CLOTHLAB_DATA,
  );
  t.after(() => impatient.stop());
  const begun = performance.now();
  const [slow, silent] = await Promise.all([
    readSlowly(impatient.port, "/large.png", size / 5), // 5 s, where silence may last 2
    readSlowly(impatient.port, "/large.png", size, 100_000),
  ]);
  await withTimeout(slow.closed, "all of it");
  assert.ok(slow.bytes() > size, `${slow.bytes()} bytes`);
  assert.ok(performance.now() - begun > 4000, "it was slow");
  silent.socket.resume();
  silent.socket.removeAllListeners("data").on("data", (more) => (silent.rest = (silent.rest ?? 0) + more.length));
  await withTimeout(silent.closed, "the silent one to be closed");
  assert.ok(silent.bytes() + (silent.rest ?? 0) < size, "it did not get all");
});
