// The messages in tests/golden, read by the tests' decoder and by the page's. Both refuse anything else, each with a
// reason, and never read outside the message.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before, test } from "node:test";
import { holding, right, wrong } from "./c16_contents.mjs";
import { BadMessage, decode } from "./decode.mjs";
import { load } from "../page/module.mjs";

const folder = new URL("../golden/", import.meta.url);
const withField = ["frame-q16-speed", "frame-f32-speed"];
const compressed = ["frame-c16", "frame-c16-speed"];
const plain = ["topology", "frame-q16", "frame-q16-asleep", "frame-f32", "frame-f32-diverged", ...withField];
const names = [...plain, ...compressed];
const golden = names.map((name) => ({
  name,
  bytes: new Uint8Array(readFileSync(new URL(`${name}.bin`, folder))),
  content: JSON.parse(readFileSync(new URL(`${name}.json`, folder))),
}));
const called = (name) => golden.find((message) => message.name === name);

/// `decode` takes the bytes of one message; `name` appears in the test's messages.
const decoders = [
  { name: "the tests' decoder", decode, BadMessage, reads: ({ content: { header } }) => header.encoding !== 2 },
  ...compressed.map((name) => {
    const { header, triangles } = called(name).content;
    return {
      name: "the tests' decoder of c16",
      decode: (bytes) => decode(bytes, { vertexCount: header.vertex_count, triangles }),
      BadMessage,
      reads: (message) => message.name === name,
    };
  }),
];
const pageAt = decoders.length;
/// Those that read more than one c16 message.
const plainDecoders = () => [decoders[0], decoders[pageAt]];
before(async () => {
  const page = await load("link/protocol");
  decoders.push({
    name: "the page's decoder",
    decode(bytes) {
      const { topology, frame } = page.decode(bytes.slice().buffer);
      return topology ?? { ...frame.header, words: page.q16Words(frame), field: page.fieldBytes(frame) };
    },
    BadMessage: page.BadMessage,
    reads: ({ content: { header } }) => header.kind === 1 || header.encoding === 1,
  });
});

/// The bytes inside others that would be valid too: a reader that goes too far gets values instead of an error.
function embedded(bytes) {
  const around = new Uint8Array(bytes.length + 256).fill(1);
  around.set(bytes, 128);
  return around.subarray(128, 128 + bytes.length);
}
function changed(bytes, change) {
  const copy = bytes.slice();
  change(new DataView(copy.buffer), copy);
  return copy;
}
function refuses(decoder, bytes, what) {
  let answer;
  try {
    answer = decoder.decode(embedded(bytes));
  } catch (error) {
    assert.equal(error.constructor, decoder.BadMessage, `${decoder.name}, ${what}: ${error.stack}`);
    assert.ok(error.message.length > 10, what);
    return;
  }
  assert.fail(`${decoder.name} takes ${what}: ${JSON.stringify(answer).slice(0, 300)}`);
}
/// Calls `body(decoder, message)` for each decoder and each message that it can read.
function forEach(body) {
  for (const decoder of decoders) for (const message of golden.filter(decoder.reads)) body(decoder, message);
}

test("the tests' decoder reads each golden message to what stands beside it", () => {
  for (const {
    name,
    bytes,
    content: { header, ...content },
  } of golden) {
    const topologyBefore = { vertexCount: header.vertex_count, triangles: content.triangles };
    const read = decode(embedded(bytes), topologyBefore);
    assert.deepEqual(
      {
        kind: read.kind,
        encoding: read.encoding,
        flags: read.flags,
        topology_revision: read.topologyRevision,
        sequence: read.sequence,
        vertex_count: read.vertexCount,
        time: read.time,
        step: read.step,
        box_minimum: read.boxMinimum,
        box_extent: read.boxExtent,
        payload_bytes: read.payloadBytes,
        ...(read.range > 0 ? { range: read.range } : {}),
      },
      header,
      name,
    );
    if (header.kind === 1) {
      assert.deepEqual(
        read.cloths.map((cloth) => ({ first_vertex: cloth.firstVertex, vertex_count: cloth.vertexCount })),
        content.cloths,
      );
      assert.deepEqual(read.triangles, content.triangles);
      assert.deepEqual(read.texture, content.texture_coordinates);
    } else {
      assert.deepEqual(
        read.positions,
        content.vertices.map(({ position }) => position),
      );
      assert.deepEqual(read.field, content.field);
      if (header.encoding > 0)
        assert.deepEqual(
          read.quantised,
          content.vertices.map(({ quantised }) => quantised),
        );
      if (header.encoding === 2) {
        assert.deepEqual(read.numbers, content.numbers);
        continue;
      }
      content.vertices.forEach(({ normal }, i) =>
        assert.ok(Math.hypot(...normal.map((n, axis) => n - read.normals[i][axis])) < 1e-11),
      );
    }
  }
});

test("the page's decoder reads the golden topology and q16 frames to what stands beside them", () => {
  const page = decoders[pageAt];
  for (const message of golden.filter(page.reads)) {
    const { header, ...content } = message.content;
    const read = page.decode(message.bytes);
    if (header.kind === 1) {
      assert.equal(read.revision, header.topology_revision);
      assert.equal(read.vertexCount, header.vertex_count);
      assert.deepEqual(
        read.cloths.map((cloth) => ({ first_vertex: cloth.firstVertex, vertex_count: cloth.vertexCount })),
        content.cloths,
      );
      assert.deepEqual([...read.triangles], content.triangles.flat());
      assert.deepEqual([...read.textureCoordinates], content.texture_coordinates.flat());
      continue;
    }
    const { words, field, ...rest } = read;
    assert.deepEqual(rest, {
      kind: 2,
      encoding: 1,
      asleep: (header.flags & 1) !== 0,
      diverged: (header.flags & 2) !== 0,
      topologyRevision: header.topology_revision,
      sequence: header.sequence,
      vertexCount: header.vertex_count,
      time: header.time,
      step: header.step,
      boxMinimum: header.box_minimum,
      boxExtent: header.box_extent,
      payloadBytes: header.payload_bytes,
      range: header.range ?? 0,
    });
    assert.deepEqual(field && [...field], content.field_bytes ?? null);
    const expected = content.vertices.flatMap(({ quantised, octahedral: [a, b] }) => [
      ...quantised,
      (a & 255) | ((b & 255) << 8),
    ]);
    assert.deepEqual([...words], expected);
  }
});

test("a frame in an encoding that the page did not ask for is refused by it", () => {
  for (const name of ["frame-f32", "frame-f32-diverged", "frame-f32-speed", ...compressed])
    refuses(decoders[pageAt], called(name).bytes, name);
});

test("every truncated length is refused, and so is every longer one", () => {
  forEach((decoder, { name, bytes }) => {
    for (let length = 0; length < bytes.length; ++length)
      refuses(decoder, bytes.subarray(0, length), `${length} bytes of ${name}`);
    for (const more of [1, 2, 3, 4, 8, 24, 64]) {
      const longer = new Uint8Array(bytes.length + more);
      longer.set(bytes);
      refuses(decoder, longer, `${name} and ${more} bytes`);
    }
  });
});

// The fields of a header, and the changes of each that leave the message valid: any revision, sequence number and step;
// any finite time >= 0; any valid box; on frames both flags, with a field any finite range > 0. The others
// have few known values or follow from the payload.
const headerFields = [
  { at: 0, end: 2, name: "kind, encoding", legal: () => false },
  { at: 2, end: 4, name: "flags", legal: (view) => view.getUint8(0) === 2 && view.getUint16(2, true) <= 3 },
  { at: 4, end: 8, name: "topologyRevision", legal: () => true },
  { at: 8, end: 12, name: "sequence", legal: () => true },
  { at: 12, end: 16, name: "vertexCount", legal: () => false },
  {
    at: 16,
    end: 24,
    name: "time",
    legal: (view) => Number.isFinite(view.getFloat64(16, true)) && view.getFloat64(16, true) >= 0,
  },
  { at: 24, end: 32, name: "step", legal: () => true },
  ...[32, 36, 40].map((at) => ({
    at,
    end: at + 4,
    name: "boxMinimum",
    legal: (view) => Number.isFinite(view.getFloat32(at, true)),
  })),
  ...[44, 48, 52].map((at) => ({
    at,
    end: at + 4,
    name: "boxExtent",
    legal: (view) => Number.isFinite(view.getFloat32(at, true)) && view.getFloat32(at, true) >= 0,
  })),
  { at: 56, end: 60, name: "payloadBytes", legal: () => false },
  {
    at: 60,
    end: 64,
    name: "range",
    legal: (view, original) => {
      const range = view.getFloat32(60, true);
      return original.range > 0 && range > 0 && range < Infinity;
    },
  },
];

test("every flipped bit of a header is refused, or where it makes another legal value, taken as that and nothing else", (t) => {
  let taken = 0,
    refused = 0;
  forEach((decoder, { name, bytes }) => {
    const original = decoder.decode(bytes);
    for (const field of headerFields)
      for (let bit = 8 * field.at; bit < 8 * field.end; ++bit) {
        const flipped = changed(bytes, (_, copy) => (copy[bit >> 3] ^= 1 << (bit & 7)));
        const what = `${name} with bit ${bit & 7} of byte ${bit >> 3} (${field.name}) flipped`;
        if (!field.legal(new DataView(flipped.buffer), original)) {
          refuses(decoder, flipped, what);
          ++refused;
          continue;
        }
        const read = decoder.decode(embedded(flipped));
        for (const key of Object.keys(original))
          if (!mayDiffer(field.name, key, read.encoding))
            assert.deepEqual(read[key], original[key], `${what}: ${key} differs`);
        if (field.name in original) assert.notDeepEqual(read[field.name], original[field.name], what);
        ++taken;
      }
  });
  t.diagnostic(`${refused} refused, ${taken} taken`);
});

/// True if a change of `field` may also change the decoded value `key`: c16 predicts by lengths.
function mayDiffer(field, key, encoding) {
  const derived = {
    flags: ["asleep", "diverged"],
    topologyRevision: ["revision"],
    boxMinimum: ["positions"],
    boxExtent: encoding === 2 ? ["positions", "quantised"] : ["positions"],
    range: ["field"],
  };
  return key === field || (derived[field] ?? []).includes(key);
}

test("a time or a box that is not finite, and a box turned inside out, are refused", () => {
  forEach((decoder, { name, bytes }) => {
    for (const value of [NaN, Infinity, -Infinity, -1])
      refuses(
        decoder,
        changed(bytes, (view) => view.setFloat64(16, value, true)),
        `${name} at the time ${value}`,
      );
    for (let at = 32; at < 56; at += 4)
      for (const value of at < 44 ? [NaN, Infinity, -Infinity] : [NaN, Infinity, -Infinity, -1e-30])
        refuses(
          decoder,
          changed(bytes, (view) => view.setFloat32(at, value, true)),
          `${name} with ${value} at byte ${at}`,
        );
  });
});

test("counts that do not match the payload are refused, however large", () => {
  const others = (count) => [
    0,
    count - 1,
    count + 1,
    0x10000,
    0x20000000,
    0x7fffffff,
    0x80000000,
    0xfffffffe,
    0xffffffff,
  ];
  forEach((decoder, { name, bytes, content: { header } }) => {
    const places = header.kind === 1 ? [12, 56, 64, 68] : [12, 56]; // vertices, payload bytes, triangles, cloths
    for (const at of places)
      for (const count of others(new DataView(bytes.buffer).getUint32(at, true)))
        refuses(
          decoder,
          changed(bytes, (view) => view.setUint32(at, count >>> 0, true)),
          `${name} with the count ${count} at byte ${at}`,
        );
  });
});

test("a topology without counts, or with less than one, is refused", () => {
  const { bytes } = called("topology");
  for (const length of [0, 4])
    for (const decoder of plainDecoders())
      refuses(
        decoder,
        changed(bytes, (view) => view.setUint32(56, length, true)).subarray(0, 64 + length),
        `a payload of ${length} bytes`,
      );
});

test("counts that fit the payload's length but not each other are refused", () => {
  // Three cloths take as many bytes as two triangles: 24 bytes move from one to the other.
  const { bytes } = called("topology");
  for (const decoder of plainDecoders())
    refuses(
      decoder,
      changed(bytes, (view) => {
        view.setUint32(64, view.getUint32(64, true) - 2, true);
        view.setUint32(68, view.getUint32(68, true) + 3, true);
      }),
      "a topology with three more cloths and two fewer triangles",
    );
});

test("a triangle with a vertex that is not there is refused, and so are cloths that overlap or leave a gap", () => {
  const { bytes, content } = called("topology");
  const firstTriangle = 64 + 8 + 8 * content.cloths.length,
    corners = 3 * content.triangles.length;
  for (const decoder of plainDecoders()) {
    for (let corner = 0; corner < corners; ++corner)
      for (const vertex of [content.header.vertex_count, 0xffffffff])
        refuses(
          decoder,
          changed(bytes, (view) => view.setUint32(firstTriangle + 4 * corner, vertex, true)),
          `corner ${corner} at vertex ${vertex}`,
        );
    for (let at = 72; at < firstTriangle; at += 4)
      for (const by of [1, -1])
        refuses(
          decoder,
          changed(bytes, (view) => view.setUint32(at, (view.getUint32(at, true) + by) >>> 0, true)),
          `a range changed at byte ${at}`,
        );
  }
});

test("a kind or an encoding that there is not, or not of such a message, is refused, whatever the rest is like", () => {
  forEach((decoder, { name, bytes }) => {
    for (let kind = 0; kind < 256; ++kind)
      for (const encoding of [0, 1, 2, 3, 255]) {
        if (kind === bytes[0] && encoding === bytes[1]) continue;
        const what = `${name} as kind ${kind}, encoding ${encoding}`;
        refuses(
          decoder,
          changed(bytes, (_, copy) => copy.set([kind, encoding])),
          what,
        );
      }
  });
});

test("a c16 frame is refused without the topology of its vertices, and if its deflate stream holds more or less", () => {
  const speed = called("frame-c16-speed");
  const { triangles } = speed.content;
  for (const topologyBefore of [null, { vertexCount: 8, triangles }])
    assert.throws(() => decode(speed.bytes, topologyBefore), BadMessage);
  const reader = decoders.find(({ reads }) => reads(speed) && !reads(called("frame-c16")));
  for (const { content } of right) reader.decode(holding(speed.bytes, content));
  for (const { what, content } of wrong(speed.content.content)) refuses(reader, holding(speed.bytes, content), what);
});
