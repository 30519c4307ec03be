// Frames of slow lines: the golden c16 messages unpacked, everything else refused, and when the page asks for them.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before, test } from "node:test";
import { inflateRawSync } from "node:zlib";
import { holding, right, wrong } from "../protocol/c16_contents.mjs";
import { load } from "./module.mjs";

const read = (name) => readFileSync(new URL(`../golden/${name}`, import.meta.url));
const golden = (name) => ({ bytes: new Uint8Array(read(`${name}.bin`)), content: JSON.parse(read(`${name}.json`)) });
/// As a browser's DecompressionStream: exactly one stream.
const inflate = async (bytes) => {
  const { buffer, engine } = inflateRawSync(bytes, { info: true });
  if (engine.bytesWritten !== bytes.length) throw new TypeError("bytes after the stream");
  return new Uint8Array(buffer);
};

let unpack, protocol, packedNormals, LineWatch;
before(async () => {
  unpack = await load("link/unpack");
  protocol = await load("link/protocol");
  ({ packedNormals } = await load("link/normals"));
  ({ LineWatch } = await load("link/line_watch"));
});

const meshOf = ({ header, triangles }) => ({
  vertexCount: header.vertex_count,
  triangles: Uint32Array.from(triangles.flat()),
});
function unpackerFor(content) {
  const unpacker = new unpack.Unpacker(inflate);
  unpacker.take(meshOf(content));
  return unpacker;
}

test("the golden c16 frames become q16 frames with the same positions, field and header", async () => {
  for (const name of ["frame-c16", "frame-c16-speed"]) {
    const { bytes, content } = golden(name);
    assert.ok(protocol.isPacked(bytes.buffer));
    const { frame } = protocol.decode(await unpackerFor(content).unpack(bytes.slice().buffer));
    const words = protocol.q16Words(frame);
    content.vertices.forEach(({ quantised }, i) => assert.deepEqual([...words.subarray(4 * i, 4 * i + 3)], quantised));
    assert.deepEqual([...(protocol.fieldBytes(frame) ?? [])], content.field_bytes ?? []);
    const { header } = frame;
    assert.deepEqual(
      [header.encoding, header.time, header.step, header.boxExtent, header.range],
      [1, content.header.time, content.header.step, content.header.box_extent, content.header.range ?? 0],
    );
  }
  assert.ok(!protocol.isPacked(golden("frame-q16").bytes.buffer));
  assert.ok(!protocol.isPacked(new ArrayBuffer(1)));
});

test("normals made in the page are the server's", () => {
  const { content } = golden("frame-q16");
  const { triangles } = golden("topology").content;
  const numbers = Uint16Array.from(content.vertices.flatMap(({ quantised }) => quantised));
  const packed = packedNormals(numbers, Uint32Array.from(triangles.flat()), content.header.box_extent);
  const decoded = ([p, q]) => {
    const z = 1 - Math.abs(p) - Math.abs(q);
    const n = z >= 0 ? [p, q, z] : [(1 - Math.abs(q)) * (p < 0 ? -1 : 1), (1 - Math.abs(p)) * (q < 0 ? -1 : 1), z];
    return n.map((value) => value / Math.hypot(...n));
  };
  content.vertices.forEach(({ normal }, i) => {
    const own = decoded([(packed[i] << 24) >> 24, (packed[i] << 16) >> 24].map((value) => value / 127));
    const off = Math.hypot(...own.map((value, axis) => value - normal[axis]));
    // Of one part in 127 on each axis of the octahedron, whose faces are up to sqrt(3) times as steep as the sphere.
    assert.ok(off < (2 * Math.sqrt(3)) / 127, `vertex ${i}: ${own}, not ${normal}`);
  });
});

test("a c16 frame that is cut, damaged, too long or of another mesh is refused, and the next one is read", async () => {
  const { bytes, content } = golden("frame-c16-speed");
  const unpacker = unpackerFor(content);
  const refused = async (message, what) =>
    assert.rejects(unpacker.unpack(message.slice().buffer), { message: /./, constructor: unpack.BadMessage }, what);
  for (let length = 0; length < bytes.length; ++length) {
    await refused(bytes.subarray(0, length), `${length} bytes`);
    const announced = bytes.slice(0, length); // also where the header tells the truth about what is left
    if (length >= 64) new DataView(announced.buffer).setUint32(56, length - 64, true);
    if (length >= 64) await refused(announced, `${length} bytes, announced`);
  }
  for (const { content: held } of right) await unpacker.unpack(holding(bytes, held).buffer);
  for (const { what, content: held } of wrong(content.content)) await refused(holding(bytes, held), what);
  await refused(golden("frame-q16").bytes, "q16");
  unpacker.take({ vertexCount: 8, triangles: new Uint32Array() });
  await refused(bytes, "another mesh");
  unpacker.take(meshOf(content));
  await unpacker.unpack(bytes.slice().buffer);
});

test("the line is taken for slow after three seconds of late answers and missing frames, not on a busy page", () => {
  const slow = { pictures: 60, frames: 20, latency: 200, steps: true };
  const after = (...seconds) => {
    const watch = new LineWatch();
    return seconds.map((second) => watch.second({ ...slow, ...second }));
  };
  assert.deepEqual(after({}, {}, {}), [false, false, true]);
  assert.deepEqual(after({}, {}, { frames: 50 }, {}, {}), [false, false, false, false, false]);
  for (const [second, what] of [
    [{ pictures: 15, frames: 14 }, "the page draws no faster"],
    [{ pictures: 0, frames: 0 }, "the page is hidden"],
    [{ latency: 5 }, "the server sends no more"],
    [{ steps: false }, "the session rests, or cannot keep up"],
  ])
    assert.ok(!after(...Array(9).fill(second)).includes(true), what);
});
