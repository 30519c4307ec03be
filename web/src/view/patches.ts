// Places the vertices of a finer mesh on a curved patch over each triangle: Vlachos, Peters, Boyd and Mitchell 2001,
// Curved PN triangles. A patch meets the triangle's corners, so the simulated vertices stay where they are, and an edge
// depends on its two ends alone, so that neighbours meet. The outline is a spline through its vertices.
import { insideOf, onEdge, type Refinement } from "./refinement";

/// Unit normals at vertices [vertex_count * 3], the sums of their triangles' areas, into `normals`.
export function smoothNormals(
  places: Float32Array,
  triangles: Uint32Array,
  normals: Float32Array,
  count: number,
): void {
  normals.fill(0, 0, 3 * count);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * (triangles[t] as number),
      b = 3 * (triangles[t + 1] as number),
      c = 3 * (triangles[t + 2] as number);
    const ax = places[a] as number,
      ay = places[a + 1] as number,
      az = places[a + 2] as number;
    const ux = (places[b] as number) - ax,
      uy = (places[b + 1] as number) - ay,
      uz = (places[b + 2] as number) - az;
    const vx = (places[c] as number) - ax,
      vy = (places[c + 1] as number) - ay,
      vz = (places[c + 2] as number) - az;
    const x = uy * vz - uz * vy,
      y = uz * vx - ux * vz,
      z = ux * vy - uy * vx;
    for (const at of [a, b, c]) {
      normals[at] = (normals[at] as number) + x;
      normals[at + 1] = (normals[at + 1] as number) + y;
      normals[at + 2] = (normals[at + 2] as number) + z;
    }
  }
  for (let i = 0; i < 3 * count; i += 3) normalise(normals, i);
}

function normalise(array: Float32Array, at: number): void {
  const x = array[at] as number,
    y = array[at + 1] as number,
    z = array[at + 2] as number;
  const length = Math.sqrt(x * x + y * y + z * z);
  if (length > 0) {
    array[at] = x / length;
    array[at + 1] = y / length;
    array[at + 2] = z / length;
  } else array[at + 1] = 1;
}

export class Patches {
  private readonly controls: Float32Array; ///< [edge_count * 6] the two inner control points of each edge
  private readonly middles: Float32Array; ///< [edge_count * 3] normals in the middle of edges
  private readonly inner: { i: number; j: number; places: number[]; normals: number[] }[] = [];

  constructor(private readonly of: Refinement) {
    this.controls = new Float32Array(3 * of.edges.length);
    this.middles = new Float32Array((3 * of.edges.length) / 2);
    const { steps } = of;
    for (let j = 1; j < steps - 1; ++j)
      for (let i = 1; i + j < steps; ++i) {
        const u = i / steps,
          v = j / steps,
          w = 1 - u - v;
        // corners; two on each side, from its first corner; the middle
        const places = [w ** 3, u ** 3, v ** 3, 3 * w * w * u, 3 * w * u * u, 3 * u * u * v, 3 * u * v * v];
        places.push(3 * v * v * w, 3 * v * w * w, 6 * u * v * w);
        this.inner.push({ i, j, places, normals: [w * w, u * u, v * v, w * u, u * v, v * w] });
      }
  }

  /// Fills in places [m] and unit normals [vertex_count * 3] of the finer mesh; the first ones are the topology's.
  place(places: Float32Array, normals: Float32Array): void {
    smoothNormals(places, this.of.triangles, normals, this.of.coarse);
    for (let edge = 0; edge < this.of.edges.length / 2; ++edge) this.bend(edge, places, normals);
    if (this.inner.length > 0) for (let t = 0; t < this.of.triangles.length / 3; ++t) this.fill(t, places, normals);
  }

  // The control points of an edge, and its vertices.
  private bend(edge: number, places: Float32Array, normals: Float32Array): void {
    const { of, controls, middles } = this;
    const { steps, edges, beyond } = of;
    const a = 3 * (edges[2 * edge] as number),
      b = 3 * (edges[2 * edge + 1] as number),
      c = 6 * edge;
    let along = 0,
      leanA = 0,
      leanB = 0,
      lean = 0;
    for (let k = 0; k < 3; ++k) {
      const way = (places[b + k] as number) - (places[a + k] as number);
      along += way * way;
      leanA += way * (normals[a + k] as number);
      leanB += way * (normals[b + k] as number);
    }
    lean = along > 0 ? (2 * (leanA + leanB)) / along : 0;
    // Where the normals of a crumpled mesh are far from its edges, an edge must not leave its neighbourhood.
    const most = 0.6 * Math.sqrt(along);
    leanA = Math.max(-most, Math.min(most, leanA));
    leanB = Math.max(-most, Math.min(most, leanB));
    for (let k = 0; k < 3; ++k) {
      const from = places[a + k] as number,
        to = places[b + k] as number;
      const na = normals[a + k] as number,
        nb = normals[b + k] as number;
      controls[c + k] = (2 * from + to - leanA * na) / 3;
      controls[c + 3 + k] = (2 * to + from + leanB * nb) / 3;
      middles[3 * edge + k] = na + nb - lean * (to - from);
    }
    normalise(middles, 3 * edge);
    this.follow(c, beyond[2 * edge] as number, a, b, places);
    this.follow(c + 3, beyond[2 * edge + 1] as number, b, a, places);
    let at = 3 * onEdge(of, edge);
    for (let step = 1; step < steps; ++step, at += 3) {
      const t = step / steps,
        s = 1 - t;
      for (let k = 0; k < 3; ++k) {
        places[at + k] =
          s * s * s * (places[a + k] as number) +
          3 * s * s * t * (controls[c + k] as number) +
          3 * s * t * t * (controls[c + 3 + k] as number) +
          t * t * t * (places[b + k] as number);
        normals[at + k] =
          s * s * (normals[a + k] as number) +
          t * t * (normals[b + k] as number) +
          s * t * (middles[3 * edge + k] as number);
      }
      normalise(normals, at);
    }
  }

  // On the outline the tangent at an end is that of the spline through its neighbours.
  private follow(control: number, neighbour: number, end: number, other: number, places: Float32Array): void {
    if (neighbour < 0) return;
    let side = 0,
      span = 0;
    for (let k = 0; k < 3; ++k) {
      const at = places[other + k] as number;
      side += (at - (places[end + k] as number)) ** 2;
      span += (at - (places[3 * neighbour + k] as number)) ** 2;
    }
    if (span === 0) return;
    const reach = Math.sqrt(side / span) / 3;
    for (let k = 0; k < 3; ++k)
      this.controls[control + k] =
        (places[end + k] as number) + reach * ((places[other + k] as number) - (places[3 * neighbour + k] as number));
  }

  private fill(triangle: number, places: Float32Array, normals: Float32Array): void {
    const { of, controls, middles, inner } = this;
    const corners = [0, 1, 2].map((k) => 3 * (of.triangles[3 * triangle + k] as number)) as [number, number, number];
    const sides = [0, 1, 2].map((k) => of.sides[3 * triangle + k] as number) as [number, number, number];
    const net = new Float64Array(10);
    const lean = new Float64Array(6);
    const at = 3 * insideOf(of, triangle);
    for (let k = 0; k < 3; ++k) {
      let middle = 0;
      for (let s = 0; s < 3; ++s) {
        const edge = sides[s] as number;
        const forth = 3 * (of.edges[2 * edge] as number) === corners[s];
        net[s] = places[(corners[s] as number) + k] as number;
        net[3 + 2 * s] = controls[6 * edge + (forth ? 0 : 3) + k] as number;
        net[4 + 2 * s] = controls[6 * edge + (forth ? 3 : 0) + k] as number;
        middle += ((net[3 + 2 * s] as number) + (net[4 + 2 * s] as number)) / 4 - (net[s] as number) / 6;
        lean[s] = normals[(corners[s] as number) + k] as number;
        lean[3 + s] = middles[3 * edge + k] as number;
      }
      net[9] = middle;
      for (let n = 0; n < inner.length; ++n) {
        const weights = inner[n] as { places: number[]; normals: number[] };
        let place = 0,
          normal = 0;
        for (let p = 0; p < 10; ++p) place += (weights.places[p] as number) * (net[p] as number);
        for (let p = 0; p < 6; ++p) normal += (weights.normals[p] as number) * (lean[p] as number);
        places[at + 3 * n + k] = place;
        normals[at + 3 * n + k] = normal;
      }
    }
    for (let n = 0; n < inner.length; ++n) normalise(normals, at + 3 * n);
  }
}
