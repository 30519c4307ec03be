// The pairs that contact keeps apart, as inspect.contacts tells them, and where they are in a later frame.
import { floats, octets, uints } from "../link/arrays";

export const kinds = ["vertex–vertex", "vertex–triangle", "edge–edge", "on solids"] as const;
const edgeEdge = 2,
  vertexSolid = 3;

/// The answer to inspect.contacts.
export interface ContactsAnswer {
  topology_revision: number;
  revision: number;
  time: number;
  step: number;
  searched: boolean;
  total: number;
  count: number;
  kind: string;
  vertices: string;
  shares: string;
  gap: string;
  keep: string;
  nearest: string;
}

export interface ContactPairs {
  count: number;
  kind: Uint8Array;
  vertices: Uint32Array; ///< [count * 4]
  shares: Float32Array; ///< [count * 4]
  gap: Float32Array; ///< [m]
  keep: Float32Array; ///< [m]
  nearest: Float32Array; ///< [count * 6] when they were told [m]
}

export function pairsOf(answer: ContactsAnswer): ContactPairs {
  return {
    count: answer.count,
    kind: octets(answer.kind),
    vertices: uints(answer.vertices),
    shares: floats(answer.shares),
    gap: floats(answer.gap),
    keep: floats(answer.keep),
    nearest: floats(answer.nearest),
  };
}

/// Writes where both points of each pair are to `from` and `to` [count * 3]: those on cloth go with it; those on
/// bodies, whose vertices frames do not have, stay where they were told. `places`: of a frame [vertex_count * 3].
export function followPairs(pairs: ContactPairs, places: Float32Array, from: Float32Array, to: Float32Array): void {
  const cloth = places.length / 3;
  for (let i = 0; i < pairs.count; ++i) {
    const ofFirst = pairs.kind[i] === edgeEdge ? 2 : 1;
    for (const second of [false, true]) {
      const into = second ? to : from;
      const [begin, end] = second ? [ofFirst, 4] : [0, ofFirst];
      let onCloth = !(second && pairs.kind[i] === vertexSolid),
        x = 0,
        y = 0,
        z = 0;
      for (let k = begin; k < end && onCloth; ++k) {
        const share = pairs.shares[4 * i + k] as number,
          vertex = pairs.vertices[4 * i + k] as number;
        if (share === 0) continue;
        onCloth = vertex < cloth;
        x += share * (places[3 * vertex] ?? 0);
        y += share * (places[3 * vertex + 1] ?? 0);
        z += share * (places[3 * vertex + 2] ?? 0);
      }
      const told = 6 * i + (second ? 3 : 0);
      into.set(onCloth ? [x, y, z] : pairs.nearest.subarray(told, told + 3), 3 * i);
    }
  }
}

/// Colours of a gap as a share of the distance kept: half of it or less, all of it, half more.
export const gapColours = ["#ff4a36", "#ffc928", "#4aa8ff"] as const;
const gapStops = gapColours.map((hex) => [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16) / 255));

/// As shares of sRGB.
export function gapColour(share: number): [number, number, number] {
  const at = Math.min(Math.max((share - 0.5) / 0.5, 0), 2),
    below = Math.min(Math.floor(at), 1);
  const [low, high] = [gapStops[below], gapStops[below + 1]] as [number[], number[]];
  return low.map((value, i) => value + (at - below) * ((high[i] as number) - value)) as [number, number, number];
}

const millimetres = (metres: number): string => `${Number((1000 * metres).toPrecision(3))} mm`;

/// What the pairs are, in words.
export function contactsText({ searched, total, count }: ContactsAnswer, pairs: ContactPairs): string {
  if (total === 0) return searched ? "No pair is near." : "Told after the next step.";
  const many = kinds
    .map((name, kind) => [pairs.kind.filter((of) => of === kind).length, name] as const)
    .filter(([number]) => number > 0);
  const shown = count < total ? `the nearest ${count} of ${total} pairs` : `${total} ${total === 1 ? "pair" : "pairs"}`;
  const list =
    many.length > 1 ? `: ${many.map(([number, name]) => `${number} ${name}`).join(", ")}` : `, ${many[0]?.[1] ?? ""}`;
  const nearest =
    pairs.count > 0
      ? ` Nearest: ${millimetres(pairs.gap[0] as number)} of ${millimetres(pairs.keep[0] as number)}.`
      : "";
  const later = searched ? "" : " Cloth near cloth is told after the next step.";
  return `${shown[0]?.toUpperCase() ?? ""}${shown.slice(1)}${list}.${nearest}${later}`;
}
