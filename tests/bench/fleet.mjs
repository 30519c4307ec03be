// Sessions on three servers behind HAProxy (docker/haproxy/haproxy.cfg): one server is killed, one is ended by
// SIGTERM, both come back, and HAProxy itself is reloaded and killed. By hand, on a quiet machine, after
// `apt-get install haproxy`:
//   CLOTHLAB=build/release/clothlab node tests/bench/fleet.mjs [VIEWERS] [SESSIONS] [--out FILE]
// Viewers connect again as the page does. After each event every session must be open on one server alone, and every
// viewer must see its cloth again within 5 s, at most 1 s of simulated time back. Prints a table and (or writes) JSON;
// exits with 1 if something is not so. All on loopback.
import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import net from "node:net";
import { cpus, tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { Server, sleep } from "../protocol/harness.mjs";
import { Viewer } from "./fleet_viewer.mjs";

const args = process.argv.slice(2);
const outAt = args.indexOf("--out");
const out = outAt < 0 ? null : args.splice(outAt, 2)[1];
const [viewerCount = 30, sessionCount = 9] = args.map(Number);
const token = "fleet",
  names = ["one", "two", "three"],
  allowed = { seconds: 5, back: 1 }, // without a frame; of simulated time
  round = (value, digits = 2) => Number(value.toFixed(digits));

const folder = mkdtempSync(join(tmpdir(), "clothlab-fleet-"));
const at = (name) => join(folder, name);
mkdirSync(at("state"));
// Pins that swing: the cloth never sleeps. Its step is far below the limit, sqrt(m / k) = 7 ms.
const motion = { oscillate: { axis: [0, 0, 1], amplitude: 0.2, frequency: 0.5 } };
const cloth = {
  name: "cloth",
  mesh: { grid: { columns: 9, rows: 9, width: 1, height: 1 } },
  mass: { per_vertex: 0.1 },
  material: { model: "springs", structural: 2000, shear: 1000, bend: 200, damping: 2 },
  pins: ["corner:0,0", "corner:8,0"].map((corner) => ({ at: corner, motion })),
};
const solver = { method: "symplectic_euler", dt: 0.002 };
writeFileSync(at("scene.json"), JSON.stringify({ version: 1, name: "fleet", cloths: [cloth], solver }));

async function freePorts(count) {
  const listeners = Array.from({ length: count }, () => net.createServer().listen(0, "127.0.0.1"));
  await Promise.all(listeners.map((listener) => once(listener, "listening")));
  const ports = listeners.map((listener) => listener.address().port);
  for (const listener of listeners) listener.close();
  return ports;
}
const [front, peer, ...ports] = await freePorts(2 + names.length);

/// The file as it is, but for what belongs to a machine: the part `global`, and the addresses.
function configuration() {
  const file = resolve(import.meta.dirname, "../../docker/haproxy/haproxy.cfg");
  let text = readFileSync(file, "utf8");
  const replace = (from, to) => {
    if (text.split(from).length !== 2) throw new Error(`${file} has not exactly one "${from}"`);
    text = text.replace(from, to);
  };
  replace(text.slice(text.indexOf("\nglobal\n"), text.indexOf("\ndefaults\n")), "");
  replace("bind :8080", `bind 127.0.0.1:${front}`);
  replace("127.0.0.1:10000", `127.0.0.1:${peer}`);
  for (const [i, port] of ports.entries()) replace(`192.0.2.${11 + i}:8080`, `127.0.0.1:${port}`);
  return `global\n    localpeer this\n    stats socket ${at("socket")} level admin\n${text}`;
}
writeFileSync(at("haproxy.cfg"), configuration());

const proxies = [];
async function startProxy(...options) {
  const child = spawn("haproxy", ["-db", "-f", at("haproxy.cfg"), ...options], { stdio: ["ignore", "pipe", "pipe"] });
  proxies.push(child);
  child.ended = new Promise((resolve) => child.on("close", resolve).on("error", resolve));
  let said = "";
  for (const stream of [child.stdout, child.stderr]) stream.on("data", (data) => (said += data));
  const refused = child.ended.then(() => true);
  if (await Promise.race([refused, sleep(700)])) throw new Error(`haproxy ended: ${said}`);
  return child;
}

async function askProxy(command) {
  const socket = net.connect(at("socket"));
  socket.end(`${command}\n`);
  let answer = "";
  for await (const data of socket) answer += data;
  return answer;
}

const servers = [];
async function startServer(i) {
  servers[i] = await Server.start(
    ...["--port", String(ports[i]), "--state-dir", at("state"), "--share-state-dir", "--scene", at("scene.json")],
    // Fewer clients from one address than there are viewers: only who reads X-Forwarded-For lets them all in.
    ...["--trusted-proxy", "127.0.0.1", "--max-clients-per-address", "8", "--max-clients", "200"],
    ...["--token", token, "--max-sessions", "32"],
  );
  servers[i].runs = true;
}

/// Waits until HAProxy counts exactly these servers as up.
async function counted(up) {
  for (const end = performance.now() + 20_000; performance.now() < end; await sleep(50)) {
    const state = (await askProxy("show servers state servers")).split("\n").map((line) => line.split(" "));
    if (names.every((name, i) => state.some((row) => row[3] === name && row[5] === (up[i] ? "2" : "0")))) return;
  }
  throw new Error("HAProxy did not notice which servers run");
}

const failures = [];
const check = (so, what) => so || failures.push(what);
const authorization = { authorization: `Bearer ${token}` };

/// The server of each session, asked one by one; every other must refuse (503), and so HAProxy must find the one.
async function places(sessions, named = true) {
  const found = new Map();
  for (const session of sessions) {
    const path = `/api/scene?session=${session}`;
    const running = [...servers.keys()].filter((i) => servers[i].runs);
    const answers = await Promise.all(running.map((i) => servers[i].get(path, authorization)));
    const open = running.filter((_, k) => answers[k].status === 200);
    const refused = answers.filter(({ status }) => status === 503);
    check(open.length === 1 && refused.length === running.length - 1, `${session} is open on ${open.length} servers`);
    const { status, body } = await Server.prototype.get.call({ port: front }, path, authorization);
    check(status === 200, `HAProxy answers ${status} to ${path}`);
    check(status !== 200 || !named || JSON.parse(body).name === session, `${session} has lost its name`);
    found.set(session, open[0]);
  }
  return found;
}
const perServer = (found) => names.map((_, i) => [...found.values()].filter((place) => place === i).length);

const sessions = Array.from({ length: sessionCount }, (_, i) => (i ? `flag-${i}` : "main"));
const viewers = [];
function addViewer(session) {
  const i = viewers.length;
  viewers.push(new Viewer({ port: front, session, token, address: `127.0.${1 + (i >> 7)}.${1 + (i & 127)}` }));
  return viewers.at(-1);
}
/// Waits until each of these viewers sees frames of a connection made since `since`.
async function allSee(some, since, patience = 30_000) {
  for (const end = performance.now() + patience; performance.now() < end; await sleep(20))
    if (some.every((viewer) => viewer.back?.at > since)) return;
  failures.push(`${some.filter((viewer) => !(viewer.back?.at > since)).length} viewers see nothing`);
}

const rows = [];
/// Does something to the fleet and writes down what it was to the viewers whom it concerns.
async function event(what, concerned, act, code) {
  const others = viewers.filter((viewer) => !concerned.includes(viewer));
  for (const viewer of viewers) Object.assign(viewer, { before: viewer.last, back: null, codes: [], refusals: [] });
  const since = performance.now();
  await act();
  await allSee(concerned, since);
  const gaps = concerned.map(({ before, back }) => ((back?.at ?? Infinity) - (before?.at ?? 0)) / 1000);
  const back = concerned.map((viewer) => viewer.lastTimeBefore - (viewer.back?.time ?? -Infinity));
  gaps.sort((a, b) => a - b);
  const none = concerned.length === 0;
  check(none || gaps.at(-1) <= allowed.seconds, `${what}: ${gaps.at(-1)} s without a frame`);
  check(none || Math.max(...back) <= allowed.back, `${what}: ${Math.max(...back)} s back`);
  check(!others.some(({ codes }) => codes.length > 0), `${what}: viewers of other sessions were cut off`);
  const codes = [...new Set(concerned.flatMap((viewer) => viewer.codes))];
  check(none || code === undefined || codes.join() === String(code), `${what}: closed with ${codes}`);
  await sleep(1000);
  const found = await places(sessions);
  rows.push({
    what,
    viewers_concerned: concerned.length,
    seconds_without_a_frame: concerned.length
      ? { median: round(gaps[gaps.length >> 1]), longest: round(gaps.at(-1)) }
      : null,
    simulated_seconds_back_at_most: concerned.length ? round(Math.max(0, ...back)) : null,
    close_codes: codes,
    handshakes_refused: viewers.reduce((sum, viewer) => sum + viewer.refusals.length, 0),
    sessions_on_each_server: perServer(found),
  });
  return found;
}
const of = (found, i) => viewers.filter(({ session }) => found.get(session) === i);
const most = (found, among) => among.sort((a, b) => perServer(found)[b] - perServer(found)[a])[0];
const same = (a, b, what) =>
  check(
    sessions.every((session) => a.get(session) === b.get(session)),
    `${what} moved some`,
  );

let endSeconds;
try {
  await Promise.all(names.map((_, i) => startServer(i)));
  let proxy = await startProxy();
  await counted([true, true, true]);
  for (let i = 0; i < viewerCount; ++i) addViewer(sessions[i % sessions.length]);
  await allSee(viewers, 0);
  // So a session that is not the one it was is seen.
  for (const [i, name] of sessions.entries()) viewers[i].request(3, "scene.patch", { patch: { name } });
  await sleep(3000); // more than a second of simulated time to lose

  let found = await event("nothing", [], async () => {});
  check(Math.min(...perServer(found)) > 0, "a server has no session");
  const addresses = servers.map(({ stderr }) => stderr).join("");
  check(
    viewers.every(({ address }) => addresses.includes(`address=${address} `)),
    "a server does not know a viewer's address",
  );

  const killed = most(found, [0, 1, 2]);
  found = await event("a server is killed (SIGKILL)", of(found, killed), async () => {
    servers[killed].runs = false;
    servers[killed].child.kill("SIGKILL");
  });
  await sleep(2000);
  const drained = most(
    found,
    [0, 1, 2].filter((i) => i !== killed),
  );
  found = await event(
    "a server is ended (SIGTERM)",
    of(found, drained),
    async () => {
      servers[drained].runs = false;
      const asked = performance.now();
      check((await servers[drained].stop()) === 0, "the exit code is not 0");
      endSeconds = (performance.now() - asked) / 1000;
      check(endSeconds < 5, `the end took ${endSeconds} s`);
    },
    1012,
  );

  const before = found;
  found = await event("both start again", [], async () => {
    await Promise.all([startServer(killed), startServer(drained)]);
    await counted([true, true, true]);
    await sleep(2000);
  });
  same(before, found, "a server that came back");
  const fresh = Array.from({ length: 12 }, (_, i) => `new-${i}`);
  await allSee(fresh.map(addViewer), 0);
  const placed = perServer(await places(fresh, false));
  check(placed[killed] > 0 && placed[drained] > 0, "a server that came back gets no new sessions");
  rows.push({ what: "12 new sessions", viewers_concerned: 12, sessions_on_each_server: placed });

  let joined = [];
  same(
    found,
    await event("HAProxy is reloaded, a viewer joins each session", [], async () => {
      proxy = await startProxy("-sf", String(proxy.pid));
      joined = sessions.map(addViewer);
      await allSee(joined, 0);
    }),
    "a reload",
  );
  check(
    joined.every(({ refusals }) => refusals.length === 0),
    "after a reload a viewer was refused",
  );
  same(
    found,
    await event("HAProxy is killed, with its table, and starts again", [...viewers], async () => {
      for (const each of proxies) each.kill("SIGKILL");
      await Promise.all(proxies.map(({ ended }) => ended));
      await startProxy();
    }),
    "HAProxy's end",
  );
} catch (error) {
  failures.push(error.stack);
} finally {
  for (const viewer of viewers) viewer.end();
  for (const proxy of proxies) proxy.kill("SIGKILL");
  await Promise.all(servers.filter(({ runs }) => runs).map((server) => server.stop("SIGKILL")));
  if (failures.length === 0) rmSync(folder, { recursive: true });
  else writeFileSync(at("log"), servers.map(({ stderr }, i) => `${names[i]}\n${stderr}`).join("\n"));
}

const result = {
  benchmark: "fleet",
  machine: `${cpus()[0].model.trim()}, ${cpus().length} cores`,
  haproxy: /version (\S+)/.exec(execFileSync("haproxy", ["-v"]))[1],
  servers: names.length,
  sessions: sessionCount,
  viewers: viewerCount,
  seconds_from_SIGTERM_to_the_end: endSeconds === undefined ? null : round(endSeconds),
  events: rows,
  failures,
};
const heads = ["event", "viewers concerned", "s without a frame: median", "longest", "simulated s back"];
console.log(`| ${[...heads, "closed with", "handshakes refused", "sessions on each server"].join(" | ")} |`);
for (const row of rows) {
  const { median, longest } = row.seconds_without_a_frame ?? {};
  const cells = [
    row.what,
    row.viewers_concerned,
    median ?? "",
    longest ?? "",
    row.simulated_seconds_back_at_most ?? "",
  ];
  const rest = [row.close_codes?.join(" ") ?? "", row.handshakes_refused ?? "", row.sessions_on_each_server.join(" ")];
  console.log(`| ${[...cells, ...rest].join(" | ")} |`);
}
const text = JSON.stringify(result, null, 2);
if (out) writeFileSync(out, `${text}\n`);
else console.log(text);
for (const failure of failures) console.error(`FAILED: ${failure}`);
if (failures.length > 0) console.error(`configuration, states and logs are in ${folder}`);
process.exit(failures.length > 0 ? 1 : 0);
