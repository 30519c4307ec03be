// Places of vertices as a frame that the cloth's view draws: q16 (server/net/README.md), with normals made here.
import type { ShownFrame, Topology } from "../link/protocol";
import type { MovedCollider } from "../link/scene_types";

const headerBytes = 64;
const most = 65535;

/// The normal of each vertex, weighted by the area of its triangles; not of unit length.
function normalsOf(places: Float32Array, triangles: Uint32Array): Float32Array {
  const normals = new Float32Array(places.length);
  const at = (i: number): number => places[i] as number;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * (triangles[t] ?? 0), 3 * (triangles[t + 1] ?? 0), 3 * (triangles[t + 2] ?? 0)];
    const [ux, uy, uz] = [at(b) - at(a), at(b + 1) - at(a + 1), at(b + 2) - at(a + 2)];
    const [vx, vy, vz] = [at(c) - at(a), at(c + 1) - at(a + 1), at(c + 2) - at(a + 2)];
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const corner of [a, b, c]) {
      normals[corner] = (normals[corner] as number) + x;
      normals[corner + 1] = (normals[corner + 1] as number) + y;
      normals[corner + 2] = (normals[corner + 2] as number) + z;
    }
  }
  return normals;
}

/// A normal as two signed bytes on an octahedron, in one word.
function octahedral(x: number, y: number, z: number): number {
  const length = Math.abs(x) + Math.abs(y) + Math.abs(z);
  if (!(length > 0)) return 0;
  let [u, v] = [x / length, y / length];
  if (z < 0) [u, v] = [(1 - Math.abs(v)) * (u < 0 ? -1 : 1), (1 - Math.abs(u)) * (v < 0 ? -1 : 1)];
  return (Math.round(127 * u) & 255) | ((Math.round(127 * v) & 255) << 8);
}

/// The lowest and the highest coordinates [m].
function boxOf(places: Float32Array): { low: [number, number, number]; high: [number, number, number] } {
  const low: [number, number, number] = [Infinity, Infinity, Infinity];
  const high: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < places.length; i++) {
    const x = places[i] as number;
    const axis = i % 3;
    if (x < (low[axis] as number)) low[axis] = x;
    if (x > (high[axis] as number)) high[axis] = x;
  }
  return { low, high };
}

export function frameOf(places: Float32Array, topology: Topology, time: number, moved: MovedCollider[]): ShownFrame {
  const { vertexCount, triangles, revision } = topology;
  const { low, high } = boxOf(places);
  const extent = high.map((top, axis) => top - (low[axis] as number)) as [number, number, number];
  const buffer = new ArrayBuffer(headerBytes + 8 * vertexCount);
  const words = new Uint16Array(buffer, headerBytes);
  const normals = normalsOf(places, triangles);
  for (let i = 0; i < vertexCount; i++) {
    for (let axis = 0; axis < 3; axis++) {
      const span = extent[axis] as number;
      const share = span > 0 ? ((places[3 * i + axis] as number) - (low[axis] as number)) / span : 0;
      words[4 * i + axis] = Math.round(share * most);
    }
    const [x, y, z] = normals.subarray(3 * i, 3 * i + 3) as unknown as [number, number, number];
    words[4 * i + 3] = octahedral(x, y, z);
  }
  const header = {
    kind: 2,
    encoding: 1,
    asleep: false,
    diverged: false,
    topologyRevision: revision,
    sequence: 0,
    vertexCount,
    time,
    step: 0,
    boxMinimum: low,
    boxExtent: extent,
    payloadBytes: 8 * vertexCount,
    range: 0,
  };
  return { header, buffer, field: null, moved };
}
