// The edges of a mesh, each once.

/// [edge_count * 2] vertices, the lower one first, in rising order. `triangles`: [triangle_count * 3].
export function meshEdges(triangles: Uint32Array, vertexCount: number): Uint32Array {
  const keys = new Float64Array(triangles.length); // exact: fewer than 2^26 vertices
  for (let i = 0; i < triangles.length; ++i) {
    const a = triangles[i] as number,
      b = triangles[i % 3 === 2 ? i - 2 : i + 1] as number;
    keys[i] = Math.min(a, b) * vertexCount + Math.max(a, b);
  }
  keys.sort();
  const edges: number[] = [];
  keys.forEach((key, i) => {
    if (i > 0 && key === keys[i - 1]) return;
    edges.push(Math.floor(key / vertexCount), key % vertexCount);
  });
  return Uint32Array.from(edges);
}

/// The mean length of some of the edges [m]: enough of them for the length of a line.
export function meanLength(edges: Uint32Array, places: Float32Array): number {
  const count = edges.length / 2,
    stride = Math.max(1, Math.floor(count / 500));
  let sum = 0,
    taken = 0;
  for (let i = 0; i < count; i += stride, ++taken) {
    const a = 3 * (edges[2 * i] as number),
      b = 3 * (edges[2 * i + 1] as number);
    sum += Math.hypot(
      (places[b] as number) - (places[a] as number),
      (places[b + 1] as number) - (places[a + 1] as number),
      (places[b + 2] as number) - (places[a + 2] as number),
    );
  }
  return taken > 0 ? sum / taken : 0;
}
