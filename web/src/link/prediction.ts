// Predicts vertices from those before them, as c16 and recordings do (server/net/README.md, server/stream/README.md),
// and lists a mesh's edges.

/// For each vertex i the triples [first[i], first[i + 1]) of `triples`; the mean of their a + b - c predicts it.
export interface Candidates {
  first: Uint32Array;
  triples: Uint32Array;
}

/// Sorted: for each side of a triangle low vertex, high vertex, opposite corner.
function sidesOf(triangles: Uint32Array): { low: number; high: number; third: number }[] {
  const sides = [];
  for (let t = 0; t < triangles.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const [a, b, third] = [k, (k + 1) % 3, (k + 2) % 3].map((at) => triangles[t + at]) as [number, number, number];
      if (a !== b) sides.push({ low: Math.min(a, b), high: Math.max(a, b), third });
    }
  return sides.sort((a, b) => a.low - b.low || a.high - b.high || a.third - b.third);
}

type Triple = [number, number, number];

export function candidatesOf(vertexCount: number, triangles: Uint32Array): Candidates {
  const rules = Array.from({ length: vertexCount }, (): [Triple[], Triple[], Triple[]] => [[], [], []]);
  const add = (vertex: number, rule: 0 | 1 | 2, triple: Triple): void => void rules[vertex]?.[rule].push(triple);
  const sides = sidesOf(triangles);
  for (let at = 0, end = 0; at < sides.length; at = end) {
    const { low, high, third: near } = sides[at] as { low: number; high: number; third: number };
    while (end < sides.length && sides[end]?.low === low && sides[end]?.high === high) ++end;
    const far = sides[at + 1]?.third ?? 0;
    if (end - at === 2 && far < high) add(high, 0, [near, far, low]);
    if (end - at === 2 && far > high && near < far) add(far, 1, [low, high, near]);
    add(high, 2, [low, low, low]);
  }
  const chosen = rules.map(
    (lists, i): Triple[] => lists.find((list) => list.length > 0) ?? (i > 0 ? [[i - 1, i - 1, i - 1]] : []),
  );
  const first = new Uint32Array(vertexCount + 1);
  for (let i = 0; i < vertexCount; ++i) first[i + 1] = (first[i] as number) + (chosen[i] as Triple[]).length;
  return { first, triples: Uint32Array.from(chosen.flat(2)) };
}

/// The numbers [vertex_count * 3] of which six planes hold the differences: of their change since `before`, or, if
/// that is null, of themselves.
export function unfold(planes: Uint8Array[], { first, triples }: Candidates, before: Uint16Array | null): Uint16Array {
  const vertices = first.length - 1;
  const changes = new Int32Array(3 * vertices);
  const numbers = new Uint16Array(3 * vertices);
  for (let i = 0; i < vertices; ++i) {
    const from = 3 * (first[i] as number),
      to = 3 * (first[i + 1] as number);
    for (let axis = 0; axis < 3; ++axis) {
      let sum = 0;
      for (let k = from; k < to; k += 3)
        sum +=
          (changes[3 * (triples[k] as number) + axis] as number) +
          (changes[3 * (triples[k + 1] as number) + axis] as number) -
          (changes[3 * (triples[k + 2] as number) + axis] as number);
      const fold = (planes[axis]?.[i] as number) | ((planes[axis + 3]?.[i] as number) << 8);
      const change = (to > from ? Math.floor((3 * sum) / (to - from)) : 0) + ((fold >> 1) ^ -(fold & 1));
      const at = 3 * i + axis;
      const old = before ? (before[at] as number) : 0;
      numbers[at] = old + change; // modulo 65536
      changes[at] = (numbers[at] as number) - old;
    }
  }
  return numbers;
}

/// The edges of triangles, each once: low and high vertex, in rising order.
export function edgesOf(triangles: Uint32Array): Uint32Array {
  const edges: number[] = [];
  for (const { low, high } of sidesOf(triangles))
    if (edges.at(-2) !== low || edges.at(-1) !== high) edges.push(low, high);
  return Uint32Array.from(edges);
}
