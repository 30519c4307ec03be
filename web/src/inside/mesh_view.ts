// Draws the mesh's edges and the normals of its vertices.
import { BufferAttribute, Group } from "three";
import type { Topology } from "../link/protocol";
import type { Choices } from "./choices";
import { ThinLines } from "./lines";
import { meanLength, meshEdges } from "./mesh_edges";
import { normalsOf, type ShownPlaces } from "./shown_places";
import type { LineKind } from "./tones";

const mostNormals = 20_000; // of larger cloths every so many vertices have one
const normalLength = 0.7; // of the mean edge

export class MeshView {
  readonly object = new Group();
  private readonly wireframe = new ThinLines();
  private readonly normals = new ThinLines();
  private topology: Topology | null = null;
  private edges: Uint32Array | null = null; // of the topology, once they are needed
  private ends: [BufferAttribute, BufferAttribute] | null = null; // of normals, in turn as in ShownPlaces

  constructor() {
    this.object.add(this.wireframe.object, this.normals.object);
  }

  take(topology: Topology): void {
    this.topology = topology;
    this.edges = this.ends = null;
    this.wireframe.index = null;
  }

  paint(tones: Record<LineKind, { colour: string; opacity: number }>): void {
    this.wireframe.look = tones.wireframe;
    this.normals.look = tones.normals;
  }

  show(shown: ShownPlaces, choices: Choices): void {
    this.wireframe.object.visible = choices.wireframe && this.topology !== null;
    this.normals.object.visible = choices.normals && this.topology !== null;
    if (!this.topology || (!choices.wireframe && !choices.normals)) return;
    this.edges ??= meshEdges(this.topology.triangles, this.topology.vertexCount);
    if (choices.wireframe) {
      if (!this.wireframe.object.geometry.index) this.wireframe.index = this.edges;
      this.wireframe.positions = shown.attribute;
    }
    if (choices.normals) this.showNormals(shown, this.edges);
  }

  private showNormals({ places, frame, vertexCount }: ShownPlaces, edges: Uint32Array): void {
    if (!frame) return;
    const every = Math.ceil(vertexCount / mostNormals),
      count = Math.ceil(vertexCount / every);
    this.ends ??= [0, 1].map(() => new BufferAttribute(new Float32Array(6 * count), 3)) as [
      BufferAttribute,
      BufferAttribute,
    ];
    this.ends.reverse();
    const ends = this.ends[0].array as Float32Array;
    const normals = normalsOf(frame, vertexCount),
      size = normalLength * meanLength(edges, places);
    for (let i = 0, to = 0; i < vertexCount; i += every, to += 6)
      for (let axis = 0; axis < 3; ++axis) {
        const at = places[3 * i + axis] as number;
        ends[to + axis] = at;
        ends[to + 3 + axis] = at + size * (normals[3 * i + axis] as number);
      }
    this.ends[0].needsUpdate = true;
    this.normals.positions = this.ends[0];
  }
}
