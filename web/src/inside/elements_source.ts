// Fetches the springs and finite elements of the scene, part by part, and again when the cloth is another.
import { floats, joined, octets, uints } from "../link/arrays";
import { type Ask, askParts, type Part } from "../link/inspect_parts";
import type { Elements, Springs } from "./strain";

interface SpringsPart extends Part {
  rest_length: string;
  kind: string;
}

interface ElementsPart extends Part {
  shares: string;
}

export async function fetchSprings(ask: Ask, revision: number): Promise<Springs | null> {
  const found = await askParts<SpringsPart>(ask, "inspect.springs", revision);
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
  const found = await askParts<ElementsPart>(ask, "inspect.elements", revision);
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
