// Makes what the stage draws of a moment of a recording: a q16 frame with normals, and with the cloth's strain.
import { packedNormals } from "../link/normals";
import type { ShownFrame } from "../link/protocol";
import type { Moment, Setting } from "./recording";

const headerBytes = 64;
const quantities = 65535;

export class Shower {
  private range = 0.0005; // of the strain that has been seen: it only grows, so that colours are steady

  /// The frame of a moment, coloured by strain if that is `strained`.
  frame(moment: Moment, setting: Setting, sequence: number, strained: boolean): ShownFrame {
    const { topology } = setting;
    const vertices = topology.vertexCount;
    const { numbers, low, quantum } = moment;
    const least = [quantities, quantities, quantities],
      most = [0, 0, 0];
    for (let i = 0; i < numbers.length; ++i) {
      const number = numbers[i] as number;
      if (number < (least[i % 3] as number)) least[i % 3] = number;
      if (number > (most[i % 3] as number)) most[i % 3] = number;
    }
    const of = (axis: number): number => (least[axis] as number) * quantum + (low[axis] as number);
    const wide = (axis: number): number => Math.max(0, (most[axis] as number) - (least[axis] as number));
    const buffer = new ArrayBuffer(headerBytes + 8 * vertices + (strained ? vertices : 0));
    const words = new Uint16Array(buffer, headerBytes, 4 * vertices);
    const both = packedNormals(numbers, topology.triangles, [1, 1, 1]);
    for (let i = 0; i < vertices; ++i) {
      for (let axis = 0; axis < 3; ++axis)
        words[4 * i + axis] = Math.round(
          (((numbers[3 * i + axis] as number) - (least[axis] as number)) * quantities) / (wide(axis) || 1),
        );
      words[4 * i + 3] = both[i] as number;
    }
    const range = strained ? this.colour(moment, setting, new Uint8Array(buffer, headerBytes + 8 * vertices)) : 0;
    return {
      header: {
        kind: 2,
        encoding: 1,
        asleep: moment.asleep,
        diverged: moment.diverged,
        topologyRevision: topology.revision,
        sequence,
        vertexCount: vertices,
        time: moment.time,
        step: moment.step,
        boxMinimum: [of(0), of(1), of(2)],
        boxExtent: [wide(0) * quantum, wide(1) * quantum, wide(2) * quantum],
        payloadBytes: buffer.byteLength - headerBytes,
        range,
      },
      buffer,
      field: strained ? "strain" : null,
      moved: moment.moved,
    };
  }

  // At a vertex, the largest change of length of an edge there, over its length at rest.
  private colour({ numbers, quantum }: Moment, { edges, restLengths }: Setting, bytes: Uint8Array): number {
    const strains = new Float32Array(bytes.length);
    let largest = 0;
    for (let e = 0; e < restLengths.length; ++e) {
      const [a, b] = [edges[2 * e], edges[2 * e + 1]] as [number, number];
      const along = [0, 1, 2].map((axis) => (numbers[3 * a + axis] as number) - (numbers[3 * b + axis] as number));
      const strain = Math.abs((Math.hypot(...along) * quantum) / (restLengths[e] as number) - 1);
      if (!Number.isFinite(strain)) continue;
      strains[a] = Math.max(strains[a] as number, strain);
      strains[b] = Math.max(strains[b] as number, strain);
      largest = Math.max(largest, strain);
    }
    this.range = Math.max(this.range, largest);
    for (let i = 0; i < bytes.length; ++i) bytes[i] = Math.round((255 * (strains[i] as number)) / this.range);
    return this.range;
  }
}
