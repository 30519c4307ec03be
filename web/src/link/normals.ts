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
  // Small arrays and a place read twice would take twice as long, as long as all the rest of unpacking a frame.
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * (triangles[t] as number),
      b = 3 * (triangles[t + 1] as number),
      c = 3 * (triangles[t + 2] as number);
    const ax = places[a] as number,
      ay = places[a + 1] as number,
      az = places[a + 2] as number;
    const ux = sx * ((places[b] as number) - ax),
      uy = sy * ((places[b + 1] as number) - ay),
      uz = sz * ((places[b + 2] as number) - az);
    const vx = sx * ((places[c] as number) - ax),
      vy = sy * ((places[c + 1] as number) - ay),
      vz = sz * ((places[c + 2] as number) - az);
    const x = uy * vz - uz * vy,
      y = uz * vx - ux * vz,
      z = ux * vy - uy * vx;
    sums[a] = (sums[a] as number) + x;
    sums[a + 1] = (sums[a + 1] as number) + y;
    sums[a + 2] = (sums[a + 2] as number) + z;
    sums[b] = (sums[b] as number) + x;
    sums[b + 1] = (sums[b + 1] as number) + y;
    sums[b + 2] = (sums[b + 2] as number) + z;
    sums[c] = (sums[c] as number) + x;
    sums[c + 1] = (sums[c + 1] as number) + y;
    sums[c + 2] = (sums[c + 2] as number) + z;
  }
  const packed = new Uint16Array(places.length / 3);
  for (let i = 0; i < packed.length; ++i) {
    const x = sums[3 * i] as number,
      y = sums[3 * i + 1] as number,
      z = sums[3 * i + 2] as number;
    const size = Math.abs(x) + Math.abs(y) + Math.abs(z);
    const p = size > 0 ? x / size : 0, // none: up
      q = size > 0 ? y / size : 1;
    packed[i] =
      z >= 0
        ? signed(p) | (signed(q) << 8)
        : signed((1 - Math.abs(q)) * (p < 0 ? -1 : 1)) | (signed((1 - Math.abs(p)) * (q < 0 ? -1 : 1)) << 8);
  }
  return packed;
}
