// The page that plays recordings reads the golden one, and refuses everything that is not exactly a recording.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before, test } from "node:test";
import { inflateRawSync } from "node:zlib";
import { load } from "./module.mjs";

const read = (name) => readFileSync(new URL(`../golden/${name}`, import.meta.url));
const golden = new Uint8Array(read("recording.clothlab"));
const content = JSON.parse(read("recording.json"));
/// As a browser's DecompressionStream: exactly one stream.
const inflate = async (bytes) => {
  const { buffer, engine } = inflateRawSync(bytes, { info: true });
  if (engine.bytesWritten !== bytes.length) throw new TypeError("bytes after the stream");
  return new Uint8Array(buffer);
};

let page;
before(async () => (page = await load("player/recording")));
const open = (bytes) => page.Reader.open(bytes.slice().buffer, inflate);

/// The chunks of a recording: kind, and where each begins and ends.
function chunksOf(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const chunks = [];
  for (let at = 16; at < bytes.length; at = chunks.at(-1).end)
    chunks.push({
      kind: Buffer.from(bytes.slice(at, at + 4)).toString(),
      at,
      end: at + 12 + view.getUint32(at + 4, true),
    });
  return chunks;
}

async function refused(bytes, what) {
  try {
    const recording = await open(bytes);
    await Promise.all(recording.groups.map((group) => page.readGroup(group, inflate)));
  } catch (error) {
    assert.equal(error.constructor, page.BadRecording, `${what}: ${error.stack}`);
    assert.ok(error.message.length > 20, what);
    return error.message;
  }
  assert.fail(`${what} is taken`);
}

test("the golden recording is read to what stands beside it", async () => {
  const recording = await open(golden);
  assert.equal(recording.name, content.head.scene.name);
  assert.equal(recording.rate, content.head.rate);
  assert.equal(recording.frames, content.done.frames);
  assert.deepEqual(recording.diverged, content.done.diverged);
  assert.equal(recording.groups.length, content.groups.length);
  let gravity = content.head.scene.gravity;
  let first = 0;
  for (const [i, group] of recording.groups.entries()) {
    const { frames, origin, quantum, edit_before } = content.groups[i];
    gravity = edit_before?.patch.gravity ?? gravity;
    const { document, topology, restLengths } = group.setting;
    assert.deepEqual(document.gravity, gravity);
    const { vertices, triangles } = content.body;
    assert.deepEqual(document.colliders[0].mesh, { vertices, triangles });
    assert.deepEqual([...topology.triangles], content.triangles.flat());
    assert.deepEqual([...topology.textureCoordinates], content.texture_coordinates.flat());
    assert.deepEqual([...restLengths], content.rest);
    assert.deepEqual([group.first, group.count], [first, frames.length]);
    first += frames.length;
    const moments = await page.readGroup(group, inflate);
    for (const [k, { time, step, flags, moving, numbers }] of frames.entries()) {
      const moment = moments[k];
      assert.deepEqual(
        { ...moment, numbers: [...moment.numbers] },
        {
          time,
          step,
          asleep: (flags & 1) !== 0,
          diverged: (flags & 2) !== 0,
          low: origin,
          quantum,
          moved: moving,
          numbers: numbers.flat(),
        },
      );
    }
  }
});

test("a recording that is cut off anywhere is refused, and says so", async () => {
  for (let length = 0; length < golden.length; ++length) {
    const message = await refused(golden.subarray(0, length), `${length} bytes`);
    if (length >= 16) assert.match(message, /cut off|no end/, `${length} bytes`);
  }
  assert.match(await refused(new Uint8Array([...golden, 0]), "a byte more"), /more after its end|cut off/);
});

test("a recording with a changed byte is refused, wherever it is", async () => {
  for (let at = 0; at < golden.length; ++at) {
    const changed = golden.slice();
    changed[at] ^= 1 << (at % 8);
    await refused(changed, `byte ${at} changed`);
  }
});

test("chunks that are whole but not in their order, or twice, or not there, are refused", async () => {
  const chunks = chunksOf(golden);
  const of = (kind) => chunks.filter((chunk) => chunk.kind === kind);
  assert.deepEqual(
    chunks.map(({ kind }) => kind),
    ["head", "mesh", "rest", "body", "fram", "edit", "fram", "done"],
  );
  const made = (list) =>
    new Uint8Array([...golden.subarray(0, 16), ...list.flatMap((c) => [...golden.subarray(c.at, c.end)])]);
  await open(made(chunks));
  const without = (kind) => chunks.filter((chunk) => chunk.kind !== kind);
  for (const kind of ["head", "mesh", "rest", "fram", "done"]) await refused(made(without(kind)), `no ${kind}`);
  await refused(made([...of("head"), ...chunks]), "two heads");
  await refused(made([...chunks, ...of("done")]), "two ends");
  await refused(made([...chunks, ...of("fram")]), "frames after the end");
  await refused(made([...of("head"), ...of("fram"), ...of("mesh"), ...of("done")]), "frames before their mesh");
});

test("what is no recording, or one of a later version, is refused with what it is", async () => {
  assert.match(
    await refused(new TextEncoder().encode("<!doctype html><title>no recording</title>"), "a page"),
    /no recording/,
  );
  const later = golden.slice();
  later[8] = 2;
  assert.match(await refused(later, "version 2"), /version 2/);
});
