// Normals of vertices from their places, as q16 frames have them.

/// A number as the octahedral normal has it: of 127, in a byte.
const signed = (share: number): number => Math.round(share * 127) & 255;

/// The normals of vertices at `places` [vertex_count * 3] times `scale` for each axis: sums of the cross products of
/// their triangles' sides, in two bytes, the lower half of the octahedron folded out.
export function packedNormals(
  places: Uint16Array | Float32Array,
  triangles: Uint32Array,
  [sx, sy, sz]: [number, number, number],
): Uint16Array {
  const sums = new Float32Array(places.length);
  const at = (vertex: number, axis: number): number => places[3 * vertex + axis] as number;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [triangles[t], triangles[t + 1], triangles[t + 2]] as [number, number, number];
    const ux = sx * (at(b, 0) - at(a, 0)),
      uy = sy * (at(b, 1) - at(a, 1)),
      uz = sz * (at(b, 2) - at(a, 2));
    const vx = sx * (at(c, 0) - at(a, 0)),
      vy = sy * (at(c, 1) - at(a, 1)),
      vz = sz * (at(c, 2) - at(a, 2));
    const x = uy * vz - uz * vy,
      y = uz * vx - ux * vz,
      z = ux * vy - uy * vx;
    for (const corner of [a, b, c]) {
      sums[3 * corner] = (sums[3 * corner] as number) + x;
      sums[3 * corner + 1] = (sums[3 * corner + 1] as number) + y;
      sums[3 * corner + 2] = (sums[3 * corner + 2] as number) + z;
    }
  }
  const packed = new Uint16Array(places.length / 3);
  for (let i = 0; i < packed.length; ++i) {
    const [x, y, z] = [sums[3 * i], sums[3 * i + 1], sums[3 * i + 2]] as [number, number, number];
    const size = Math.abs(x) + Math.abs(y) + Math.abs(z);
    const [p, q] = !(size > 0) ? [0, 1] : [x / size, y / size]; // none: up
    packed[i] =
      z >= 0
        ? signed(p) | (signed(q) << 8)
        : signed((1 - Math.abs(q)) * (p < 0 ? -1 : 1)) | (signed((1 - Math.abs(p)) * (q < 0 ? -1 : 1)) << 8);
  }
  return packed;
}
