// The log that the server writes to stderr for its operator.
import assert from "node:assert/strict";
import { once } from "node:events";
import { chmodSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import net from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { noBus } from "./bus.mjs";
import { Client, Server, sleep } from "./harness.mjs";

const tokens = ["operators-only", "viewers-only"];
const value = String.raw`(?:"(?:[^"\\\x00-\x1f\x7f]|\\["\\]|\\x[0-9a-f]{2})*"|[^\s"=\\]+)`;
const line = new RegExp(
  String.raw`^time=\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z level=(error|warning|info|debug) event=([a-z_]+)((?: [a-z_]+=${value})*)$`,
);

/// The log lines about three clients: one that is not let in, one that guesses a token, and one that looks and leaves.
async function told(...args) {
  const server = await Server.start("--token", tokens[0], "--view-token", tokens[1], ...args);
  await assert.rejects(Client.connect(server, { headers: { origin: String.raw`https://e"v=i\l example` } }), {
    status: 403,
  });
  const client = await Client.connect(server, { session: "looked-at" });
  await client.refusal("auth", { token: 'a "guess"' });
  for (const headers of [{}, { authorization: "Bearer guess" }])
    assert.equal((await server.get("/metrics", headers)).status, 401);
  for (const token of tokens) await client.request("auth", { token });
  await client.notification("scene");
  await client.close();
  assert.equal(await server.stop(), 0);
  return server.stderr
    .split("\n")
    .slice(0, -1)
    .map((text) => {
      const [, level, event, fields] = line.exec(text) ?? assert.fail(`no logfmt: ${text}`);
      const read = [...fields.matchAll(new RegExp(`([a-z_]+)=(${value})`, "g"))].map(([, key, of]) => [key, of]);
      assert.equal(new Set(read.map(([key]) => key)).size, read.length, `each key once: ${text}`);
      return { level, event, text, ...Object.fromEntries(read) };
    });
}

const ofClients = (lines) => lines.filter(({ event }) => /^(client|token)_/.test(event));

test("each event is one line of logfmt, whatever a client sends, and no token is in it", async () => {
  const lines = await told();
  assert.deepEqual(
    ofClients(lines).map(({ event }) => event),
    [
      "client_refused",
      "client_connected",
      "token_refused",
      "token_refused",
      "client_admitted",
      "client_admitted",
      "client_left",
    ],
  );
  const [refused, connected, guessed, guessedByHttp, opened, admitted, left] = ofClients(lines);
  assert.deepEqual([refused.status, refused.origin], ["403", String.raw`"https://e\"v=i\\l example"`]);
  assert.deepEqual([connected.session, connected.role, connected.address], ["looked-at", "none", "127.0.0.1"]);
  assert.deepEqual([opened.role, admitted.role], ["operator", "viewer"]);
  assert.ok(Number(left.seconds) >= 0 && Number(left.bytes) > 0, left.text);
  assert.deepEqual(
    [guessed, admitted, left].map(({ client }) => client),
    Array(3).fill(connected.client),
  );
  assert.deepEqual(
    [guessed.address, guessedByHttp.address, guessedByHttp.client],
    ["127.0.0.1", "127.0.0.1", undefined],
  );
  for (const { text } of lines) for (const secret of [...tokens, "guess"]) assert.ok(!text.includes(secret), text);
  for (const session of ["main", "looked-at"])
    assert.equal(lines.filter((one) => one.event === "session_started" && one.session === session).length, 1);
});

test("--log-level leaves out what is less urgent", async () => {
  assert.deepEqual(await told("--log-level", "error"), []);
  const warnings = await told("--log-level", "warning");
  assert.deepEqual(
    warnings.map(({ level, event }) => [level, event]),
    [
      ["warning", "client_refused"],
      ["warning", "token_refused"],
      ["warning", "token_refused"],
    ],
  );
  const all = await told("--log-level", "debug");
  assert.ok(all.some(({ level }) => level === "info"));
});

/// A server that may have so many descriptors.
async function withDescriptors(t, count, ...args) {
  const folder = mkdtempSync(join(tmpdir(), "clothlab-few-"));
  const program = process.env.CLOTHLAB;
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  const few = join(folder, "few");
  writeFileSync(few, `#!/bin/sh\nulimit -n ${count}\nexec "${program}" "$@"\n`);
  chmodSync(few, 0o755);
  process.env.CLOTHLAB = few;
  return Server.launch(...args).finally(() => (process.env.CLOTHLAB = program));
}

test("without descriptors left the server says so, ten times a second at most, and goes on once there are some", async (t) => {
  const server = await withDescriptors(t, 40, "serve");
  const client = await Client.connect(server);
  const sockets = Array.from({ length: 60 }, () => net.connect(server.port, "127.0.0.1").on("error", () => {}));
  const lines = () => server.stderr.split("\n").filter((text) => text.includes("event=libwebsockets"));
  for (let tries = 0; lines().length === 0 && tries < 500; ++tries) await sleep(20);
  await client.statuses(20);
  const seconds = new Map(); // lines in each second of the clock, in which two seconds of the limit may lie
  for (const text of lines()) seconds.set(text.slice(0, 24), (seconds.get(text.slice(0, 24)) ?? 0) + 1);
  assert.ok(seconds.size > 0, "it is told");
  for (const [second, told] of seconds) assert.ok(told <= 22, `${told} lines in ${second}`);
  for (const socket of sockets) socket.destroy();
  for (let tries = 0; (await server.get("/healthz").catch(() => null))?.status !== 200 && tries < 500; ++tries)
    await sleep(20);
  assert.deepEqual(await client.request("ping", { t: 1 }), { t: 1 });
  await client.close();
  assert.equal(await server.stop(), 0);
});

for (const [args, clients] of [
  [["serve", "--max-clients", "1000", "--max-sessions", "4"], (200 - 32 - 8 * 4) / 2],
  [["relay", "--from", "nats://127.0.0.1:9"], (200 - 32) / 2],
])
  test(`${args[0]} lowers --max-clients to what its descriptors allow and says so; /healthz is answered, nothing else is told in floods`, {
    skip: args[0] === "relay" && noBus(),
  }, async (t) => {
    const server = await withDescriptors(t, 200, ...args, "--max-clients-per-address", "1000");
    const [warning, ...others] = server.stderr.split("\n").filter((text) => text.includes("event=limit_lowered"));
    assert.deepEqual(others, []);
    assert.match(
      warning,
      new RegExp(`level=warning .*limit=--max-clients from=\\d+ to=${clients} why=.* 200 descriptors`),
    );
    assert.match(warning, /remedy=".*ulimit -Hn.*LimitNOFILE.*--ulimit nofile/);
    const viewers = await Promise.all(Array.from({ length: clients }, () => Client.connect(server)));
    const refused = await Promise.allSettled(Array.from({ length: 60 }, () => Client.connect(server)));
    for (const { reason } of refused) assert.equal(reason.status, 503);
    const sockets = Array.from({ length: 300 }, () => net.connect(server.port, "127.0.0.1").on("error", () => {}));
    await Promise.all(sockets.slice(-100).map((socket) => once(socket.resume(), "close")));
    for (const socket of sockets) socket.destroy();
    for (let tries = 0; (await server.get("/healthz").catch(() => null))?.status !== 200; ++tries, await sleep(20))
      assert.ok(tries < 500, "no room was made");
    const lines = () => server.stderr.split("\n").filter((text) => text.includes("event=client_refused"));
    const more = (text) => Number(/why="and (\d+) lines more"/.exec(text)?.[1] ?? 0);
    const told = () => lines().reduce((sum, text) => sum + (more(text) || 1), 0);
    for (let tries = 0; told() < 60; ++tries, await sleep(20)) assert.ok(tries < 500, "some refusals are not told");
    assert.equal(told(), 60);
    assert.ok(lines().length <= 3 * 11, lines().join("\n")); // all within two seconds, so in three of the clock
    assert.match(lines()[0], /why="the server has as many clients as it may/);
    assert.doesNotMatch(server.stderr, /event=libwebsockets/);
    for (const viewer of viewers) viewer.socket.terminate();
    assert.equal(await server.stop(), 0);
  });
