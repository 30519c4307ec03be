// --state-dir: a session returns after the server's end, however the server ended.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import {
  existsSync,
  lstatSync,
  mkdirSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  renameSync,
  rmSync,
  truncateSync,
  writeFileSync,
} from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { after, test } from "node:test";
import { thorough } from "../thorough.mjs";
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

const leaf = "v 0 0 0\nv 0.5 0 0\nv 0 0 0.5\nv 0.5 0 0.5\nf 1 2 3\nf 2 4 3\n";
/// A patch that makes the cloth of a mesh.
const named = (file) => [
  { op: "replace", path: "/cloths/0/mesh", value: { obj: file } },
  { op: "replace", path: "/cloths/0/pins", value: [] },
];
/// Puts a key that this version does not know into the document of a saved session.
function fromALaterVersion(file) {
  const bytes = readFileSync(file);
  const at = bytes.indexOf('"document":{') + '"document":{'.length;
  writeFileSync(file, Buffer.concat([bytes.subarray(0, at), Buffer.from('"a_later_key":1,'), bytes.subarray(at)]));
}
/// Waits until the session has been saved over what was in its file.
async function savedAgain(file) {
  for (const until = Date.now() + patience; !existsSync(file); await sleep(50)) assert.ok(Date.now() < until);
}

for (const [cause, { before = [], after: then = before, harm = () => {}, mend = () => {}, why }] of Object.entries({
  "whose mesh file is away": {
    before: ["--asset-root"],
    harm: ({ root }) => renameSync(join(root, "leaf.obj"), join(root, "away.obj")),
    mend: ({ root }) => renameSync(join(root, "away.obj"), join(root, "leaf.obj")),
    why: /leaf\.obj/,
  },
  "that needs --asset-root, which is forgotten": { before: ["--asset-root"], after: [], why: /--asset-root/ },
  "with a key of a later version": {
    harm: ({ file }) => fromALaterVersion(file),
    mend: ({ file }) =>
      writeFileSync(file, readFileSync(file).toString("latin1").replace('"a_later_key":1,', ""), "latin1"),
    why: /a_later_key/,
  },
  "with more than --max-vertices": { after: ["--max-vertices", "624"], why: /--max-vertices/ },
}))
  test(`a kept session ${cause} is kept aside, the page and the log tell, and moved back it is restored`, async () => {
    const kept = folder(),
      root = join(kept, "root"),
      file = join(kept, "main.session");
    mkdirSync(root);
    writeFileSync(join(root, "leaf.obj"), leaf);
    const start = (options) =>
      Server.start("--state-dir", kept, ...options.flatMap((flag) => (flag === "--asset-root" ? [flag, root] : flag)));
    // With 624 vertices the seed, which begins where nothing is restored, would be too much.
    const small = then.includes("--max-vertices") ? ["--scene", "hanging-strip"] : [];
    let server = await start(before);
    let client = await watch(server);
    if (before.length > 0) await client.request("scene.patch", { patch: named("leaf.obj") });
    await client.request("mesh.upload", { name: "mine", obj: leaf });
    await client.request("scene.patch", { patch: { name: "mine" } });
    const { document, revision } = await client.request("scene.get");
    await server.stop();
    harm({ root, file });
    const bytes = readFileSync(file);
    const meshes = readdirSync(kept).filter((name) => name.startsWith("main.mesh-"));
    assert.equal(meshes.length, 1);

    server = await start([...then, ...small]);
    for (let visit = 0; visit < 2; ++visit) {
      // a page that comes later is told, too
      client = await watch(server);
      const { text } = await client.notification("notice", ({ level }) => level === "error");
      assert.match(text, /cannot be restored.*is kept in .*main\.not-restored/);
      assert.match(text, why);
      await client.close();
    }
    assert.match(server.stderr, /event=session_not_restored session=main why=.*main\.not-restored/);
    await savedAgain(file);
    const aside = join(kept, "main.not-restored");
    assert.deepEqual(readdirSync(aside).sort(), [...meshes, "main.session"].sort());
    assert.deepEqual(readFileSync(join(aside, "main.session")), bytes);
    // Uploads that push the old mesh out of the new session leave the one aside.
    client = await watch(server);
    for (let i = 0; i < 17; ++i) await client.request("mesh.upload", { name: `new ${i}`, obj: leaf });
    assert.equal(existsSync(join(kept, meshes[0])), false);
    await server.stop();

    for (const name of readdirSync(aside)) renameSync(join(aside, name), join(kept, name));
    mend({ root, file });
    server = await start(before);
    client = await watch(server);
    const back = await client.request("scene.get");
    assert.deepEqual([back.document, back.revision], [document, revision]);
    await client.request("scene.patch", { patch: named("mine") });
    await server.stop();
  });

test("what is moved aside takes nothing's place: a second damaged file, and a second session", async () => {
  const kept = folder(),
    file = join(kept, "main.session");
  for (const [i, bytes] of ["first", "second"].entries()) {
    writeFileSync(file, bytes);
    writeFileSync(join(kept, "main.mesh-0123456789abcdef"), bytes);
    writeFileSync(join(kept, "main.mesh-1111111111111111"), `clothlab mesh 1\nlarge\n${leaf}`);
    truncateSync(join(kept, "main.mesh-1111111111111111"), 9 << 20); // more than an upload may have
    const server = await Server.start("--state-dir", kept);
    await savedAgain(file);
    assert.equal(await server.stop(), 0);
    assert.match(server.stderr, /main\.mesh-1{16}: it is larger than an upload may be; it was moved/);
    assert.equal(lstatSync(join(kept, `main.mesh-1111111111111111.unreadable${i === 0 ? "" : "-2"}`)).size, 9 << 20);
    for (const name of ["main.session", "main.mesh-0123456789abcdef"])
      assert.equal(readFileSync(join(kept, `${name}.unreadable${i === 0 ? "" : "-2"}`), "utf8"), bytes);
    fromALaterVersion(file);
    const later = readFileSync(file);
    await (await Server.start("--state-dir", kept)).stop();
    assert.deepEqual(readFileSync(join(kept, `main.not-restored${i === 0 ? "" : "-2"}`, "main.session")), later);
  }
});

for (const [what, make] of [
  ["a folder", (path) => mkdirSync(path)],
  ["a pipe", (path) => assert.equal(spawnSync("mkfifo", [path]).status, 0)],
  ["a link to nothing", (path) => assert.equal(spawnSync("ln", ["-s", "/no/such/file", path]).status, 0)],
].slice(0, thorough ? 3 : 1))
  test(`${what} with the name of a session's file does no harm: it stays, the session runs unsaved and says so`, async () => {
    const kept = folder(),
      file = join(kept, "main.session"),
      mesh = "main.mesh-0123456789abcdef";
    make(file);
    writeFileSync(join(kept, mesh), `clothlab mesh 1\nmine\n${leaf}`);
    const is = lstatSync(file, { throwIfNoEntry: false })?.ino;
    const server = await Server.start("--state-dir", kept);
    const client = await watch(server);
    const { text } = await client.notification("notice", ({ level }) => level === "error");
    assert.match(
      text,
      /^the saved session cannot be restored: main\.session: it is no file; move it away.*not saved before the server starts again/,
    );
    assert.ok(server.stderr.includes(`${file}: it is no file`), "the log names the folder, too");
    await client.frame((frame) => frame.time > 2.5);
    await client.request("scene.patch", { patch: { name: "runs" } });
    // Uploads push the mesh out of the session, and leave its file.
    for (let i = 0; i < 17; ++i) await client.request("mesh.upload", { name: `new ${i}`, obj: leaf });
    assert.equal(await server.stop(), 0);
    assert.equal(lstatSync(file, { throwIfNoEntry: false })?.ino, is);
    assert.deepEqual(readdirSync(kept).sort(), [mesh, "main.session"]);
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

test("a document that patches make too large for a client is refused with its size, and the one before is kept", async () => {
  const kept = folder();
  let server = await Server.start("--state-dir", kept);
  let client = await Client.connect(server);
  const most = (await client.notification("hello")).limits.document_bytes;
  const vertices = Array.from({ length: 600 }, (_, i) => [(i % 2) + 0.123456789, 1.123456789, i / 2 + 0.123456789]);
  const triangles = Array.from({ length: 598 }, (_, i) => [i, i + 1, i + 2]);
  const weights = Array.from({ length: 1000 }, () => ({ at: "vertex:0", mass: 0.00123456789 }));
  await client.request("scene.load", { scene: { version: 1, cloths: [{ mesh: { vertices, triangles } }] } });
  await client.request("scene.patch", { patch: { cloths: [{ mesh: { vertices, triangles }, name: "a" }] } });
  await client.request("scene.patch", { patch: [{ op: "add", path: "/cloths/0/weights", value: weights }] });
  await client.request("sim.pause");
  const copies = (from, count) =>
    Array.from({ length: count }, (_, i) => [
      { op: "copy", from: "/cloths/0", path: "/cloths/-" },
      { op: "replace", path: `/cloths/${from + i}/name`, value: `copy ${from + i}` },
    ]).flat();
  const one = JSON.stringify((await client.request("scene.get")).document.cloths[0]).length;
  const fitting = Math.floor(most / one) - 2; // what is not of cloths has room, too
  await client.request("scene.patch", { patch: copies(1, fitting) });
  const { code, data } = await client.refusal("scene.patch", { patch: copies(fitting + 1, 60 - fitting) });
  assert.equal(code, -32602);
  assert.equal(data.path, "");
  const bytes = Number(/^a scene of (\d+) bytes of JSON/.exec(data.found)[1]);
  assert.ok(bytes > 4 * 1024 * 1024, `more than any client can get: ${bytes}`);
  assert.match(data.allowed, new RegExp(`^at most ${most} where it is served; keep large meshes in .obj`));
  const { document, revision } = await client.request("scene.get");
  assert.equal(document.cloths.length, fitting + 1);
  await client.request("scene.undo");
  await client.request("scene.redo");
  const viewer = await Client.connect(server);
  assert.deepEqual((await viewer.notification("scene")).document, document);
  await server.stop();
  server = await Server.start("--state-dir", kept);
  client = await Client.connect(server);
  assert.deepEqual((await client.notification("scene")).document, document);
  assert.ok((await client.request("scene.get")).revision > revision);
  assert.equal(await server.stop(), 0);

  const large = join(kept, "large.json");
  const cloths = Array.from({ length: 60 }, (_, i) => ({ ...document.cloths[0], name: `cloth ${i}` }));
  writeFileSync(large, JSON.stringify({ ...document, cloths }));
  const refused = await runProgram(["serve", "--port", "0", "--scene", large]);
  assert.equal(refused.code, 2);
  assert.match(refused.stderr, /large\.json: a scene of \d{7} bytes of JSON.*; at most 3145728 where it is served/);
  const valid = await runProgram(["validate", large]);
  assert.equal(valid.code, 0);
  assert.match(valid.stderr, /`clothlab serve` refuses it: a scene of \d{7} bytes/);
});
