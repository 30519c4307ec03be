// Where a frame has its vertices.
import { Vector3 } from "three";
import { q16Words, type Frame } from "../link/protocol";

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
