// Fetches the springs and finite elements of the scene, page by page, and again when the cloth is another.
import { floats, joined, octets, uints } from "../link/arrays";
import type { Elements, Springs } from "./strain";

interface Part {
  topology_revision: number;
  total: number;
  first: number;
  count: number;
  vertices: string;
  rest_length: string;
  kind: string;
  shares: string;
}

export type Ask = (method: string, params: Record<string, unknown>) => Promise<unknown>;

/// All answers of a list; null if the cloth changed meanwhile.
async function parts(ask: Ask, method: string, revision: number): Promise<Part[] | null> {
  const found: Part[] = [];
  for (let first = 0; ; ) {
    const part = (await ask(method, { first })) as Part;
    if (part.topology_revision !== revision) return null;
    found.push(part);
    first += part.count;
    if (first >= part.total || part.count === 0) return found;
  }
}

export async function fetchSprings(ask: Ask, revision: number): Promise<Springs | null> {
  const found = await parts(ask, "inspect.springs", revision);
  if (!found) return null;
  const restLength = joined(
    found.map((part) => floats(part.rest_length)),
    Float32Array,
  );
  return {
    corners: 2,
    vertices: joined(
      found.map((part) => uints(part.vertices)),
      Uint32Array,
    ),
    restLength,
    kind: joined(
      found.map((part) => octets(part.kind)),
      Uint8Array,
    ),
    strain: new Float32Array(restLength.length),
  };
}

export async function fetchElements(ask: Ask, revision: number): Promise<Elements | null> {
  const found = await parts(ask, "inspect.elements", revision);
  if (!found) return null;
  const vertices = joined(
    found.map((part) => uints(part.vertices)),
    Uint32Array,
  );
  const shares = joined(
    found.map((part) => floats(part.shares)),
    Float32Array,
  );
  return { corners: 3, vertices, shares, strain: new Float32Array(vertices.length / 3) };
}
