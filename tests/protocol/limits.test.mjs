// The limits that an operator sets when starting the server: what each refuses, the error's text, and what goes on.
import assert from "node:assert/strict";
import { once } from "node:events";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import net from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, afterEach, test } from "node:test";
import { Client, patience, runProgram, Server, sleep, withTimeout } from "./harness.mjs";

const servers = [];
afterEach(() => Promise.all(servers.splice(0).map((server) => server.stop())));

async function start(...args) {
  const server = await Server.start(...args);
  servers.push(server);
  return server;
}

/// A bare connection, and a function that tells if the server has closed it.
async function socketTo(server, options = {}) {
  const socket = net.connect({ port: server.port, host: "127.0.0.1", ...options });
  socket.over = new Promise((resolve) => {
    socket.on("close", resolve);
    socket.on("error", () => {});
  });
  await once(socket, "connect");
  return socket;
}

const upgrade =
  "GET /ws HTTP/1.1\r\nHost: localhost\r\nConnection: upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n" +
  "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Protocol: clothlab.v1\r\n\r\n";

const limits = {
  "--max-sessions": 1,
  "--max-clients": 1,
  "--max-clients-per-address": 1,
  "--max-message-bytes": 1024,
  "--max-message-rate": 10,
  "--max-json-depth": 8,
  "--max-vertices": 4,
  "--max-springs": 4,
  "--max-recording-bytes": 10000,
  "--max-lab-seconds": 1,
  "--header-timeout": 1,
  "--auth-timeout": 1,
  "--max-wrong-tokens": 1,
  "--idle-timeout": 2,
  "--unwatched-timeout": 1,
};

test("each limit has a flag with a default in the help, and refuses less than its least value with what is allowed", async () => {
  const { stdout } = await runProgram(["serve", "--help"]);
  for (const [flag, least] of Object.entries(limits)) {
    assert.match(stdout, new RegExp(`${flag} N\\b.*\\d`), flag);
    const { code, stderr } = await runProgram(["serve", "--port", "0", flag, String(least - 1)]);
    assert.equal(code, 2, flag);
    assert.match(stderr, new RegExp(`${flag}: ${least - 1}, which is no whole number from ${least} to \\d+;`), flag);
  }
});

test("one client more than --max-clients-per-address is refused, another address is not", async () => {
  const server = await start("--max-clients-per-address", "2");
  const clients = [await Client.connect(server), await Client.connect(server)];
  assert.equal((await clients[0].notification("hello")).limits.clients_per_address, 2);
  await assert.rejects(Client.connect(server), { status: 503 });
  const reason = await server.get("/ws?session=main"); // for a page, which is not told the handshake's answer
  assert.equal(reason.status, 503);
  assert.match(
    reason.body.toString(),
    /^this address has as many clients as it may, 2; see --max-clients-per-address$/m,
  );
  const elsewhere = await socketTo(server, { localAddress: "127.0.0.2" });
  elsewhere.write(upgrade);
  const [answer] = await withTimeout(once(elsewhere, "data"), "the handshake's answer");
  assert.match(answer.toString(), /^HTTP\/1.1 101/);
  elsewhere.destroy();
  await clients[0].close();
  clients[0] = await Client.connect(server);
  for (const client of clients) await client.close();
});

test("an address may have twice as many connections as clients; more are closed unread, until others end", async () => {
  const server = await start("--max-clients-per-address", "2");
  const sockets = [];
  for (let i = 0; i < 4; ++i) sockets.push(await socketTo(server));
  const beyond = await socketTo(server);
  await withTimeout(beyond.over, "the fifth to be closed");
  assert.ok(sockets.every((socket) => !socket.destroyed));
  const other = await socketTo(server, { localAddress: "127.0.0.2" });
  other.write("GET /healthz HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  assert.match((await withTimeout(once(other, "data"), "an answer elsewhere")).toString(), /200/);
  for (const socket of [...sockets, other]) socket.destroy();
  for (const until = Date.now() + patience; ; ) {
    const answer = await server.get("/healthz").catch(() => null);
    if (answer?.status === 200) break;
    assert.ok(Date.now() < until, "no room was made");
    await sleep(50);
  }
});

test("a message larger than --max-message-bytes closes with 1009, one as large is answered", async () => {
  const server = await start("--max-message-bytes", "2048");
  const client = await Client.connect(server);
  assert.equal((await client.notification("hello")).limits.message_bytes, 2048);
  const frame = (size) => {
    const empty = JSON.stringify({ jsonrpc: "2.0", id: 1, method: "ping", params: { t: "" } });
    return JSON.stringify({ jsonrpc: "2.0", id: 1, method: "ping", params: { t: "x".repeat(size - empty.length) } });
  };
  client.socket.send(frame(2048));
  await client.request("ping", { t: 2 });
  client.socket.send(frame(2049));
  const { code, reason } = await withTimeout(client.closed, "the close");
  assert.equal(code, 1009);
  assert.match(reason, /2048 bytes/);
});

test("more messages than --max-message-rate allows are a flood, closed with 1008; a burst of twice as many is not", async () => {
  const server = await start("--max-message-rate", "10");
  const client = await Client.connect(server);
  await Promise.all(Array.from({ length: 19 }, (_, t) => client.request("ping", { t })));
  for (let i = 0; i < 30; ++i) client.notify("ping", { t: i });
  assert.equal((await withTimeout(client.closed, "the close")).code, 1008);
});

test("a long message counts as many short ones: it is answered, and the next one is too many", async () => {
  const server = await start("--max-message-rate", "10");
  const client = await Client.connect(server);
  const t = "x".repeat(50_000); // two hundred times 256 bytes: paid off in 18 s
  assert.deepEqual(await client.request("ping", { t }), { t });
  client.notify("ping", {});
  const { code, reason } = await withTimeout(client.closed, "the close");
  assert.equal(code, 1008);
  assert.match(reason, /too many messages/);
});

test("a message nested deeper than --max-json-depth answers -32700 and the connection lives", async () => {
  const server = await start("--max-json-depth", "8");
  const client = await Client.connect(server);
  // The message and its params are two of the levels.
  const nested = (depth) => JSON.parse("[".repeat(depth) + "]".repeat(depth));
  await client.request("ping", { t: nested(6) });
  client.notify("ping", { t: nested(7) });
  const { error } = await client.until(
    () => client.messages,
    (m) => m.error,
    "the refusal",
  );
  assert.equal(error.code, -32700);
  assert.match(error.message, /8 levels/);
  await client.request("ping", { t: 1 });
  await client.close();
});

test("a scene beyond --max-vertices or --max-springs is refused with the number it has, and the one that runs is kept", async () => {
  const springs = 2 * 25 * 24 + 2 * 24 * 24 + 2 * 25 * 23; // of the seed
  const server = await start("--max-vertices", "625", "--max-springs", String(springs));
  const client = await Client.connect(server);
  const columns = (count) =>
    client.refusal("scene.patch", { patch: [{ op: "replace", path: "/cloths/0/mesh/grid/columns", value: count }] });
  const error = await columns(26);
  assert.equal(error.code, -32602);
  assert.deepEqual([error.data.path, error.data.found], ["/cloths", "650 vertices in all cloths together"]);
  assert.match(error.data.allowed, /at most 625 \(--max-vertices\)/);
  const mesh = {
    vertices: [
      [0, 0, 0],
      [1, 0, 0],
      [0, 0, 1],
      [1, 0, 1],
    ],
    triangles: Array.from({ length: 1000 }, () => [0, 1, 2]),
  };
  const many = await client.refusal("scene.load", {
    scene: { version: 1, cloths: [{ mesh, material: { shear: 0 } }] },
  });
  assert.match(many.data.allowed, /--max-springs/);
  assert.equal((await client.request("scene.get")).document.cloths[0].mesh.grid.columns, 25);
  await client.nextNotification("sim.status", (status) => status.playing);
  await client.close();

  for (const [flag, most] of [
    ["--max-vertices", 624],
    ["--max-springs", springs - 1],
  ]) {
    const { code, stderr } = await runProgram(["serve", "--port", "0", flag, String(most)]);
    assert.equal(code, 2, flag);
    assert.match(stderr, new RegExp(`/cloths: .* at most ${most} \\(${flag}\\)`));
  }
});

test("a scene that takes more than --max-memory is refused with its number, whoever brings it, and the one that runs is kept", async () => {
  const cotton = (side, method = "symplectic_euler") => ({
    version: 1,
    cloths: [{ mesh: { grid: { columns: side, rows: side } }, material: { fabric: "cotton" } }],
    solver: { method, dt: 1e-6 },
  });
  const server = await start("--max-memory", "2G");
  const client = await Client.connect(server);
  const refused = async (client, method, params, path = "/cloths") => {
    const { code, data } = await client.refusal(method, params);
    assert.equal(code, -32602);
    assert.equal(data.path, path);
    assert.match(data.found, /^\d+ vertices, which take \d\.\d\d GB of memory$/);
    assert.match(
      data.allowed,
      /^at most [\d.]+ [GM]B, which are left of 1\.83 GB for all scenes .*a smaller scene.*--max-memory$/,
    );
    assert.ok(data.memory.needed > data.memory.left);
  };
  await refused(client, "scene.load", { scene: cotton(1024, "rk4") });
  const [op, value] = ["replace", 1020];
  const patch = ["columns", "rows"].map((side) => ({ op, path: `/cloths/0/mesh/grid/${side}`, value }));
  await refused(client, "scene.patch", { patch });
  const second = await Client.connect(server, { session: "second" });
  await second.notification("scene");
  await refused(second, "scene.patch", { patch });
  assert.equal((await second.request("scene.get")).document.cloths[0].mesh.grid.columns, 25);
  for (const each of [client, second]) await each.nextNotification("sim.status", (status) => status.playing);
  const memory = await server.metric("clothlab_memory_simulations_bytes");
  assert.ok(memory > 20e6 && memory < 60e6, `${memory}`); // two scenes of 625 vertices
  assert.equal(await server.metric("clothlab_memory_limit_bytes"), 2 ** 31);
  await client.close();
  await second.close();
});

test("what does not fit --max-memory is refused with its number; who reads nothing shares one copy of a message", async () => {
  const server = await start("--max-memory", "256M");
  const client = await Client.connect(server);
  const grid = { columns: 160, rows: 160 };
  const material = { model: "springs", structural: 100, shear: 50, bend: 10 };
  const solver = { method: "symplectic_euler", dt: 1e-5 };
  await client.request("scene.load", { scene: { version: 1, cloths: [{ mesh: { grid }, material }], solver } });
  await client.request("sim.pause");

  const recording = await client.refusal("record.start", { rate: 60 });
  assert.equal(recording.code, -32002);
  assert.match(
    recording.message,
    /\d+ MB for recordings, where 38 MB are left; at most 38 MB of them, in a server of 268 MB/,
  );
  const { job } = await client.request("lab.simplify", {});
  const { state, error } = await client.labResult(job);
  assert.equal(state, "failed");
  assert.match(error.found, /^25600 vertices, which take \d+ MB of memory$/);
  assert.match(error.allowed, /^at most \d+ MB, which are left of 136 MB/);
  const picture = await server.get("/api/snapshot.png?width=4096&height=4096");
  assert.equal(picture.status, 503);
  assert.match(picture.body.toString(), /8\d\d MB for simulations, where \d+ MB are left/);

  const downloads = () => server.metric("clothlab_memory_downloads_bytes");
  const downloadsAre = async (bytes) => {
    for (const until = Date.now() + patience; (await downloads()) !== bytes; await sleep(50))
      assert.ok(Date.now() < until, `${await downloads()} bytes of downloads`);
  };
  const viewers = await Promise.all(Array.from({ length: 5 }, () => Client.connect(server)));
  for (const viewer of viewers) {
    viewer.notify("stream.subscribe", { encoding: "q16", rate: 10, in_flight: 1 });
    viewer.socket.pause();
  }
  const topology = 64 + 8 + 8 + 12 * 2 * 159 * 159 + 8 * 160 * 160;
  await downloadsAre(topology);
  await client.statuses(5);
  assert.equal(await downloads(), topology, "once for all five");
  for (const viewer of viewers) viewer.socket.resume();
  for (const viewer of viewers) assert.equal((await viewer.frame()).vertexCount, 25600);
  await downloadsAre(0);

  const stalled = [];
  let first = "";
  for (let i = 0; i < 12 && !first.startsWith("HTTP/1.1 503"); ++i) {
    const socket = await socketTo(server);
    stalled.push(socket);
    socket.write("GET /api/mesh.obj HTTP/1.1\r\nHost: localhost\r\n\r\n");
    [first] = (await withTimeout(once(socket, "data"), "an answer")).map(String);
    socket.pause();
  }
  assert.match(first, /^HTTP\/1\.1 503[^]*\d MB for downloads, where \d+ MB are left; at most 19 MB of them/);
  assert.ok(stalled.length > 2, "some fit");
  for (const socket of stalled) socket.destroy();
  await downloadsAre(0);
  assert.equal((await server.get("/api/mesh.obj")).status, 200);
  for (const each of [client, ...viewers]) await each.close();
});

test("--max-memory is a size of at least 256 MiB, and a scene that takes more does not start the server", async () => {
  for (const size of ["255M", "1000", "2GB", "-1G", "much"]) {
    const { code, stderr } = await runProgram(["serve", "--port", "0", "--max-memory", size]);
    assert.equal(code, 2, size);
    assert.match(stderr, /no size of at least 256M/);
  }
  const scene = [
    "--scene",
    "drape",
    "--set",
    "/cloths/0/mesh/grid/columns=1000",
    "--set",
    "/cloths/0/mesh/grid/rows=1000",
  ];
  const { code, stderr } = await runProgram(["serve", "--port", "0", ...scene, "--max-memory", "256M"]);
  assert.equal(code, 2);
  assert.match(stderr, /1000000 vertices, which take \d\.\d\d GB of memory; at most \d+ MB/);
});

test("a server whose memory has no room for all --max-sessions of its scene says so at the start", async () => {
  const warning =
    /level=warning event=limit_not_kept limit=--max-sessions of=100 holds=(\d+) why="a session .* MB of memory/;
  const server = await start("--max-memory", "256M", "--max-sessions", "100");
  const [, holds] = warning.exec(server.stderr) ?? assert.fail(server.stderr);
  assert.ok(Number(holds) >= 2 && Number(holds) < 20, holds);
  const fitting = await start("--max-memory", "256M", "--max-sessions", holds);
  assert.doesNotMatch(fitting.stderr, /limit_not_kept/);
});

test("a measurement that takes longer than --max-lab-seconds ends with what it found and why", async () => {
  const server = await start("--max-lab-seconds", "1");
  const client = await Client.connect(server);
  const { job } = await client.request("lab.chart", { budget: 600, time: 1 });
  const { state, error } = await client.labResult(job);
  assert.equal(state, "failed");
  assert.match(error.found, /more than 1 s/);
  await client.close();
});

test("headers that do not come within --header-timeout, however they dribble, close the connection", async () => {
  const server = await start("--header-timeout", "1");
  const client = await Client.connect(server);
  const [silent, slow] = [await socketTo(server), await socketTo(server)];
  slow.write("GET / HTTP/1.1\r\n");
  const dribble = setInterval(() => slow.destroyed || slow.write("X-Slow: 1\r\n"), 200);
  await withTimeout(Promise.all([silent.over, slow.over]), "both to be closed");
  clearInterval(dribble);
  await client.statuses(15);
  await client.request("ping", { t: 1 });
  await client.close();
});

test("a connection that is kept for one request after the other lives as long as it asks, and no request may dribble", async () => {
  const server = await start("--header-timeout", "1");
  const socket = await socketTo(server);
  let answers = "";
  socket.on("data", (data) => (answers += data));
  const answered = () => answers.split("HTTP/1.1 200 OK").length - 1;
  for (let asked = 1; asked <= 8; ++asked) {
    // lasts twice the timeout
    socket.write("GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n");
    for (const until = Date.now() + patience; answered() < asked && !socket.destroyed && Date.now() < until; )
      await sleep(20);
    assert.equal(answered(), asked);
    await sleep(250);
  }
  socket.write("GET /healthz HTTP/1.1\r\n");
  const dribble = setInterval(() => socket.destroyed || socket.write("X-Slow: 1\r\n"), 200);
  await withTimeout(socket.over, "it to be closed");
  clearInterval(dribble);
  assert.equal(answered(), 8);
});

test("a client that sends no token within --auth-timeout is closed with 1008", async () => {
  const server = await start("--token", "secret", "--auth-timeout", "1");
  const client = await Client.connect(server);
  assert.equal((await withTimeout(client.closed, "the close")).code, 1008);
});

test("after --max-wrong-tokens no token from that address is checked for a while; others never notice", async () => {
  const server = await start("--token", "secret", "--max-wrong-tokens", "20", "--auth-timeout", "60");
  const [inside, guesser] = [await Client.connect(server), await Client.connect(server)];
  await inside.request("auth", { token: "secret" });
  const right = { authorization: "Bearer secret" };
  for (let i = 0; i < 30; ++i)
    assert.equal((await server.get("/api/scene", right)).status, 200, "right ones cost nothing");

  const from = performance.now();
  let heard = 0,
    error;
  while ((error = await guesser.refusal("auth", { token: `guess ${heard}` })).code === -32001) ++heard;
  const due = Math.floor((performance.now() - from) / 3000); // one more every 3 s
  assert.ok(heard >= 20 && heard <= 20 + due, `${heard} were looked at`);
  assert.equal(error.code, -32002);
  const seconds = Number(/ for (\d+) s; see --max-wrong-tokens$/.exec(error.message)[1]);
  assert.ok(seconds >= 1 && seconds <= 3, error.message);
  assert.equal((await guesser.refusal("auth", { token: "secret" })).code, -32002, "not the right one either");

  const elsewhere = await socketTo(server, { localAddress: "127.0.0.2" });
  elsewhere.write("GET /api/scene HTTP/1.1\r\nHost: x\r\nAuthorization: Bearer secret\r\nConnection: close\r\n\r\n");
  assert.match((await withTimeout(once(elsewhere, "data"), "an answer elsewhere")).toString(), /^HTTP\/1.1 200/);
  elsewhere.destroy();
  await inside.request("sim.pause");

  await sleep(1000 * seconds);
  assert.equal((await guesser.request("auth", { token: "secret" })).role, "operator");
  assert.equal((await guesser.refusal("auth", { token: "wrong" })).code, -32001);
  for (const client of [inside, guesser]) await client.close();
});

test("a viewer that answers no ping within --idle-timeout is closed; one that only answers pings stays", async () => {
  const server = await start("--idle-timeout", "2");
  const client = await Client.connect(server);
  const deaf = await socketTo(server, { localAddress: "127.0.0.2" });
  deaf.write(upgrade);
  deaf.resume();
  await withTimeout(deaf.over, "the deaf one to be closed");
  await client.statuses(30);
  await client.request("ping", { t: 1 });
  await client.close();
});

test("a client that asks and does not read is cut off once 4 MiB of answers wait for it; the others go on", async () => {
  const server = await start();
  const other = await Client.connect(server);
  const deaf = await Client.connect(server, { session: "large" });
  const clients = () => server.metric("clothlab_clients");
  // A document of about 40 kB: 1000 copies are ten times as much as the client's and the kernel's buffers hold. They
  // are asked for at once, as nothing more is read from a client for whom many answers wait.
  const vertices = Array.from({ length: 1000 }, (_, i) => [
    (i % 40) + 0.123456789,
    1.123456789,
    Math.floor(i / 40) + 0.123456789,
  ]);
  const triangles = Array.from({ length: 900 }, (_, i) => [i, i + 40, i + 41]).filter(([a]) => a % 40 < 39);
  await deaf.request("scene.patch", {
    patch: [
      { op: "replace", path: "/cloths/0/mesh", value: { vertices, triangles } },
      { op: "replace", path: "/cloths/0/pins", value: [] },
    ],
  });
  assert.equal(await clients(), 2);
  deaf.socket.pause();
  for (let id = 0; id < 1000; ++id) deaf.send(JSON.stringify({ jsonrpc: "2.0", id, method: "scene.get" }));
  for (const until = Date.now() + patience; (await clients()) === 2 && Date.now() < until; ) await sleep(100);
  assert.equal(await clients(), 1);
  assert.equal((await other.request("ping", { t: 1 })).t, 1);
  deaf.socket.terminate();
  await other.close();
});

test("a client that reads slowly while a large scene is loaded three times, and asks for it four times, gets it whole", async () => {
  const folder = mkdtempSync(join(tmpdir(), "clothlab-large-"));
  after(() => rmSync(folder, { recursive: true, force: true }));
  const vertices = Array.from({ length: 46000 }, (_, i) => [
    (i % 200) / 81 + 1 / 3,
    1 / 7,
    Math.floor(i / 200) / 81 + 1 / 3,
  ]);
  const cloth = { mesh: { vertices, triangles: [[0, 200, 1]] }, material: { shear: 0 } };
  writeFileSync(join(folder, "large.json"), JSON.stringify({ version: 1, cloths: [cloth] }));
  const server = await start("--scene", join(folder, "large.json"));
  const [operator, slow] = await Promise.all([Client.connect(server), Client.connect(server)]);
  await slow.notification("scene");
  slow.socket.pause();
  for (let time = 0; time < 3; ++time) {
    await operator.request("scene.load", { preset: "seed" });
    await operator.request("scene.undo"); // sends all of it, more than 2 MB
  }
  const answers = Promise.all(Array.from({ length: 4 }, () => slow.request("scene.get")));
  const { revision } = await operator.request("scene.patch", { patch: { air_drag: 0.25 } });
  await operator.statuses(5);
  slow.socket.resume();
  for (const { document } of await answers) assert.equal(document.cloths[0].mesh.vertices.length, 46000);
  const told = ({ method, params }) => /^scene(\.changed)?$/.test(method) && params.revision === revision;
  await slow.until(() => slow.messages, told, "the last change");
  for (const client of [operator, slow]) await client.close();
});

test("a crowd that asks as often as it may is read as the thread that serves all has time, and all is answered in order", async () => {
  const server = await start("--log-level", "error");
  const bystander = await Client.connect(server, { session: "other" });
  await bystander.request("stream.subscribe", { encoding: "q16", rate: 60, in_flight: 2 });
  const crowd = await Promise.all(Array.from({ length: 20 }, () => Client.connect(server)));
  const answers = crowd.map((client) => {
    const asked = Array.from({ length: 500 }, () => client.request("scene.get"));
    return Promise.all([...asked, client.request("ping", { t: "last" })]);
  });
  await bystander.request("scene.get"); // is not behind the 10,000
  await bystander.nextFrames(10);
  assert.equal((await server.get("/healthz")).status, 200);
  assert.ok((await server.metric("clothlab_reading_stopped_total")) > 0);
  for (const answered of await Promise.all(answers)) {
    assert.deepEqual(answered.at(-1), { t: "last" });
    for (const { revision } of answered.slice(0, -1)) assert.equal(revision, 1);
  }
  await Promise.all([bystander, ...crowd].map((client) => client.close()));
});

test("what a client sends after a long upload is carried out after it", async () => {
  const server = await start();
  const client = await Client.connect(server);
  const order = [];
  const note = (what) => (answer) => {
    order.push(what);
    return answer;
  };
  const lines = Array.from({ length: 90_000 }, (_, i) => `v ${i % 300} 0 ${Math.floor(i / 300)}`);
  const obj = `${lines.join("\n")}\nf 1 302 2\n`;
  assert.ok(obj.length > 10 * 65536);
  const [uploaded, , patched] = await Promise.all([
    client.request("mesh.upload", { name: "long", obj }).then(note("upload")),
    client.request("ping", { t: 1 }).then(note("ping")),
    client.request("scene.patch", { patch: { name: "after" } }).then(note("patch")),
  ]);
  assert.equal(uploaded.triangles, 1);
  assert.equal(patched.revision, 2);
  assert.equal(order.at(-1), "patch"); // the ping needs no session, and may be answered before the mesh is read
  await client.close();
});
