// The log that the server writes to stderr for its operator.
import assert from "node:assert/strict";
import { chmodSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import net from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
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

test("without descriptors left the server says so, ten times a second at most, and goes on once there are some", async (t) => {
  const folder = mkdtempSync(join(tmpdir(), "clothlab-few-"));
  const program = process.env.CLOTHLAB;
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  const few = join(folder, "few");
  writeFileSync(few, `#!/bin/sh\nulimit -n 40\nexec "${program}" "$@"\n`);
  chmodSync(few, 0o755);
  process.env.CLOTHLAB = few;
  const server = await Server.start().finally(() => (process.env.CLOTHLAB = program));
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
