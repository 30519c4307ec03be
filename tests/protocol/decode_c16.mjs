// The payload of a c16 frame, read by the rules of server/net/README.md.
import { inflateRawSync } from "node:zlib";

/// The bytes that `payload` holds, if it is one deflate stream of `most` bytes at most and nothing else; else null.
function inflate(payload, most) {
  try {
    const { buffer, engine } = inflateRawSync(payload, { maxOutputLength: Math.max(most, 1), info: true });
    return engine.bytesWritten === payload.length ? buffer : null;
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
  for (const [key, thirds] of [...opposite].sort(([one], [other]) => one - other)) {
    const high = key % vertexCount,
      low = (key - high) / vertexCount;
    const [near, far] = thirds.sort((a, b) => a - b);
    if (thirds.length === 2 && far < high) rules[high][0].push([near, far, low]);
    if (thirds.length === 2 && far > high && near < far) rules[far][1].push([low, high, near]);
    rules[high][2].push([low, low, low]);
  }
  return rules.map((lists, i) => lists.find((list) => list.length > 0) ?? (i > 0 ? [[i - 1, i - 1, i - 1]] : []));
}

/// The numbers in a stream of bits, from the highest one of a byte down. A RangeError: there are none, or no such one.
class Numbers {
  constructor(bytes) {
    this.bits = Array.from(bytes, (byte) => byte.toString(2).padStart(8, "0")).join("");
    this.at = 0;
  }

  take(count) {
    if (this.at + count > this.bits.length) throw new RangeError("too few bits");
    this.at += count;
    return parseInt(`0${this.bits.slice(this.at - count, this.at)}`, 2);
  }

  /// `near` is the sum of the three numbers that foretell this one's size.
  next(near) {
    const low = near < 4 ? 0 : Math.floor(near / 4).toString(2).length;
    let ones = 0;
    while (ones < 12 && this.take(1) === 1) ++ones;
    const number = ones < 12 ? ones * 2 ** low + this.take(low) : this.take(16);
    if (number > 65535) throw new RangeError("more than 16 bits");
    return number;
  }

  get ended() {
    return this.bits.length - this.at < 8 && !this.bits.includes("1", this.at);
  }
}

const axes = [0, 1, 2];
const dot = (v, w) => v[0] * w[0] + v[1] * w[1] + v[2] * w[2];
const cross = (v, w) => [v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]];

/// Reads vertex after vertex; `vertices` are those before, each { place, numbers, stretch }.
function readVertex(vertices, triples, numbers, extent) {
  const none = { place: [0, 0, 0], numbers: [0, 0, 0], stretch: [0, 0] };
  const [a, b, c] = (triples[0] ?? []).map((vertex) => vertices[vertex]);
  const p = axes.map((axis) => {
    const [u, v, w] = [0, 1, 2].map((k) => triples.reduce((sum, triple) => sum + vertices[triple[k]].place[axis], 0));
    return Math.floor((u + v - w) / (triples.length || 1));
  });
  const read = { place: [], numbers: [], stretch: [0, 0] };
  const take = (axis, prediction) => {
    const turn = read.numbers.length;
    const number = numbers.next([a, b, c].reduce((sum, each) => sum + (each ?? none).numbers[turn], 0));
    const d = number % 2 === 0 ? number / 2 : -(number + 1) / 2;
    read.numbers.push(number);
    read.place[axis] = (prediction + d) & 0xffff;
    return d;
  };
  if (a === c) {
    for (const axis of axes) take(axis, p[axis]);
    return read;
  }
  const vector = (from, to) => axes.map((axis) => (to[axis] - from.place[axis]) * extent[axis]);
  const P = vector(a, p),
    Q = vector(b, p);
  const N = cross(P, Q);
  const k = N.map(Math.abs).reduce((best, size, axis, sizes) => (size > sizes[best] ? axis : best), 0);
  const s = (take(k, p[k]) * extent[k]) / N[k];
  const off = s * s * dot(N, N);
  const g = (0.75 * a.stretch[0] - off) / 2,
    h = (0.75 * b.stretch[1] - off) / 2;
  const alpha = (g * dot(Q, Q) - h * dot(P, Q)) / dot(N, N),
    beta = (h * dot(P, P) - g * dot(P, Q)) / dot(N, N);
  const T = axes.map((axis) => alpha * P[axis] + beta * Q[axis]);
  const t = s - T[k] / N[k];
  for (const axis of [(k + 1) % 3, (k + 2) % 3]) {
    const more = (t * N[axis] + T[axis]) / extent[axis];
    take(axis, p[axis] + (Math.abs(more) < 32768 ? Math.floor(more + 0.5) : 0));
  }
  const [fromA, fromB] = [a, b].map((from) => vector(from, read.place));
  read.stretch = [dot(fromA, fromA) - dot(P, P), dot(fromB, fromB) - dot(Q, Q)];
  return read;
}

const known = new WeakMap(); // of the triangles of a topology

/// { quantised, numbers, fieldBytes }, or null if the payload is none. `quantised` and `numbers`, which were sent, have
/// three for each vertex; `extent` is the box's.
export function readCompressed(payload, vertexCount, extent, triangles, withField) {
  const fieldLength = withField ? vertexCount : 0;
  const content = inflate(payload, fieldLength + Math.ceil((vertexCount * 3 * 28) / 8));
  if (!content || content.length < fieldLength) return null;
  if (!known.has(triangles)) known.set(triangles, candidates(vertexCount, triangles));
  const numbers = new Numbers(content.subarray(fieldLength));
  const vertices = [];
  try {
    for (const triples of known.get(triangles)) vertices.push(readVertex(vertices, triples, numbers, extent));
  } catch (error) {
    if (error instanceof RangeError) return null;
    throw error;
  }
  if (!numbers.ended) return null;
  return {
    quantised: vertices.map(({ place }) => place),
    numbers: vertices.map((vertex) => vertex.numbers),
    fieldBytes: content.subarray(0, fieldLength),
  };
}
