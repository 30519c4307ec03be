// Where a frame has its vertices.
import { Box3, Vector3 } from "three";
import { type ClothRange, q16Words, type Frame, type Header } from "../link/protocol";

/// Reads places of vertices from a q16 frame.
export class Places {
  private readonly words: Uint16Array;

  constructor(private readonly frame: Frame) {
    this.words = q16Words(frame);
  }

  get count(): number {
    return this.frame.header.vertexCount;
  }

  of(vertex: number, into = new Vector3()): Vector3 {
    const { boxMinimum: low, boxExtent: extent } = this.frame.header;
    const at = (axis: 0 | 1 | 2): number => low[axis] + (extent[axis] * (this.words[4 * vertex + axis] ?? 0)) / 65535;
    return into.set(at(0), at(1), at(2));
  }
}

/// The box of one cloth in a frame [m].
export function boxOf(frame: Frame, { firstVertex, vertexCount }: ClothRange): Box3 {
  const places = new Places(frame);
  const box = new Box3();
  const place = new Vector3();
  for (let i = 0; i < vertexCount; ++i) box.expandByPoint(places.of(firstVertex + i, place));
  return box;
}

/// All places of a frame [m], into an array of as many threes.
export function decodePlaces({ header, words }: { header: Header; words: Uint16Array }, into: Float32Array): void {
  const { boxMinimum: low, boxExtent: extent } = header;
  const [sx, sy, sz] = extent.map((size) => size / 65535) as [number, number, number];
  for (let from = 0, to = 0; to < into.length; from += 4, to += 3) {
    into[to] = low[0] + sx * (words[from] as number);
    into[to + 1] = low[1] + sy * (words[from + 1] as number);
    into[to + 2] = low[2] + sz * (words[from + 2] as number);
  }
}
