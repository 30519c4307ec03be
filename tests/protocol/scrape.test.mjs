// /metrics as promtool and Prometheus read it.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Client, patience, Server, sleep } from "./harness.mjs";

const missing = (program) =>
  spawnSync(program, ["--version"]).status !== 0 && `${program} is not installed: Debian's package prometheus has it`;
const configuration = new URL("../../docker/prometheus/", import.meta.url).pathname;
const tokens = ["--token", "operators' token", "--view-token", "viewers' token"];

let server;
before(async () => (server = await Server.start(...tokens)));
after(() => server.stop());

/// Lets the server count something of everything that it counts by a label.
async function use() {
  const client = await Client.connect(server);
  await client.request("auth", { token: "operators' token" });
  await client.request("stream.subscribe");
  await client.request("ping", { t: 1 });
  await client.until(
    () => client.frames.slice(3),
    () => true,
    "3 frames",
  );
  return client;
}
const metrics = async () => (await server.get("/metrics", { authorization: "Bearer viewers' token" })).body.toString();
const check = (text) => {
  const { status, stdout, stderr } = spawnSync("promtool", ["check", "metrics"], { input: text, encoding: "utf8" });
  return { status, said: stdout + stderr };
};

test("promtool has nothing to say about /metrics of a server in use", { skip: missing("promtool") }, async () => {
  const client = await use();
  // Passes are timed a few times a second.
  let text = await metrics();
  for (const end = Date.now() + patience; !text.includes('pass="pack_frame"') && Date.now() < end; await sleep(100))
    text = await metrics();
  await client.close();
  for (const label of ['method="ping"', 'pass="pack_frame"', 'le="+Inf"']) assert.ok(text.includes(label), label);
  assert.deepEqual(check(text), { status: 0, said: "" });

  const spoilt = (from, to) => {
    assert.ok(text.includes(from), from);
    return check(text.replaceAll(from, to));
  };
  assert.match(spoilt("clothlab_steps_total", "clothlab_steps").said, /counter metrics should have "_total" suffix/);
  assert.match(spoilt("# HELP clothlab_viewers ", "# ").said, /clothlab_viewers no help text/);
  assert.match(spoilt("request_seconds", "request_milliseconds").said, /use base unit "seconds"/);
  assert.notEqual(spoilt('method="ping"', "method=ping").status, 0);
});

/// A port of loopback that was free a moment ago.
async function free_port() {
  const listener = createServer().listen(0, "127.0.0.1");
  await once(listener, "listening");
  const { port } = listener.address();
  listener.close();
  await once(listener, "close");
  return port;
}

/// Prometheus with docker/prometheus/prometheus.yml, whose first server is the one tested and whose token is `token`;
/// returns what it says of that target, once `enough` is true of that, and what the query finds.
async function target(token, query, enough) {
  const folder = mkdtempSync(join(tmpdir(), "clothlab-scrape-"));
  const text = readFileSync(join(configuration, "prometheus.yml"), "utf8");
  assert.ok(text.includes('"cloth-1:8080"') && text.includes("scrape_interval: 15s"));
  writeFileSync(
    join(folder, "prometheus.yml"),
    text
      .replace("cloth-1:8080", server.host)
      .replace(/cloth-[23]:8080/g, "127.0.0.1:1")
      .replace(/(?<=(?:scrape|evaluation)_interval: )15s/g, "1s")
      .replace("scrape_timeout: 5s", "scrape_timeout: 1s"),
  );
  writeFileSync(join(folder, "alerts.yml"), readFileSync(join(configuration, "alerts.yml")));
  writeFileSync(join(folder, "token"), token);
  const port = await free_port();
  const child = spawn(
    "prometheus",
    [
      `--config.file=${join(folder, "prometheus.yml")}`,
      `--storage.tsdb.path=${join(folder, "data")}`,
      `--web.listen-address=127.0.0.1:${port}`,
    ],
    { stdio: ["ignore", "ignore", "pipe"] },
  );
  let log = "",
    found;
  child.stderr.on("data", (data) => (log += data));
  const closed = once(child, "close");
  const ask = async (path) => (await (await fetch(`http://127.0.0.1:${port}/api/v1/${path}`)).json()).data;
  try {
    for (const end = Date.now() + patience; Date.now() < end; await sleep(200)) {
      assert.equal(child.exitCode, null, log);
      const told = await ask("targets").catch(() => undefined);
      found = told?.activeTargets.find(({ labels }) => labels.server === "cloth-1");
      if (!found || !enough(found)) continue;
      const { result } = await ask(`query?query=${encodeURIComponent(query)}`);
      if (result.length === 0) continue;
      return { labels: found.labels, result };
    }
    assert.fail(`Prometheus says ${JSON.stringify(found)}: ${log}`);
  } finally {
    child.kill();
    await closed;
    rmSync(folder, { recursive: true });
  }
}

test("Prometheus, as docker/prometheus has it, reads a server's metrics by the viewers' token", {
  skip: missing("prometheus"),
}, async () => {
  const { labels, result } = await target(
    "viewers' token\n",
    'clothlab_sessions{job="clothlab"}',
    ({ health, lastError }) => health === "up" && lastError === "",
  );
  assert.deepEqual(labels, { instance: server.host, job: "clothlab", server: "cloth-1" });
  assert.deepEqual(
    result.map(({ metric, value }) => [metric.server, value[1]]),
    [["cloth-1", "1"]],
  );
});

test("with another token Prometheus calls the server down", { skip: missing("prometheus") }, async () => {
  const { result } = await target(
    "no token",
    'up{server="cloth-1"}',
    ({ health, lastError }) => health === "down" && /401/.test(lastError),
  );
  assert.equal(result[0].value[1], "0");
});
