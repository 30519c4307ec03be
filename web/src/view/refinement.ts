// How a cloth's triangles are cut into smaller ones: which vertices the finer mesh has, and what each hangs on. It is
// made once for a topology; patches.ts places the vertices of each frame.
import type { Topology } from "../link/protocol";

const mostSteps = 4;
const cornerCosine = Math.cos((50 / 180) * Math.PI); // an outline that turns more, at rest, has a corner

/// Into how many parts each edge is cut so that there are at most so many triangles; 0: there are more already.
export function stepsFor(triangles: number, most: number): number {
  return Math.min(mostSteps, Math.floor(Math.sqrt(most / Math.max(1, triangles))));
}

export interface Refinement {
  steps: number;
  coarse: number; ///< vertices of the topology: the first ones of the finer mesh, in the same order
  vertexCount: number;
  triangles: Uint32Array; ///< [triangle_count * 3] of the topology
  edges: Uint32Array; ///< [edge_count * 2] ends
  beyond: Int32Array; ///< [edge_count * 2] on the outline: its vertex before the first end, after the second; -1: none
  sides: Uint32Array; ///< [triangle_count * 3] edges of a triangle: from its first corner to the second, and so on
  fine: Uint32Array; ///< [triangle_count * steps^2 * 3] triangles of the finer mesh, in the order of the coarse ones
  rim: [number, number][]; ///< pieces of the finer outline, with the cloth on the left of each
}

/// The vertices of the finer mesh on an edge begin here; its inner ones are in the order from its first end.
export const onEdge = ({ coarse, steps }: Refinement, edge: number): number => coarse + edge * (steps - 1);
/// Those inside a triangle, by rows from its first corner.
export const insideOf = ({ coarse, steps, edges }: Refinement, triangle: number): number =>
  coarse + (edges.length / 2) * (steps - 1) + (triangle * (steps - 1) * (steps - 2)) / 2;

/// True where the outline turns at a vertex, at rest, by more than a curve would.
function turns(texture: Float32Array, before: number, vertex: number, after: number): boolean {
  const at = (v: number, axis: number): number => texture[2 * v + axis] as number;
  const [ax, ay] = [at(vertex, 0) - at(before, 0), at(vertex, 1) - at(before, 1)];
  const [bx, by] = [at(after, 0) - at(vertex, 0), at(after, 1) - at(vertex, 1)];
  return ax * bx + ay * by < cornerCosine * Math.hypot(ax, ay) * Math.hypot(bx, by);
}

export function refine(
  { vertexCount: coarse, triangles, textureCoordinates }: Omit<Topology, "revision" | "cloths">,
  steps: number,
): Refinement {
  const numbers = new Map<number, number>();
  const ends: number[] = [];
  const uses: number[] = [];
  const sides = new Uint32Array(triangles.length);
  for (let t = 0; t < triangles.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const a = triangles[t + k] as number;
      const b = triangles[t + ((k + 1) % 3)] as number;
      const key = Math.min(a, b) * coarse + Math.max(a, b);
      let edge = numbers.get(key);
      if (edge === undefined) {
        edge = uses.length;
        numbers.set(key, edge);
        ends.push(a, b);
        uses.push(0);
      }
      uses[edge] = (uses[edge] as number) + 1;
      sides[t + k] = edge;
    }
  const edges = Uint32Array.from(ends);
  // The outline runs as the one triangle of each of its edges has it. Where pieces of it touch there is no one way on.
  const next = new Map<number, number>();
  const last = new Map<number, number>();
  const outline = uses.flatMap((count, edge) => (count === 1 ? [edge] : []));
  for (const edge of outline) {
    const [a, b] = [edges[2 * edge] as number, edges[2 * edge + 1] as number];
    next.set(a, next.has(a) ? -1 : b);
    last.set(b, last.has(b) ? -1 : a);
  }
  const beyond = new Int32Array(edges.length).fill(-1);
  for (const edge of outline) {
    const [a, b] = [edges[2 * edge] as number, edges[2 * edge + 1] as number];
    const [before, after] = [last.get(a) ?? -1, next.get(b) ?? -1];
    if (before >= 0 && !turns(textureCoordinates, before, a, b)) beyond[2 * edge] = before;
    if (after >= 0 && !turns(textureCoordinates, a, b, after)) beyond[2 * edge + 1] = after;
  }
  const made: Refinement = {
    steps,
    coarse,
    vertexCount: 0,
    triangles,
    edges,
    beyond,
    sides,
    fine: new Uint32Array(triangles.length * steps * steps),
    rim: [],
  };
  made.vertexCount = insideOf(made, triangles.length / 3);
  cut(made);
  for (const edge of outline) {
    const inner = Array.from({ length: steps - 1 }, (_, k) => onEdge(made, edge) + k);
    const chain = [edges[2 * edge] as number, ...inner, edges[2 * edge + 1] as number];
    for (let k = 0; k < steps; ++k) made.rim.push([chain[k] as number, chain[k + 1] as number]);
  }
  return made;
}

/// The vertex `i` steps towards a triangle's second corner and `j` towards its third.
function vertexAt(of: Refinement, triangle: number, i: number, j: number): number {
  const { steps, triangles, edges, sides } = of;
  const corner = (k: number): number => triangles[3 * triangle + k] as number;
  const along = (side: number, step: number): number => {
    const edge = sides[3 * triangle + side] as number;
    const forth = edges[2 * edge] === corner(side);
    return onEdge(of, edge) + (forth ? step : steps - step) - 1;
  };
  if (i === 0 && j === 0) return corner(0);
  if (i === steps) return corner(1);
  if (j === steps) return corner(2);
  if (j === 0) return along(0, i);
  if (i + j === steps) return along(1, j);
  if (i === 0) return along(2, steps - j);
  let row = insideOf(of, triangle);
  for (let k = 1; k < j; ++k) row += steps - 1 - k;
  return row + i - 1;
}

function cut(of: Refinement): void {
  const { steps, fine } = of;
  let to = 0;
  const add = (triangle: number, ...places: [number, number][]): void => {
    for (const [i, j] of places) fine[to++] = vertexAt(of, triangle, i, j);
  };
  for (let triangle = 0; triangle < of.triangles.length / 3; ++triangle)
    for (let j = 0; j < steps; ++j)
      for (let i = 0; i + j < steps; ++i) {
        add(triangle, [i, j], [i + 1, j], [i, j + 1]);
        if (i + j < steps - 1) add(triangle, [i + 1, j], [i + 1, j + 1], [i, j + 1]);
      }
}

/// Values of the topology's vertices, of `size` numbers each, in between along straight lines. Fills `values`, of which
/// the first ones are those of the topology.
export function interpolate(of: Refinement, values: Float32Array | Uint8Array, size: number): void {
  const { steps, triangles, edges } = of;
  const at = (v: number, axis: number): number => values[size * v + axis] as number;
  for (let edge = 0; edge < edges.length / 2; ++edge)
    for (let k = 1; k < steps; ++k)
      for (let axis = 0; axis < size; ++axis) {
        const [a, b] = [at(edges[2 * edge] as number, axis), at(edges[2 * edge + 1] as number, axis)];
        values[size * (onEdge(of, edge) + k - 1) + axis] = a + ((b - a) * k) / steps;
      }
  for (let triangle = 0; triangle < triangles.length / 3; ++triangle) {
    let to = insideOf(of, triangle);
    for (let j = 1; j < steps - 1; ++j)
      for (let i = 1; i + j < steps; ++i, ++to)
        for (let axis = 0; axis < size; ++axis) {
          const corner = (k: number): number => at(triangles[3 * triangle + k] as number, axis);
          values[size * to + axis] = ((steps - i - j) * corner(0) + i * corner(1) + j * corner(2)) / steps;
        }
  }
}
