// The rounded hem: a thin tube along the outline of a finer mesh. Seen from the side it is the thickness of the cloth.
import type { Refinement } from "./refinement";

export const around = 5; // vertices of the tube at each vertex of the outline

export class Hem {
  readonly vertices: Uint32Array; ///< [ring_count] of the finer mesh, at the middle of each ring
  readonly triangles: Uint32Array; ///< those of the tube; its vertices come after the finer mesh's
  private readonly neighbours: Uint32Array; ///< [ring_count * 2] of the finer mesh, before and after

  constructor({ rim, vertexCount }: Refinement) {
    const rings = new Map<number, number>();
    for (const [a, b] of rim) for (const vertex of [a, b]) if (!rings.has(vertex)) rings.set(vertex, rings.size);
    this.vertices = Uint32Array.from(rings.keys());
    this.neighbours = Uint32Array.from({ length: 2 * rings.size }, (_, i) => this.vertices[i >> 1] as number);
    const triangles: number[] = [];
    for (const [a, b] of rim) {
      const from = rings.get(a) as number,
        to = rings.get(b) as number;
      this.neighbours[2 * from + 1] = b;
      this.neighbours[2 * to] = a;
      for (let k = 0; k < around; ++k) {
        const [p, q] = [from, to].map((ring) => vertexCount + around * ring) as [number, number];
        const l = (k + 1) % around;
        triangles.push(p + k, p + l, q + k, q + k, p + l, q + l);
      }
    }
    this.triangles = Uint32Array.from(triangles);
  }

  /// Places the tube's vertices behind those of the finer mesh, `radius(vertex)` [m] from the outline.
  place(places: Float32Array, normals: Float32Array, first: number, radius: (vertex: number) => number): void {
    let to = 3 * first;
    for (let ring = 0; ring < this.vertices.length; ++ring) {
      const vertex = this.vertices[ring] as number;
      const middle = 3 * vertex,
        before = 3 * (this.neighbours[2 * ring] as number),
        after = 3 * (this.neighbours[2 * ring + 1] as number);
      const nx = normals[middle] as number,
        ny = normals[middle + 1] as number,
        nz = normals[middle + 2] as number;
      const tx = (places[after] as number) - (places[before] as number),
        ty = (places[after + 1] as number) - (places[before + 1] as number),
        tz = (places[after + 2] as number) - (places[before + 2] as number);
      let ox = ty * nz - tz * ny,
        oy = tz * nx - tx * nz,
        oz = tx * ny - ty * nx;
      const length = Math.hypot(ox, oy, oz) || 1;
      [ox, oy, oz] = [ox / length, oy / length, oz / length];
      const wide = radius(vertex);
      for (let k = 0; k < around; ++k, to += 3) {
        const up = Math.cos((2 * Math.PI * k) / around),
          out = Math.sin((2 * Math.PI * k) / around);
        normals[to] = up * nx + out * ox;
        normals[to + 1] = up * ny + out * oy;
        normals[to + 2] = up * nz + out * oz;
        for (let axis = 0; axis < 3; ++axis)
          places[to + axis] = (places[middle + axis] as number) + wide * (normals[to + axis] as number);
      }
    }
  }
}
