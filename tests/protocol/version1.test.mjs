// Version 1 of the scene, of the protocol and of recordings, as tests/golden/version1 keeps it: read for ever, and
// meaning what it meant.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { inflateRawSync } from "node:zlib";
import { load } from "../page/module.mjs";
import { Client, runProgram, Server } from "./harness.mjs";

const golden = fileURLToPath(new URL("../golden/version1/", import.meta.url));
const read = (name) => readFileSync(join(golden, name));
const out = mkdtempSync(join(tmpdir(), "clothlab-version1-"));
let server;
before(async () => (server = await Server.start("--scene", "seed")));
after(async () => {
  await server?.stop();
  rmSync(out, { recursive: true, force: true });
});

/// Why `found` lacks something that `told` has, or null. What else `found` has may have been added since: a key of an
/// object, an element of a list of names or objects.
function lacks(found, told, at = "") {
  if (told === "<number>" || told === "<text>")
    return typeof found === (told === "<text>" ? "string" : "number") ? null : `${at}: ${JSON.stringify(found)}`;
  if (told === null || typeof told !== "object")
    return Object.is(found, told) ? null : `${at}: ${JSON.stringify(found)} instead of ${JSON.stringify(told)}`;
  if (found === null || typeof found !== "object") return `${at}: ${JSON.stringify(found)}`;
  if (Array.isArray(told) && told.every((each) => typeof each !== "number")) {
    const none = told.find((each) => !found.some((one) => lacks(one, each) === null));
    return none === undefined ? null : `${at}: ${JSON.stringify(none)} is not in it`;
  }
  if (Array.isArray(told) && told.length !== found.length) return `${at}: ${found.length} instead of ${told.length}`;
  for (const [key, value] of Object.entries(told)) {
    const why = lacks(found[key], value, `${at}/${key}`);
    if (why !== null) return why;
  }
  return null;
}

test("the files of version 1 are those that were kept: a change of the format gets files of its own", () => {
  const sums = Object.fromEntries(
    readdirSync(golden).map((name) => [name, createHash("sha256").update(read(name)).digest("hex").slice(0, 16)]),
  );
  assert.deepEqual(sums, {
    "leaf.obj": "0a266c5cc4497c38",
    "recording.clothlab": "29518f2ac8f8c538",
    "scene.json": "89c0ea493cf392e8",
    "transcript.jsonl": "88586483f6101ba2",
  });
});

test("a scene with every key of version 1 is loaded, and each value is the one that it has", async () => {
  const scene = JSON.parse(read("scene.json"));
  const client = await Client.connect(server, { session: "scene" });
  await client.request("sim.pause");
  await client.request("mesh.upload", { name: "leaf.obj", obj: read("leaf.obj").toString() });
  await client.request("scene.load", { scene });
  const { document } = await client.request("scene.get");
  assert.equal(lacks(document, scene), null);
  await client.request("stream.subscribe", { encoding: "q16", rate: 30, in_flight: 1 });
  assert.equal((await client.frame((frame) => frame.vertexCount !== 625)).vertexCount, 87);
  await client.close();
});

test("a client of version 1 gets the answers that it got, with all that they had", async () => {
  const client = await Client.connect(server);
  let at = 0; // of the messages, those before it have been asked for
  for (const line of read("transcript.jsonl").toString().trim().split("\n")) {
    const { send, receive, binary } = JSON.parse(line);
    if (send) {
      client.send(JSON.stringify(send));
    } else if (binary) {
      await client.until(
        () => client.binary,
        (message) => lacks(message, binary) === null,
        line,
      );
    } else {
      // An answer has its id; a notification comes after what came before it.
      const answer = "id" in receive;
      const same = (message) => (answer ? message.id === receive.id : lacks(message, receive) === null);
      const message = await client.until(() => (answer ? client.messages : client.messages.slice(at)), same, line);
      assert.equal(lacks(message, receive), null, line);
      if (!answer) at = client.messages.indexOf(message) + 1;
    }
  }
  await client.close();
});

test("a recording of version 1 is read by the page that plays it, and becomes a page and a film", async () => {
  const recording = join(golden, "recording.clothlab");
  const { Reader, readGroup } = await load("player/recording");
  const inflate = async (bytes) => new Uint8Array(inflateRawSync(bytes));
  const { frames, groups, name } = await Reader.open(new Uint8Array(read("recording.clothlab")).buffer, inflate);
  assert.deepEqual([frames, name], [4, "golden recording"]);
  const moments = (await Promise.all(groups.map((group) => readGroup(group, inflate)))).flat();
  assert.equal(moments.length, frames);
  for (const form of ["page.html", "film.pc2"]) {
    const { code, stderr } = await runProgram(["record", recording, "--out", join(out, form)]);
    assert.equal(code, 0, stderr);
  }
  const film = readFileSync(join(out, "film.pc2"));
  assert.equal(film.readInt32LE(16), 11); // vertices: eight of a fan, three of a triangle
});
