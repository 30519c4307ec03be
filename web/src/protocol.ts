// The binary messages of contract.md, section 4: 64-byte header, then the payload, little-endian.

export const headerBytes = 64;
export const kindTopology = 1;
export const kindFrame = 2;
export const encodingQ16 = 1;
const flagAsleep = 1;
const flagDiverged = 2;

export interface Header {
  kind: number;
  encoding: number;
  asleep: boolean;
  diverged: boolean;
  topologyRevision: number;
  sequence: number;
  vertexCount: number;
  time: number;        ///< simulated time [s]
  step: number;
  boxMinimum: [number, number, number];  ///< [m]
  boxExtent: [number, number, number];   ///< [m]
  payloadBytes: number;
}

export interface Frame { header: Header; buffer: ArrayBuffer }

export interface ClothRange { firstVertex: number; vertexCount: number }

export interface Topology {
  revision: number;
  vertexCount: number;
  cloths: ClothRange[];
  triangles: Uint32Array;           ///< [triangle_count * 3]
  textureCoordinates: Float32Array; ///< [vertex_count * 2]
}

export function decodeHeader(buffer: ArrayBuffer): Header {
  if (buffer.byteLength < headerBytes) throw new Error(`a binary message of ${buffer.byteLength} bytes has no room for a header`);
  const view = new DataView(buffer);
  const flags = view.getUint16(2, true);
  const triple = (at: number): [number, number, number] =>
    [view.getFloat32(at, true), view.getFloat32(at + 4, true), view.getFloat32(at + 8, true)];
  const header: Header = {
    kind: view.getUint8(0),
    encoding: view.getUint8(1),
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
  };
  if (headerBytes + header.payloadBytes > buffer.byteLength) {
    throw new Error(`the header announces ${header.payloadBytes} bytes, ${buffer.byteLength - headerBytes} came`);
  }
  return header;
}

export function decodeTopology(header: Header, buffer: ArrayBuffer): Topology {
  const counts = new Uint32Array(buffer, headerBytes, 2);
  const triangleCount = counts[0] ?? 0;
  const clothCount = counts[1] ?? 0;
  const ranges = new Uint32Array(buffer, headerBytes + 8, clothCount * 2);
  const trianglesAt = headerBytes + 8 + clothCount * 8;
  return {
    revision: header.topologyRevision,
    vertexCount: header.vertexCount,
    cloths: Array.from({ length: clothCount }, (_, i) => ({
      firstVertex: ranges[2 * i] ?? 0,
      vertexCount: ranges[2 * i + 1] ?? 0,
    })),
    triangles: new Uint32Array(buffer, trianglesAt, triangleCount * 3),
    textureCoordinates: new Float32Array(buffer, trianglesAt + triangleCount * 12, header.vertexCount * 2),
  };
}

/// The payload of a q16 frame as four 16-bit words a vertex (x, y, z, both normal bytes): no copy.
export function q16Words(frame: Frame): Uint16Array {
  return new Uint16Array(frame.buffer, headerBytes, frame.header.vertexCount * 4);
}
