// The binary messages (server/net/README.md): 64-byte header, then the payload, little-endian.
import type { MovedCollider } from "./scene_types";
import type { FileNumbers } from "./vertex_numbers";

const headerBytes = 64;
const kindTopology = 1;
const kindFrame = 2;
const encodingF32 = 0;
const encodingQ16 = 1;
const encodingC16 = 2;
const q16Bytes = 8; ///< per vertex
const flagAsleep = 1;
const flagDiverged = 2;

/// What stream.subscribe may ask for beside the vertices: a number at each of them.
export type FieldName = "strain" | "speed" | "contact";
/// What the cloth may be coloured by: besides these the growing mode of a blow-up, which the page finds itself.
export type ShownField = FieldName | "growth";

export interface Header {
  kind: number;
  encoding: number;
  asleep: boolean;
  diverged: boolean;
  topologyRevision: number;
  sequence: number;
  vertexCount: number;
  time: number; ///< simulated time [s]
  step: number;
  boxMinimum: [number, number, number]; ///< [m]
  boxExtent: [number, number, number]; ///< [m]
  payloadBytes: number;
  range: number; ///< of the field: the value of a byte of 255; 0 without a field
}

export interface Frame {
  header: Header;
  buffer: ArrayBuffer;
}
/// A frame with the field that it has, and the colliders' places, which the server sends just before it.
export interface ShownFrame extends Frame {
  field: ShownField | null;
  moved: MovedCollider[];
}

export interface ClothRange {
  firstVertex: number;
  vertexCount: number;
  numbers?: FileNumbers; ///< of a mesh from a file, once they are known
}

export interface Topology {
  revision: number;
  vertexCount: number;
  cloths: ClothRange[];
  triangles: Uint32Array; ///< [triangle_count * 3]
  textureCoordinates: Float32Array; ///< [vertex_count * 2]
}

/// A message that violates the protocol; nothing of it may be used.
export class BadMessage extends Error {}

function demand(condition: boolean, what: string): asserts condition {
  if (!condition) throw new BadMessage(what);
}

/// Decodes a message but for c16 frames. Throws a BadMessage; reads nothing outside the buffer.
export function decode(buffer: ArrayBuffer): { topology: Topology } | { frame: Frame } {
  const header = decodeHeader(buffer, encodingQ16);
  if (header.kind === kindTopology) return { topology: decodeTopology(header, buffer) };
  demand(
    header.payloadBytes === (header.range > 0 ? q16Bytes + 1 : q16Bytes) * header.vertexCount,
    `a frame of ${header.vertexCount} vertices has ${header.payloadBytes} bytes`,
  );
  return { frame: { header, buffer } };
}

/// True if the message says that it is a c16 frame, which `unpack` (unpack.ts) decodes.
export function isPacked(buffer: ArrayBuffer): boolean {
  const [kind, encoding] = new Uint8Array(buffer, 0, Math.min(2, buffer.byteLength));
  return kind === kindFrame && encoding === encodingC16;
}

/// The header of a c16 frame and its deflated payload. Throws a BadMessage.
export function decodePacked(buffer: ArrayBuffer): { header: Header; deflated: Uint8Array } {
  return { header: decodeHeader(buffer, encodingC16), deflated: new Uint8Array(buffer, headerBytes) };
}

/// The q16 message with the header of a c16 one, `numbers` [vertex_count * 3], `normals` [vertex_count] and the field's
/// bytes.
export function q16Frame(
  packed: ArrayBuffer,
  numbers: Uint16Array,
  normals: Uint16Array,
  field: Uint8Array,
): ArrayBuffer {
  const vertices = normals.length;
  const buffer = new ArrayBuffer(headerBytes + q16Bytes * vertices + field.length);
  new Uint8Array(buffer).set(new Uint8Array(packed, 0, headerBytes));
  const view = new DataView(buffer);
  view.setUint8(1, encodingQ16);
  view.setUint32(56, buffer.byteLength - headerBytes, true);
  const words = new Uint16Array(buffer, headerBytes, 4 * vertices);
  for (let i = 0; i < vertices; ++i) {
    words[4 * i] = numbers[3 * i] as number;
    words[4 * i + 1] = numbers[3 * i + 1] as number;
    words[4 * i + 2] = numbers[3 * i + 2] as number;
    words[4 * i + 3] = normals[i] as number;
  }
  new Uint8Array(buffer, headerBytes + q16Bytes * vertices).set(field);
  return buffer;
}

function decodeHeader(buffer: ArrayBuffer, frameEncoding: number): Header {
  demand(buffer.byteLength >= headerBytes, `a binary message of ${buffer.byteLength} bytes has no room for a header`);
  const view = new DataView(buffer);
  const kind = view.getUint8(0),
    encoding = view.getUint8(1),
    flags = view.getUint16(2, true);
  const triple = (at: number): [number, number, number] => [
    view.getFloat32(at, true),
    view.getFloat32(at + 4, true),
    view.getFloat32(at + 8, true),
  ];
  const header: Header = {
    kind,
    encoding,
    asleep: (flags & flagAsleep) !== 0,
    diverged: (flags & flagDiverged) !== 0,
    topologyRevision: view.getUint32(4, true),
    sequence: view.getUint32(8, true),
    vertexCount: view.getUint32(12, true),
    time: view.getFloat64(16, true),
    step: Number(view.getBigUint64(24, true)),
    boxMinimum: triple(32),
    boxExtent: triple(44),
    payloadBytes: view.getUint32(56, true),
    range: view.getFloat32(60, true),
  };
  const isFrame = kind === kindFrame;
  demand(isFrame || kind === kindTopology, `a binary message is of the unknown kind ${kind}`);
  demand(
    encoding === (isFrame ? frameEncoding : encodingF32),
    `a binary message of kind ${kind} has the encoding ${encoding}`,
  );
  demand(
    (flags & ~(isFrame ? flagAsleep | flagDiverged : 0)) === 0,
    `a binary message of kind ${kind} has the flags ${flags}`,
  );
  demand(header.time >= 0 && header.time < Infinity, `the time of a frame is ${header.time}`);
  demand(
    header.boxMinimum.every(Number.isFinite) && header.boxExtent.every((extent) => extent >= 0 && extent < Infinity),
    `the box of a frame is ${header.boxMinimum} + ${header.boxExtent}`,
  );
  demand(
    Object.is(header.range, 0) || (isFrame && header.range > 0 && header.range < Infinity),
    `the range of a binary message of kind ${kind} is ${header.range}`,
  );
  demand(
    headerBytes + header.payloadBytes === buffer.byteLength,
    `the header announces ${header.payloadBytes} bytes, ${buffer.byteLength - headerBytes} came`,
  );
  return header;
}

function decodeTopology(header: Header, buffer: ArrayBuffer): Topology {
  const { vertexCount, payloadBytes } = header;
  demand(payloadBytes >= 8, "a topology has no counts");
  const [triangleCount = 0, clothCount = 0] = new Uint32Array(buffer, headerBytes, 2);
  const trianglesAt = headerBytes + 8 + 8 * clothCount;
  const textureAt = trianglesAt + 12 * triangleCount;
  demand(
    textureAt + 8 * vertexCount === buffer.byteLength,
    `a topology of ${clothCount} cloths, ${triangleCount} triangles and ${vertexCount} vertices has ${payloadBytes} bytes`,
  );
  const ranges = new Uint32Array(buffer, headerBytes + 8, 2 * clothCount);
  const cloths: ClothRange[] = [];
  let next = 0;
  for (let i = 0; i < ranges.length; i += 2) {
    const range = { firstVertex: ranges[i] ?? 0, vertexCount: ranges[i + 1] ?? 0 };
    demand(
      range.firstVertex === next,
      `cloth ${cloths.length} begins at vertex ${range.firstVertex} instead of ${next}`,
    );
    next += range.vertexCount;
    cloths.push(range);
  }
  demand(next === vertexCount, `the cloths have ${next} vertices, the topology ${vertexCount}`);
  const triangles = new Uint32Array(buffer, trianglesAt, 3 * triangleCount);
  const stray = triangles.find((corner) => corner >= vertexCount);
  demand(stray === undefined, `a triangle has vertex ${stray} of ${vertexCount}`);
  return {
    revision: header.topologyRevision,
    vertexCount,
    cloths,
    triangles,
    textureCoordinates: new Float32Array(buffer, textureAt, 2 * vertexCount),
  };
}

/// The field's bytes, one for each vertex, without a copy; null without a field.
export function fieldBytes({ header, buffer }: Frame): Uint8Array | null {
  return header.range > 0 ? new Uint8Array(buffer, headerBytes + q16Bytes * header.vertexCount) : null;
}

/// The payload of a q16 frame as four 16-bit words per vertex (x, y, z, both bytes of the normal), without a copy.
export function q16Words(frame: Frame): Uint16Array {
  return new Uint16Array(frame.buffer, headerBytes, frame.header.vertexCount * 4);
}
