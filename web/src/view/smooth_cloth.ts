// The cloth as a finer, curved mesh with a rounded hem and darkness in its folds: made of the same frames, in the page.
import { BufferAttribute, BufferGeometry } from "three";
import type { Header, Topology } from "../link/protocol";
import { FoldShade, rounds } from "./fold_shade";
import { around, Hem } from "./hem";
import { Patches } from "./patches";
import { decodePlaces } from "./places";
import { interpolate, refine, type Refinement } from "./refinement";

const shadeBytes = 4; // at a vertex: front, back, 255 on the hem, nothing

interface Buffers {
  position: BufferAttribute;
  normal: BufferAttribute;
  shade: BufferAttribute;
  field: BufferAttribute | null;
}

export class SmoothCloth {
  readonly geometry = new BufferGeometry();
  private readonly of: Refinement;
  private readonly patches: Patches;
  private readonly hem: Hem;
  private readonly folds: FoldShade;
  private readonly places: Float32Array; ///< [vertex_count * 3] [m], with the hem's
  private readonly normals: Float32Array;
  private readonly buffers: [Buffers, Buffers]; // in turn, as in ClothView
  private readonly clothOf: Uint8Array | Uint32Array; ///< of each vertex of the topology
  private readonly count: number;
  private shadedAt = Number.NEGATIVE_INFINITY; // simulated time [s]
  private round = 0;

  constructor(
    topology: Topology,
    readonly steps: number,
  ) {
    this.of = refine(topology, steps);
    this.patches = new Patches(this.of);
    this.hem = new Hem(this.of);
    this.folds = new FoldShade(topology);
    this.count = this.of.vertexCount + around * this.hem.vertices.length;
    this.places = new Float32Array(3 * this.count);
    this.normals = new Float32Array(3 * this.count);
    this.clothOf = new Uint32Array(this.of.vertexCount);
    topology.cloths.forEach(({ firstVertex, vertexCount }, cloth) =>
      this.clothOf.fill(cloth, firstVertex, firstVertex + vertexCount),
    );
    this.index(topology.cloths.length);
    const texture = new Float32Array(2 * this.count);
    texture.set(topology.textureCoordinates);
    interpolate(this.of, texture, 2);
    this.spread(texture, 2);
    this.geometry.setAttribute("textureCoordinate", new BufferAttribute(texture, 2));
    this.buffers = [this.makeBuffers(), this.makeBuffers()];
  }

  private makeBuffers(): Buffers {
    const shade = new Uint8Array(shadeBytes * this.count);
    for (let i = this.of.vertexCount; i < this.count; ++i) shade[shadeBytes * i + 2] = 255;
    return {
      position: new BufferAttribute(new Float32Array(3 * this.count), 3),
      normal: new BufferAttribute(new Int16Array(4 * this.count), 4, true),
      shade: new BufferAttribute(shade, shadeBytes, true),
      field: null,
    };
  }

  // One run of the index for each cloth: its triangles, then those of its hem.
  private index(cloths: number): void {
    const { fine, steps, triangles } = this.of;
    const runs: number[][] = Array.from({ length: cloths }, () => []);
    const each = 3 * steps * steps;
    for (let at = 0; at < fine.length; at += each) {
      const cloth = this.clothOf[triangles[(3 * at) / each] as number] as number;
      for (const vertex of fine.subarray(at, at + each)) {
        this.clothOf[vertex] = cloth;
        (runs[cloth] as number[]).push(vertex);
      }
    }
    const tube = this.hem.triangles;
    for (let at = 0; at < tube.length; at += 3) {
      const ring = Math.floor(((tube[at] as number) - this.of.vertexCount) / around);
      const cloth = this.clothOf[this.hem.vertices[ring] as number] as number;
      (runs[cloth] as number[]).push(...tube.subarray(at, at + 3));
    }
    const index = new Uint32Array(fine.length + tube.length);
    let start = 0;
    runs.forEach((run, cloth) => {
      index.set(run, start);
      this.geometry.addGroup(start, run.length, cloth);
      start += run.length;
    });
    this.geometry.setIndex(new BufferAttribute(index, 1));
  }

  // The hem's vertices have the values of the outline's.
  private spread(values: Float32Array | Uint8Array, size: number): void {
    this.hem.vertices.forEach((vertex, ring) => {
      for (let k = 0; k < around; ++k)
        values.copyWithin(size * (this.of.vertexCount + around * ring + k), size * vertex, size * (vertex + 1));
    });
  }

  /// Takes a frame; `radii` [m]: of the hem of each cloth.
  show(frame: { header: Header; words: Uint16Array }, field: Uint8Array | null, radii: number[]): void {
    const { of, places, normals, buffers } = this;
    buffers.reverse();
    const [now, resting] = buffers;
    decodePlaces(frame, places.subarray(0, 3 * of.coarse));
    this.patches.place(places, normals);
    this.hem.place(places, normals, of.vertexCount, (vertex) => radii[this.clothOf[vertex] as number] ?? 0);
    const shade = now.shade.array as Uint8Array;
    shade.set((resting.shade.array as Uint8Array).subarray(0, shadeBytes * of.coarse));
    this.shadeFolds(frame.header.time, shade);
    interpolate(of, shade.subarray(0, shadeBytes * of.vertexCount), shadeBytes);
    (now.position.array as Float32Array).set(places);
    const packed = now.normal.array as Int16Array;
    for (let from = 0, to = 0; from < normals.length; from += 3, to += 4) {
      packed[to] = 32767 * (normals[from] as number);
      packed[to + 1] = 32767 * (normals[from + 1] as number);
      packed[to + 2] = 32767 * (normals[from + 2] as number);
    }
    if (field) {
      now.field ??= new BufferAttribute(new Uint8Array(this.count), 1, true);
      const values = now.field.array as Uint8Array;
      values.set(field);
      interpolate(of, values, 1);
      this.spread(values, 1);
    }
    this.bind(now, "");
    this.bind(resting, "resting"); // so that it is freed with the geometry
  }

  // Of frames that follow each other each has the shade of some vertices anew: it changes slowly, and all of it would
  // take as long as the rest. A frame that is shown again, or that is of another time, has all of it.
  private shadeFolds(time: number, shade: Uint8Array): void {
    const follows = time > this.shadedAt && time < this.shadedAt + 0.1;
    this.shadedAt = time;
    this.round = (this.round + 1) % rounds;
    this.folds.measure(this.places, this.normals, shade, shadeBytes, follows ? [this.round, rounds] : [0, 1]);
  }

  private bind(buffers: Buffers, prefix: string): void {
    for (const name of ["position", "normal", "shade", "field"] as const) {
      const attribute = buffers[name];
      if (!attribute) continue;
      if (!prefix) attribute.needsUpdate = true;
      this.geometry.setAttribute(prefix + name, attribute);
    }
  }

  dispose(): void {
    this.geometry.dispose();
  }
}
