// Reads the binary messages of the protocol. Written from the contract, not from the server's code. Anything but an
// exact message throws a BadMessage; nothing outside the message is ever read.
import { readCompressed } from "./decode_c16.mjs";

const headerBytes = 64;
const topology = 1,
  frame = 2;
const f32 = 0,
  c16 = 2; // between them q16
const knownFlags = 3; // asleep, diverged

export class BadMessage extends Error {}

function demand(condition, what) {
  if (!condition) throw new BadMessage(what);
}

/// Reads the bytes of one message; throws a BadMessage. A c16 frame is read with the topology that came before it.
export function decode(bytes, topologyBefore = null) {
  demand(bytes.byteLength >= headerBytes, `${bytes.byteLength} bytes are no header`);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const header = readHeader(view);
  checkHeader(header, view.byteLength);
  if (header.kind === topology) return { ...header, ...readTopology(view, header) };
  if (header.encoding === c16) return { ...header, ...readC16(bytes.subarray(headerBytes), header, topologyBefore) };
  const vertices = header.encoding === f32 ? readFloat32(view, header) : readQuantised(view, header);
  return { ...header, ...vertices, ...readField(view, header) };
}

function readHeader(view) {
  const floats = (at, count) => Array.from({ length: count }, (_, i) => view.getFloat32(at + 4 * i, true));
  return {
    kind: view.getUint8(0),
    encoding: view.getUint8(1),
    flags: view.getUint16(2, true),
    topologyRevision: view.getUint32(4, true),
    sequence: view.getUint32(8, true),
    vertexCount: view.getUint32(12, true),
    time: view.getFloat64(16, true),
    step: Number(view.getBigUint64(24, true)),
    boxMinimum: floats(32, 3),
    boxExtent: floats(44, 3),
    payloadBytes: view.getUint32(56, true),
    range: view.getFloat32(60, true), // of the field; 0 without one
  };
}

function checkHeader(header, byteLength) {
  const { kind, encoding, flags } = header;
  demand(kind === topology || kind === frame, `there is no kind ${kind}`);
  demand(encoding === f32 || (encoding <= c16 && kind === frame), `kind ${kind} has no encoding ${encoding}`);
  demand((flags & ~(kind === frame ? knownFlags : 0)) === 0, `kind ${kind} has no flags ${flags}`);
  demand(header.time >= 0 && header.time < Infinity, `the time is ${header.time}`);
  demand(header.boxMinimum.every(Number.isFinite), `the box begins at ${header.boxMinimum}`);
  demand(
    header.boxExtent.every((extent) => extent >= 0 && extent < Infinity),
    `the box has the extent ${header.boxExtent}`,
  );
  demand(
    Object.is(header.range, 0) || (kind === frame && header.range > 0 && header.range < Infinity),
    `the range of kind ${kind} is ${header.range}`,
  );
  demand(
    header.payloadBytes === byteLength - headerBytes,
    `the header says ${header.payloadBytes} payload bytes, ${byteLength - headerBytes} came`,
  );
}

function readTopology(view, { payloadBytes, vertexCount }) {
  demand(payloadBytes >= 8, "the topology has no counts");
  let at = headerBytes;
  const u32 = () => view.getUint32((at += 4) - 4, true);
  const triangleCount = u32(),
    clothCount = u32();
  const expected = 8 + 8 * clothCount + 12 * triangleCount + 8 * vertexCount;
  demand(payloadBytes === expected, `the topology's counts ask for ${expected} bytes, it has ${payloadBytes}`);
  const cloths = Array.from({ length: clothCount }, () => ({ firstVertex: u32(), vertexCount: u32() }));
  const covered = cloths.reduce((next, cloth) => (cloth.firstVertex === next ? next + cloth.vertexCount : NaN), 0);
  demand(covered === vertexCount, `the cloths do not share out ${vertexCount} vertices, one after another`);
  const triangles = Array.from({ length: triangleCount }, () => [u32(), u32(), u32()]);
  demand(
    triangles.every((corners) => corners.every((corner) => corner < vertexCount)),
    `a triangle's corner is not below ${vertexCount}`,
  );
  const texture = Array.from({ length: vertexCount }, () => [
    view.getFloat32((at += 4) - 4, true),
    view.getFloat32((at += 4) - 4, true),
  ]);
  return { cloths, triangles, texture };
}

/// One byte for each vertex after all vertices, of the range.
function readField(view, { vertexCount, range }) {
  if (range === 0) return {};
  const first = view.byteLength - vertexCount;
  return { field: Array.from({ length: vertexCount }, (_, i) => (range * view.getUint8(first + i)) / 255) };
}

function readFloat32(view, { payloadBytes, vertexCount, range }) {
  demand(payloadBytes === (range > 0 ? 25 : 24) * vertexCount, "an f32 frame has 24 bytes a vertex, 25 with a field");
  const triple = (at) => [0, 4, 8].map((offset) => view.getFloat32(at + offset, true));
  const positions = [],
    normals = [];
  for (let i = 0; i < vertexCount; ++i) {
    positions.push(triple(headerBytes + 24 * i));
    normals.push(triple(headerBytes + 24 * i + 12));
  }
  return { positions, normals };
}

const place = ({ boxMinimum, boxExtent }, quantised) =>
  quantised.map((u, axis) => boxMinimum[axis] + (boxExtent[axis] * u) / 65535);

function readC16(payload, header, topologyBefore) {
  const { vertexCount, range } = header;
  demand(topologyBefore?.vertexCount === vertexCount, `no topology of ${vertexCount} vertices came before a c16 frame`);
  const read = readCompressed(payload, vertexCount, header.boxExtent, topologyBefore.triangles, range > 0);
  demand(read, `the payload is no deflate stream of the numbers of ${vertexCount} vertices`);
  const field = range > 0 ? { field: Array.from(read.fieldBytes, (byte) => (range * byte) / 255) } : {};
  const { quantised, numbers } = read;
  return { quantised, numbers, positions: quantised.map((q) => place(header, q)), ...field };
}

function readQuantised(view, header) {
  const { payloadBytes, vertexCount, range } = header;
  demand(payloadBytes === (range > 0 ? 9 : 8) * vertexCount, "a q16 frame has 8 bytes a vertex, 9 with a field");
  const quantised = [],
    normals = [];
  for (let i = 0; i < vertexCount; ++i) {
    const at = headerBytes + 8 * i;
    quantised.push([0, 2, 4].map((offset) => view.getUint16(at + offset, true)));
    normals.push(octahedral(view.getInt8(at + 6), view.getInt8(at + 7)));
  }
  return { quantised, positions: quantised.map((q) => place(header, q)), normals };
}

// The octahedron |x| + |y| + |z| = 1 unfolded to the square, its lower half turned outwards.
function octahedral(a, b) {
  let x = Math.max(a / 127, -1),
    y = Math.max(b / 127, -1);
  const z = 1 - Math.abs(x) - Math.abs(y);
  if (z < 0) [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
  const length = Math.hypot(x, y, z) || 1;
  return [x / length, y / length, z / length];
}
