// --share-state-dir: several servers use one state folder, and each session is open in one of them at a time.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { Client, patience, runProgram, Server, sleep } from "./harness.mjs";

const folders = [];
after(() => folders.forEach((folder) => rmSync(folder, { recursive: true, force: true })));

function folder() {
  folders.push(mkdtempSync(join(tmpdir(), "clothlab-shared-")));
  return folders.at(-1);
}
const start = (kept, ...more) => Server.start("--state-dir", kept, "--share-state-dir", ...more);

async function watch(server, session) {
  const client = await Client.connect(server, { session });
  await client.request("stream.subscribe", { encoding: "f32" });
  return client;
}

/// Connects again and again, as a client does whose session's server has gone.
async function insist(server, session) {
  for (const until = Date.now() + patience; ; await sleep(100)) {
    try {
      return await Client.connect(server, { session });
    } catch (error) {
      if (error.status !== 503 || Date.now() > until) throw error;
    }
  }
}

test("a session that another server has open is refused with 503, others are not; main is like any other", async () => {
  const kept = folder();
  const [a, b] = [await start(kept), await start(kept)];
  const here = await watch(a, "s");
  await here.nextFrame();
  await assert.rejects(Client.connect(b, { session: "s" }), { status: 503 });
  const why = /why="another server has this session open; connect again"/;
  for (const until = Date.now() + patience; !why.test(b.stderr); await sleep(20))
    assert.ok(Date.now() < until, b.stderr);
  const answer = await b.get("/api/scene?session=s");
  assert.equal(answer.status, 503);
  assert.equal(answer.headers["retry-after"] ?? answer.headers.get?.("retry-after"), "1");
  assert.equal((await b.get("/api/scene?session=none")).status, 404);
  const there = await watch(b, "t");
  await there.nextFrame();
  await (await watch(b)).nextFrame();
  await assert.rejects(Client.connect(a), { status: 503 });
  assert.equal(await a.stop(), 0);
  assert.equal(await b.stop(), 0);
});

for (const end of ["SIGTERM", "SIGKILL"])
  test(`after ${end} another server goes on with the session, at most a second back`, async () => {
    const kept = folder();
    const [a, b] = [await start(kept), await start(kept)];
    const client = await watch(a, "s");
    await client.request("scene.patch", { patch: { gravity: [0, -3, 0] } });
    await client.frame((frame) => frame.time > 1.5);
    const stopped = a.stop(end);
    const { code } = await client.closed;
    assert.equal(code, end === "SIGTERM" ? 1012 : 1006);
    const last = client.binary.findLast((message) => message.kind === 2).time;
    const again = await insist(b, "s");
    const { document } = await again.notification("scene");
    assert.deepEqual(document.gravity, [0, -3, 0]);
    const { time } = await again.notification("sim.status");
    assert.ok(time > last - 1, `back to ${time} s from ${last} s`);
    await stopped;
    assert.equal(await b.stop(), 0);
  });

test("each refusal says what is full, on every server that shares the folder, until there is room", async () => {
  const kept = folder();
  const few = ["--max-clients", "3", "--max-clients-per-address", "2", "--trusted-proxy", "127.0.0.1"];
  const [a, b] = [await start(kept, ...few), await start(kept, ...few)];
  const from = (address) => ({ "X-Forwarded-For": address });
  const watchers = [];
  for (const address of ["192.0.2.1", "192.0.2.1"])
    watchers.push(await Client.connect(a, { session: "s", headers: from(address) }));
  const refused = async (server, address) => {
    const headers = from(address);
    await assert.rejects(Client.connect(server, { session: "s", headers }), { status: 503 });
    // What a page can read, which is not told why its WebSocket was refused.
    const answer = await server.get("/ws?session=s", headers);
    assert.deepEqual([answer.status, answer.headers["retry-after"]], [503, "1"]);
    return answer.body.toString().trim();
  };
  const elsewhere = "another server has this session open; connect again";
  assert.equal(await refused(b, "192.0.2.1"), elsewhere);
  const of_address = "this address has as many clients as it may, 2";
  assert.equal(await refused(a, "192.0.2.1"), `${of_address}; see --max-clients-per-address`);
  const there = "on the server that has this session open";
  assert.equal(await refused(b, "192.0.2.1"), `${of_address}, ${there}; see --max-clients-per-address`);
  assert.equal(await refused(b, "192.0.2.2"), elsewhere, "for that address there is room");
  watchers.push(await Client.connect(a, { session: "s", headers: from("192.0.2.2") }));
  assert.equal(await refused(a, "192.0.2.3"), "the server has as many clients as it may, 3; see --max-clients");
  const full = "the server that has this session open has as many clients as it may, 3; see --max-clients";
  assert.equal(await refused(b, "192.0.2.3"), full);
  await watchers.pop().close();
  for (const until = Date.now() + patience; (await refused(b, "192.0.2.3")) !== elsewhere; await sleep(20))
    assert.ok(Date.now() < until, "the note stays");
  assert.equal((await a.get("/ws?session=s", from("192.0.2.3"))).status, 426, "there is room again");
  // What a server wrote that was killed says nothing of the next one.
  await refused(a, "192.0.2.1");
  await a.stop("SIGKILL");
  const again = await insist(b, "s");
  const c = await start(kept, ...few);
  assert.equal(await refused(c, "192.0.2.1"), elsewhere);
  await again.close();
  assert.equal(await b.stop(), 0);
  assert.equal(await c.stop(), 0);
});

test("a server whose sessions are all watched says so, and opens another once one is left", async () => {
  const server = await start(folder(), "--max-sessions", "2", "--unwatched-timeout", "1");
  const [one] = [await Client.connect(server, { session: "one" }), await Client.connect(server, { session: "two" })];
  await assert.rejects(Client.connect(server, { session: "three" }), { status: 503 });
  const why =
    "the server has as many sessions as it may, 2; see --max-sessions (one that nobody has watched for 1 s makes room)";
  assert.equal((await server.get("/ws?session=three")).body.toString().trim(), why);
  assert.ok(server.stderr.includes(`why="${why}"`), server.stderr);
  await one.close();
  await insist(server, "three");
  assert.equal(await server.stop(), 0);
});

test("a session without clients is given up after --unwatched-timeout, so that another server can open it", async () => {
  const kept = folder();
  const [a, b] = [await start(kept, "--unwatched-timeout", "1"), await start(kept, "--unwatched-timeout", "30")];
  const client = await watch(a, "s");
  await client.frame((frame) => frame.time > 0.5);
  await client.close();
  await assert.rejects(Client.connect(b, { session: "s" }), { status: 503 });
  const checks = setInterval(() => a.get("/healthz").catch(() => {}), 200); // like those of a proxy
  const again = await insist(b, "s");
  clearInterval(checks);
  assert.ok((await again.notification("sim.status")).time > 0.4);
  assert.equal(await a.stop(), 0);
  assert.equal(await b.stop(), 0);
});

test("a folder is shared by all of its servers, or belongs to one", async () => {
  const kept = folder();
  const serve = (...more) => runProgram(["serve", "--port", "0", "--state-dir", kept, ...more]);
  const sharing = await start(kept);
  assert.match((await serve()).stderr, /another process is using this folder/);
  assert.equal(await sharing.stop(), 0);
  const alone = await Server.start("--state-dir", kept);
  assert.match((await serve("--share-state-dir")).stderr, /another process is using this folder/);
  assert.equal(await alone.stop(), 0);
  const { code, stderr } = await runProgram(["serve", "--port", "0", "--share-state-dir"]);
  assert.equal(code, 2);
  assert.match(stderr, /--share-state-dir: given without --state-dir/);
});
