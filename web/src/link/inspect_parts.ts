// Asks for a list of what the cloths are made of (inspect.vertices, inspect.springs, inspect.elements), which comes in
// parts: one answer holds so many entries at most.

export type Ask = (method: string, params: Record<string, unknown>) => Promise<unknown>;

/// What the answers have alike; arrays are in base64 (arrays.ts).
export interface Part {
  topology_revision: number;
  total: number; ///< entries of the whole list
  first: number;
  count: number; ///< entries from `first` on in this answer
  vertices: string;
}

/// All answers, in order; null if the cloths are not, or no longer, those of `revision`.
export async function askParts<Answer extends Part>(
  ask: Ask,
  method: string,
  revision: number,
  params: Record<string, unknown> = {},
): Promise<Answer[] | null> {
  const found: Answer[] = [];
  for (let first = 0; ; ) {
    const part = (await ask(method, { ...params, first })) as Answer;
    if (part.topology_revision !== revision) return null;
    found.push(part);
    first += part.count;
    if (first >= part.total || part.count === 0) return found;
  }
}
