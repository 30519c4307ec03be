// Reads the binary messages of the protocol, written from contract and not from the server's code.

const headerBytes = 64;

export function decode(buffer) {
  const view = new DataView(buffer.buffer, buffer.byteOffset, buffer.byteLength);
  const floats = (at, count) => Array.from({ length: count }, (_, i) => view.getFloat32(at + 4 * i, true));
  const header = {
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
    zero: view.getUint32(60, true),
  };
  if (header.payloadBytes !== view.byteLength - headerBytes)
    throw new Error(`the header says ${header.payloadBytes} payload bytes, ${view.byteLength - headerBytes} came`);
  if (header.kind === 1) return { ...header, ...topology(view, header) };
  if (header.encoding === 0) return { ...header, ...float32(view, header) };
  if (header.encoding === 1) return { ...header, ...quantised(view, header) };
  throw new Error(`unknown encoding ${header.encoding}`);
}

function topology(view, header) {
  let at = headerBytes;
  const u32 = () => view.getUint32((at += 4) - 4, true);
  const triangleCount = u32();
  const clothCount = u32();
  const cloths = Array.from({ length: clothCount }, () => ({ firstVertex: u32(), vertexCount: u32() }));
  const triangles = Array.from({ length: triangleCount }, () => [u32(), u32(), u32()]);
  const texture = Array.from({ length: header.vertexCount }, () =>
    [view.getFloat32((at += 4) - 4, true), view.getFloat32((at += 4) - 4, true)]);
  if (at !== view.byteLength) throw new Error(`the topology has ${view.byteLength - at} bytes too many`);
  return { cloths, triangles, texture };
}

function float32(view, header) {
  if (header.payloadBytes !== 24 * header.vertexCount) throw new Error("an f32 frame has 24 bytes a vertex");
  const triple = (at) => [0, 4, 8].map((offset) => view.getFloat32(at + offset, true));
  const positions = [], normals = [];
  for (let i = 0; i < header.vertexCount; ++i) {
    positions.push(triple(headerBytes + 24 * i));
    normals.push(triple(headerBytes + 24 * i + 12));
  }
  return { positions, normals };
}

function quantised(view, header) {
  if (header.payloadBytes !== 8 * header.vertexCount) throw new Error("a q16 frame has 8 bytes a vertex");
  const positions = [], normals = [];
  for (let i = 0; i < header.vertexCount; ++i) {
    const at = headerBytes + 8 * i;
    positions.push([0, 1, 2].map((axis) =>
      header.boxMinimum[axis] + (header.boxExtent[axis] * view.getUint16(at + 2 * axis, true)) / 65535));
    normals.push(octahedral(view.getInt8(at + 6), view.getInt8(at + 7)));
  }
  return { positions, normals };
}

// The octahedron |x| + |y| + |z| = 1 unfolded to the square, its lower half turned outwards.
function octahedral(a, b) {
  let x = Math.max(a / 127, -1), y = Math.max(b / 127, -1);
  const z = 1 - Math.abs(x) - Math.abs(y);
  if (z < 0) [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
  const length = Math.hypot(x, y, z) || 1;
  return [x / length, y / length, z / length];
}
