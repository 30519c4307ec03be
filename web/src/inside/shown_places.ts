// Where the vertices of the frame on screen are, as numbers here and on the graphics processor.
import { BufferAttribute } from "three";
import { q16Words, type ShownFrame } from "../link/protocol";
import { decodePlaces } from "../view/places";

export class ShownPlaces {
  readonly places: Float32Array; ///< [vertex_count * 3] [m]
  frame: ShownFrame | null = null;
  // in turn, as in ClothView
  private readonly buffers: [BufferAttribute, BufferAttribute];

  constructor(readonly vertexCount: number) {
    this.places = new Float32Array(3 * vertexCount);
    this.buffers = [0, 1].map(() => new BufferAttribute(new Float32Array(3 * vertexCount), 3)) as [
      BufferAttribute,
      BufferAttribute,
    ];
  }

  /// Takes a frame of as many vertices.
  take(frame: ShownFrame): void {
    this.frame = frame;
    decodePlaces({ header: frame.header, words: q16Words(frame) }, this.places);
    this.buffers.reverse();
    (this.attribute.array as Float32Array).set(this.places);
    this.attribute.needsUpdate = true;
  }

  get attribute(): BufferAttribute {
    return this.buffers[0];
  }
}

/// The unit normals of a frame's vertices, from their bytes (octahedral). [vertex_count * 3]
export function normalsOf(frame: ShownFrame, vertexCount: number): Float32Array {
  const words = q16Words(frame);
  const normals = new Float32Array(3 * vertexCount);
  const signed = (byte: number): number => Math.max((byte > 127 ? byte - 256 : byte) / 127, -1);
  for (let i = 0; i < vertexCount; ++i) {
    const word = words[4 * i + 3] as number;
    let x = signed(word & 255),
      y = signed(word >> 8);
    const z = 1 - Math.abs(x) - Math.abs(y),
      fold = Math.max(-z, 0);
    x += x >= 0 ? -fold : fold;
    y += y >= 0 ? -fold : fold;
    const size = Math.hypot(x, y, z);
    normals[3 * i] = x / size;
    normals[3 * i + 1] = y / size;
    normals[3 * i + 2] = z / size;
  }
  return normals;
}
