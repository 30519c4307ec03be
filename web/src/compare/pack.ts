// Places of vertices as a frame that the cloth's view draws: q16 (server/net/README.md), with normals made here.
import { packedNormals } from "../link/normals";
import type { ShownFrame, Topology } from "../link/protocol";
import type { MovedCollider } from "../link/scene_types";

const headerBytes = 64;
const most = 65535;

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
  const normals = packedNormals(places, triangles, [1, 1, 1]);
  for (let i = 0; i < vertexCount; i++) {
    for (let axis = 0; axis < 3; axis++) {
      const span = extent[axis] as number;
      const share = span > 0 ? ((places[3 * i + axis] as number) - (low[axis] as number)) / span : 0;
      words[4 * i + axis] = Math.round(share * most);
    }
    words[4 * i + 3] = normals[i] as number;
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
