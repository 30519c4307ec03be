// The payload of a c16 frame, read by the rules of server/net/README.md.
import { inflateRawSync } from "node:zlib";

/// The bytes that `payload` holds, if it is one deflate stream of exactly `size` bytes and nothing else; else null.
function inflate(payload, size) {
  try {
    const { buffer, engine } = inflateRawSync(payload, { maxOutputLength: size + 1, info: true });
    return buffer.length === size && engine.bytesWritten === payload.length ? buffer : null;
  } catch {
    return null;
  }
}

/// For each vertex the triples [a, b, c] whose a + b - c are averaged.
function candidates(vertexCount, triangles) {
  const opposite = new Map(); // for each edge [low, high] the third corners of its triangles
  for (const corners of triangles)
    for (let k = 0; k < 3; ++k) {
      const [low, high] = [corners[k], corners[(k + 1) % 3]].sort((a, b) => a - b);
      const key = low * vertexCount + high;
      if (low !== high) opposite.set(key, [...(opposite.get(key) ?? []), corners[(k + 2) % 3]]);
    }
  const rules = Array.from({ length: vertexCount }, () => [[], [], []]);
  for (const [key, thirds] of opposite) {
    const high = key % vertexCount,
      low = (key - high) / vertexCount;
    const [near, far] = thirds.sort((a, b) => a - b);
    if (thirds.length === 2 && far < high) rules[high][0].push([near, far, low]);
    if (thirds.length === 2 && far > high && near < far) rules[far][1].push([low, high, near]);
    rules[high][2].push([low, low, low]);
  }
  return rules.map((lists, i) => lists.find((list) => list.length > 0) ?? (i > 0 ? [[i - 1, i - 1, i - 1]] : []));
}

const known = new WeakMap(); // of the triangles of a topology

/// { quantised, fieldBytes }, or null if the payload is none. `quantised` has three numbers for each vertex.
export function readCompressed(payload, vertexCount, triangles, withField) {
  const planes = inflate(payload, (withField ? 7 : 6) * vertexCount);
  if (!planes) return null;
  if (!known.has(triangles)) known.set(triangles, candidates(vertexCount, triangles));
  const quantised = [];
  known.get(triangles).forEach((list, i) => {
    quantised.push(
      [0, 1, 2].map((axis) => {
        const sum = list.reduce((s, [a, b, c]) => s + quantised[a][axis] + quantised[b][axis] - quantised[c][axis], 0);
        const fold = planes[axis * vertexCount + i] + 256 * planes[(3 + axis) * vertexCount + i];
        const difference = fold % 2 === 0 ? fold / 2 : -(fold + 1) / 2;
        return (Math.floor(sum / (list.length || 1)) + difference) & 0xffff;
      }),
    );
  });
  return { quantised, fieldBytes: planes.subarray(6 * vertexCount) };
}
