// --state-dir: a session returns after the server's end, however the server ended.
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { after, test } from "node:test";
import { Client, patience, runProgram, Server, sleep } from "./harness.mjs";

const folders = [];
after(() => folders.forEach((folder) => rmSync(folder, { recursive: true, force: true })));

function folder() {
  folders.push(mkdtempSync(join(tmpdir(), "clothlab-state-")));
  return folders.at(-1);
}

async function watch(server, session) {
  const client = await Client.connect(server, { session });
  await client.request("stream.subscribe", { encoding: "f32" });
  return client;
}

test("after kill -9 a restart brings each session's scene and state back to within the last second", async () => {
  const kept = folder();
  let server = await Server.start("--state-dir", kept);
  const [main, other] = [await watch(server), await watch(server, "other")];
  await main.request("scene.patch", { patch: { gravity: [0, -3, 0], name: "moon" } });
  await other.request("scene.load", { preset: "curtain" });
  await other.request("sim.speed", { factor: 0.5 });
  const before = [
    await main.frame((frame) => frame.time > 2),
    await other.nextFrame((frame) => frame.time > 1 && frame.time < 100),
  ];
  const scenes = await Promise.all([main, other].map((client) => client.request("scene.get")));
  await server.stop("SIGKILL");
  const last = [main, other].map((client) => client.binary.findLast((message) => message.kind === 2).time);

  server = await Server.start("--state-dir", kept);
  for (const [i, session] of [
    [0, "main"],
    [1, "other"],
  ]) {
    const client = await Client.connect(server, { session });
    // The session's first state, before it goes on.
    const { document, revision } = await client.notification("scene");
    assert.deepEqual(document, scenes[i].document, session);
    assert.ok(revision >= scenes[i].revision, session);
    const status = await client.notification("sim.status");
    assert.ok(status.time > last[i] - 1, `${session}: back to ${status.time} s from ${last[i]} s`);
    assert.ok(before[i].time > 0 && status.playing);
    assert.equal(status.speed, i === 0 ? 1 : 0.5);
    await client.close();
  }
  assert.equal(await server.stop(), 0);
});

test("a session that was paused is as it was, vertex by vertex, after SIGTERM", async () => {
  const kept = folder();
  let server = await Server.start("--state-dir", kept);
  let client = await watch(server);
  await client.frame((frame) => frame.time > 0.3);
  await client.request("sim.pause");
  const { time, step } = await client.request("sim.step", { steps: 7 });
  const before = await client.frame((frame) => frame.step === step);
  assert.equal(await server.stop(), 0);
  server = await Server.start("--state-dir", kept);
  client = await watch(server);
  const after = await client.frame();
  assert.equal(after.step, step);
  assert.ok(Math.abs(after.time - time) < 1e-12);
  assert.deepEqual(after.positions, before.positions);
  assert.equal((await client.notification("sim.status")).playing, false);
  // It can go on.
  assert.equal((await client.request("sim.step", { steps: 3 })).step, step + 3);
  await server.stop();
});

test("a file that is damaged is moved aside, never deleted; its session starts anew and says so", async () => {
  const kept = folder();
  const server = await Server.start("--state-dir", kept);
  await (await watch(server)).frame((frame) => frame.time > 0.1);
  await server.stop();
  const file = join(kept, "main.session");
  const bytes = readFileSync(file);
  bytes[bytes.length - 5] ^= 1;
  writeFileSync(file, bytes);
  const again = await Server.start("--state-dir", kept);
  const client = await Client.connect(again);
  assert.equal((await client.request("scene.get")).document.name, "seed");
  assert.deepEqual(readFileSync(`${file}.unreadable`), bytes);
  assert.match(
    again.stderr,
    /level=error event=session_not_restored session=main why=".*damaged; it was moved to .*main\.session\.unreadable"/,
  );
  await again.stop();
});

test("a foreign file, or one of another version, is moved aside, and its first bytes are reported", async () => {
  for (const [bytes, found] of [
    ["hello, world\nmore", /it is no saved session: it begins with .*hello, world.*, not with .*clothlab session 1/],
    [
      "clothlab session 2\n{}",
      /another version of the program wrote it: it begins with .*clothlab session 2.*, and this one reads .*clothlab session 1/,
    ],
    ["", /it is empty/],
  ]) {
    const kept = folder();
    writeFileSync(join(kept, "main.session"), bytes);
    const server = await Server.start("--state-dir", kept);
    const client = await Client.connect(server);
    assert.equal((await client.request("scene.get")).document.name, "seed");
    assert.match(server.stderr, found);
    assert.match(server.stderr, /it was moved to .*main\.session\.unreadable/);
    assert.equal(readFileSync(join(kept, "main.session.unreadable"), "utf8"), bytes);
    assert.equal(await server.stop(), 0);
  }
});

test("a folder belongs to one server: another is refused until that one has ended, however it ended", async () => {
  const kept = folder();
  for (const end of ["SIGKILL", "SIGTERM"]) {
    const first = await Server.start("--state-dir", kept);
    for (const path of [kept, join(kept, ".", "..", basename(kept))]) {
      const { code, stderr } = await runProgram(["serve", "--port", "0", "--state-dir", path]);
      assert.equal(code, 2);
      assert.match(
        stderr,
        new RegExp(
          "^clothlab: error: --state-dir .*clothlab-state-.*: another process is using this folder; " +
            "end that process, or choose a different folder\\n$",
        ),
      );
    }
    const beside = await Server.start("--state-dir", join(kept, "below"));
    assert.equal(await beside.stop(), 0);
    await first.stop(end);
  }
});

test("nothing unfinished is left in the folder, and one that cannot be written is refused at the start", async () => {
  const kept = folder();
  const server = await Server.start("--state-dir", join(kept, "made", "anew"));
  const client = await watch(server);
  for (const until = Date.now() + patience; !existsSync(join(kept, "made", "anew", "main.session")); await sleep(50))
    assert.ok(Date.now() < until);
  await client.close();
  await server.stop();
  assert.deepEqual(readdirSync(join(kept, "made", "anew")), ["main.session"]);
  writeFileSync(join(kept, "a-file"), "");
  const { code, stderr } = await runProgram(["serve", "--port", "0", "--state-dir", join(kept, "a-file")]);
  assert.equal(code, 2);
  assert.match(stderr, /--state-dir .*a-file: .*; give a folder/);
});

test("a viewer may open what is kept, after a restart too, and nothing else", async (t) => {
  const kept = folder(),
    guarded = ["--state-dir", kept, "--token", "secret", "--view-token", "look"];
  const enter = async (server, session, token) => {
    const client = await Client.connect(server, { session });
    await client.request("auth", { token });
    return client;
  };
  let server = await Server.start(...guarded);
  t.after(() => server.child.kill());
  await assert.rejects(enter(server, "other", "look"), { code: -32001 });
  const operator = await enter(server, "other", "secret");
  await operator.request("scene.patch", { patch: { name: "kept" } });
  assert.equal(await server.stop(), 0);
  server = await Server.start(...guarded);
  const viewer = await enter(server, "other", "look");
  assert.equal((await viewer.notification("hello")).role, "viewer");
  assert.equal((await viewer.notification("scene")).document.name, "kept");
  await assert.rejects(enter(server, "another", "look"), { code: -32001 });
  assert.equal(await server.stop(), 0); // and the server has finished writing
  assert.deepEqual(readdirSync(kept).sort(), ["main.session", "other.session"]);
});
