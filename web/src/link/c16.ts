// Reads the positions of a c16 frame (server/net/README.md, "The bytes of a frame"): the same numbers, by the same
// operations on doubles, as the server's, so that nothing is lost.
import type { Candidates } from "./prediction";
import { BadMessage } from "./protocol";

const mostOnes = 12;
const wholeBits = 16;
const shareKept = 0.75;

/// The positions [vertex_count * 3] in a box of this extent [m]. Throws a BadMessage if there are more or fewer bits.
export function readPositions(
  content: Uint8Array,
  candidates: Candidates,
  extent: readonly [number, number, number],
): Uint16Array {
  return positionsOf(readNumbers(content, candidates), candidates, extent);
}

/// Three numbers for each vertex, in the order in which they are sent.
function readNumbers(content: Uint8Array, { first, triples }: Candidates): Int32Array {
  const vertices = first.length - 1;
  const numbers = new Int32Array(3 * vertices);
  const bytes = new Uint8Array(content.length + 16); // a vertex may begin at the end
  bytes.set(content);
  const end = 8 * content.length;
  let bit = 0;
  let valid = true;
  for (let i = 0; i < vertices && valid; ++i) {
    const from = 3 * (first[i] as number);
    const any = from < 3 * (first[i + 1] as number);
    const a = any ? 3 * (triples[from] as number) : 3 * i,
      b = any ? 3 * (triples[from + 1] as number) : 3 * i,
      c = any ? 3 * (triples[from + 2] as number) : 3 * i;
    for (let turn = 0; turn < 3; ++turn) {
      const near = (numbers[a + turn] as number) + (numbers[b + turn] as number) + (numbers[c + turn] as number);
      const low = 32 - Math.clz32(near >>> 2);
      const at = bit >>> 3,
        shift = bit & 7;
      const four =
        ((bytes[at] as number) << 24) |
        ((bytes[at + 1] as number) << 16) |
        ((bytes[at + 2] as number) << 8) |
        (bytes[at + 3] as number);
      const next = (four << shift) | ((bytes[at + 4] as number) >>> (8 - shift));
      const ones = Math.clz32(~next);
      let number = 0;
      if (ones >= mostOnes) {
        number = (next << mostOnes) >>> (32 - wholeBits);
        bit += mostOnes + wholeBits;
      } else {
        number = low > 0 ? (ones << low) | ((next << (ones + 1)) >>> (32 - low)) : ones;
        bit += ones + 1 + low;
        if (number > 0xffff) valid = false;
      }
      numbers[3 * i + turn] = number;
    }
    if (bit > end) valid = false;
  }
  if (!valid || end - bit > 7 || (((bytes[bit >>> 3] as number) << (bit & 7)) & 0xff) !== 0)
    throw new BadMessage(`a c16 frame's ${content.length} bytes are not the numbers of ${vertices} vertices`);
  return numbers;
}

function positionsOf(
  numbers: Int32Array,
  { first, triples }: Candidates,
  [ex, ey, ez]: readonly [number, number, number],
): Uint16Array {
  const vertices = first.length - 1;
  const positions = new Uint16Array(3 * vertices);
  // By how much the squares of a vertex's edges to a and b are more than predicted.
  const stretchA = new Float64Array(vertices);
  const stretchB = new Float64Array(vertices);
  for (let i = 0; i < vertices; ++i) {
    const from = 3 * (first[i] as number),
      to = 3 * (first[i + 1] as number),
      x = 3 * i,
      y = x + 1,
      z = x + 2;
    const d0 = unfolded(numbers[x] as number),
      d1 = unfolded(numbers[y] as number),
      d2 = unfolded(numbers[z] as number);
    if (from === to) {
      positions[x] = d0;
      positions[y] = d1;
      positions[z] = d2;
      continue;
    }
    const vertexA = triples[from] as number,
      vertexB = triples[from + 1] as number;
    const a = 3 * vertexA,
      b = 3 * vertexB,
      c = 3 * (triples[from + 2] as number);
    const ax = positions[a] as number,
      ay = positions[a + 1] as number,
      az = positions[a + 2] as number,
      bx = positions[b] as number,
      by = positions[b + 1] as number,
      bz = positions[b + 2] as number;
    let px = ax + bx - (positions[c] as number),
      py = ay + by - (positions[c + 1] as number),
      pz = az + bz - (positions[c + 2] as number);
    if (to > from + 3) {
      for (let k = from + 3; k < to; k += 3) {
        const one = 3 * (triples[k] as number),
          two = 3 * (triples[k + 1] as number),
          less = 3 * (triples[k + 2] as number);
        px += (positions[one] as number) + (positions[two] as number) - (positions[less] as number);
        py += (positions[one + 1] as number) + (positions[two + 1] as number) - (positions[less + 1] as number);
        pz += (positions[one + 2] as number) + (positions[two + 2] as number) - (positions[less + 2] as number);
      }
      const count = (to - from) / 3;
      px = Math.floor(px / count);
      py = Math.floor(py / count);
      pz = Math.floor(pz / count);
    }
    if (a === c) {
      positions[x] = px + d0;
      positions[y] = py + d1;
      positions[z] = pz + d2;
      continue;
    }

    // From a and from b to the prediction; their normal, which is longest along the axis k.
    const vax = (px - ax) * ex,
      vay = (py - ay) * ey,
      vaz = (pz - az) * ez,
      vbx = (px - bx) * ex,
      vby = (py - by) * ey,
      vbz = (pz - bz) * ez;
    const nx = vay * vbz - vaz * vby,
      ny = vaz * vbx - vax * vbz,
      nz = vax * vby - vay * vbx;
    const aa = vax * vax + vay * vay + vaz * vaz,
      bb = vbx * vbx + vby * vby + vbz * vbz,
      ab = vax * vbx + vay * vby + vaz * vbz,
      nn = nx * nx + ny * ny + nz * nz;
    const k = longest(Math.abs(nx), Math.abs(ny), Math.abs(nz));
    const nk = k === 0 ? nx : k === 1 ? ny : nz;
    // Off the plane by s normals, the vertex comes nearer, so that both edges keep their lengths.
    const s = (d0 * (k === 0 ? ex : k === 1 ? ey : ez)) / nk;
    const off = s * s * nn;
    const forA = (shareKept * (stretchA[vertexA] as number) - off) / 2,
      forB = (shareKept * (stretchB[vertexB] as number) - off) / 2;
    const alongA = (forA * bb - forB * ab) / nn,
      alongB = (forB * aa - forA * ab) / nn;
    const tx = alongA * vax + alongB * vbx,
      ty = alongA * vay + alongB * vby,
      tz = alongA * vaz + alongB * vbz;
    const normals = s - (k === 0 ? tx : k === 1 ? ty : tz) / nk;
    if (k === 0) {
      positions[x] = px + d0;
      positions[y] = py + whole((normals * ny + ty) / ey) + d1;
      positions[z] = pz + whole((normals * nz + tz) / ez) + d2;
    } else if (k === 1) {
      positions[y] = py + d0;
      positions[z] = pz + whole((normals * nz + tz) / ez) + d1;
      positions[x] = px + whole((normals * nx + tx) / ex) + d2;
    } else {
      positions[z] = pz + d0;
      positions[x] = px + whole((normals * nx + tx) / ex) + d1;
      positions[y] = py + whole((normals * ny + ty) / ey) + d2;
    }

    const ux = positions[x] as number,
      uy = positions[y] as number,
      uz = positions[z] as number; // modulo 65536
    const wax = (ux - ax) * ex,
      way = (uy - ay) * ey,
      waz = (uz - az) * ez,
      wbx = (ux - bx) * ex,
      wby = (uy - by) * ey,
      wbz = (uz - bz) * ez;
    stretchA[i] = wax * wax + way * way + waz * waz - aa;
    stretchB[i] = wbx * wbx + wby * wby + wbz * wbz - bb;
  }
  return positions;
}

const unfolded = (number: number): number => (number >>> 1) ^ -(number & 1);

const longest = (x: number, y: number, z: number): 0 | 1 | 2 => (y > x ? (z > y ? 2 : 1) : z > x ? 2 : 0);

/// Rounded; 0 where that is no difference of 16 bits.
const whole = (more: number): number => (Math.abs(more) < 32768 ? Math.floor(more + 0.5) : 0);
