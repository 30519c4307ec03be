// How much of the room's light the cloth itself keeps from its vertices, on either side: the darkness in folds and
// between layers. Each vertex stands for a disc of cloth (Bunnell 2005, Dynamic ambient occlusion and indirect
// lighting).
import type { Topology } from "../link/protocol";

const reach = 3; // mean edges: discs that are farther away keep off little
export const rounds = 4; // of frames that follow each other, for the shade of all vertices
const flat = 0.08; // sine of the angle above a surface from which a disc counts: less is the mesh's own roughness

export class FoldShade {
  private readonly areas: Float32Array; ///< of the discs, at each frame [m^2]
  private cells = new Int32Array(0);
  private readonly order: Uint32Array;
  private readonly key: Uint32Array;

  constructor(private readonly mesh: Pick<Topology, "vertexCount" | "triangles">) {
    this.areas = new Float32Array(mesh.vertexCount);
    this.order = new Uint32Array(mesh.vertexCount);
    this.key = new Uint32Array(mesh.vertexCount);
  }

  /// The share of light that is kept from the front and the back of each vertex, of 255, into `shade` at every
  /// `stride`-th byte; of every so many vertices one, from the `first`.
  measure(
    places: Float32Array,
    normals: Float32Array,
    shade: Uint8Array,
    stride: number,
    [first, every]: [number, number] = [0, 1],
  ): void {
    const { vertexCount: count } = this.mesh;
    const radius = reach * this.measureAreas(places);
    if (!(radius > 0)) return;
    const low = [0, 1, 2].map((axis) => extreme(places, count, axis, -1)) as [number, number, number];
    const high = [0, 1, 2].map((axis) => extreme(places, count, axis, 1)) as [number, number, number];
    const side = low.map((from, axis) => Math.min(64, Math.floor(((high[axis] as number) - from) / radius) + 1));
    const [nx, ny, nz] = side as [number, number, number];
    const cellOf = (v: number, axis: number): number =>
      Math.min(
        (side[axis] as number) - 1,
        Math.floor(((places[3 * v + axis] as number) - (low[axis] as number)) / radius),
      );
    if (this.cells.length < nx * ny * nz + 1) this.cells = new Int32Array(nx * ny * nz + 1);
    const { cells, order, key, areas } = this;
    cells.fill(0);
    for (let v = 0; v < count; ++v) {
      key[v] = cellOf(v, 0) + nx * (cellOf(v, 1) + ny * cellOf(v, 2));
      cells[(key[v] as number) + 1] = (cells[(key[v] as number) + 1] as number) + 1;
    }
    for (let c = 0; c < nx * ny * nz; ++c) cells[c + 1] = (cells[c + 1] as number) + (cells[c] as number);
    for (let v = count - 1; v >= 0; --v) {
      const at = (cells[(key[v] as number) + 1] as number) - 1;
      order[at] = v;
      cells[(key[v] as number) + 1] = at;
    }
    // cells[c + 1] is now where cell c begins
    const begin = (c: number): number => cells[c + 1] as number;
    const end = (c: number): number => (c + 2 <= nx * ny * nz ? (cells[c + 2] as number) : count);
    const square = radius * radius;
    for (let v = first; v < count; v += every) {
      const px = places[3 * v] as number,
        py = places[3 * v + 1] as number,
        pz = places[3 * v + 2] as number;
      const mx = normals[3 * v] as number,
        my = normals[3 * v + 1] as number,
        mz = normals[3 * v + 2] as number;
      const [cx, cy, cz] = [cellOf(v, 0), cellOf(v, 1), cellOf(v, 2)];
      let front = 0,
        back = 0;
      for (let z = Math.max(0, cz - 1); z <= Math.min(nz - 1, cz + 1); ++z)
        for (let y = Math.max(0, cy - 1); y <= Math.min(ny - 1, cy + 1); ++y) {
          const row = nx * (y + ny * z);
          const last = end(row + Math.min(nx - 1, cx + 1));
          for (let i = begin(row + Math.max(0, cx - 1)); i < last; ++i) {
            const w = order[i] as number;
            const dx = (places[3 * w] as number) - px,
              dy = (places[3 * w + 1] as number) - py,
              dz = (places[3 * w + 2] as number) - pz;
            const far = dx * dx + dy * dy + dz * dz;
            if (far >= square || far === 0) continue;
            const rise = dx * mx + dy * my + dz * mz;
            if (rise * rise < flat * flat * far) continue;
            const over = 1 / Math.sqrt(far);
            const height = rise * over;
            const above = Math.abs(height) - flat;
            const facing = Math.abs(
              dx * (normals[3 * w] as number) +
                dy * (normals[3 * w + 1] as number) +
                dz * (normals[3 * w + 2] as number),
            );
            const area = areas[w] as number;
            const kept = (above * Math.max(0.3, facing * over) * area * (1 - far / square)) / (Math.PI * far + area);
            if (height > 0) front += kept;
            else back += kept;
          }
        }
      shade[stride * v] = 255 * (1 - Math.exp(-1.9 * front));
      shade[stride * v + 1] = 255 * (1 - Math.exp(-1.9 * back));
    }
  }

  // Returns the mean length of an edge [m].
  private measureAreas(places: Float32Array): number {
    const { areas } = this;
    const { triangles } = this.mesh;
    areas.fill(0);
    let total = 0;
    for (let t = 0; t < triangles.length; t += 3) {
      const a = triangles[t] as number,
        b = triangles[t + 1] as number,
        c = triangles[t + 2] as number;
      const side = (v: number, axis: number): number =>
        (places[3 * v + axis] as number) - (places[3 * a + axis] as number);
      const ux = side(b, 0),
        uy = side(b, 1),
        uz = side(b, 2);
      const vx = side(c, 0),
        vy = side(c, 1),
        vz = side(c, 2);
      const third = Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 6;
      total += 3 * third;
      for (const v of [a, b, c]) areas[v] = (areas[v] as number) + third;
    }
    return Math.sqrt((2 * total) / Math.max(1, triangles.length / 3)); // of right triangles, as a grid has them
  }
}

function extreme(places: Float32Array, count: number, axis: number, sign: 1 | -1): number {
  let found = -Infinity;
  for (let v = 0; v < count; ++v) found = Math.max(found, sign * (places[3 * v + axis] as number));
  return sign * found;
}
