// Draws the streamed vertices. The q16 payload is the vertex buffer; the vertex shader decodes it.
import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  Group,
  Mesh,
  Points,
  Vector3,
  type IUniform,
  type Object3D,
} from "three";
import {
  clothCasterMaterial,
  FabricMaterial,
  pinMaterial,
  type DecodeUniforms,
  type StageUniforms,
} from "./fabric_material";
import { fields } from "./fields";
import { fixedRange } from "./field_ranges";
import { heldVertices } from "./pins";
import { fieldBytes, q16Words, type ShownFrame, type Topology } from "../link/protocol";
import type { SceneDocument } from "../link/scene_types";

const mostMarkers = 160; // more would hide the cloth

export class ClothView {
  readonly object = new Group();
  readonly caster = new Group(); ///< casts the ground's shadow
  readonly box = new Box3(); ///< of the frame on screen [m]
  vertices = 0;
  topology: Topology | null = null;
  private document: SceneDocument | null = null;
  // Two buffers in turn. With one, Chromium's software WebGL drew the mesh, but not the pins, with the vertices of an
  // earlier frame, and kept doing so when no further frame came.
  private words: [BufferAttribute, BufferAttribute] | null = null;
  private fields: [BufferAttribute, BufferAttribute] | null = null; // from the first frame with a field on
  private readonly decode: DecodeUniforms = {
    boxMinimum: { value: new Vector3() },
    boxExtent: { value: new Vector3() },
    coloured: { value: 0 },
    fieldPower: { value: 1 },
    fieldScale: { value: 1 },
  };
  private readonly materials: FabricMaterial[] = [];
  private readonly depthMaterial = clothCasterMaterial(this.decode);
  private readonly casterMaterial = clothCasterMaterial(this.decode);
  private readonly pinMaterial;
  private mesh: Mesh | null = null;
  private markers: Points | null = null;

  constructor(
    private readonly stage: StageUniforms,
    pixelRatio: IUniform<number>,
  ) {
    this.pinMaterial = pinMaterial(this.decode, pixelRatio);
  }

  setDocument(document: SceneDocument): void {
    this.document = document;
    document.cloths.forEach((cloth, i) => this.material(i).show(cloth));
    this.rebuildMarkers();
  }

  setTopology(topology: Topology): void {
    this.topology = topology;
    this.dispose();
  }

  /// Takes the frame's bytes as they are. False if they belong to a topology that is not here.
  show(frame: ShownFrame): boolean {
    const { header } = frame;
    if (
      !this.topology ||
      this.topology.revision !== header.topologyRevision ||
      this.topology.vertexCount !== header.vertexCount
    ) {
      return false;
    }
    this.takeField(frame);
    const words = q16Words(frame);
    if (this.words) {
      this.words.reverse();
      this.words[0].array = words;
      this.words[0].needsUpdate = true;
      this.bindWords(this.mesh?.geometry);
      this.bindWords(this.markers?.geometry);
    } else {
      this.words = [new BufferAttribute(words, 4, true), new BufferAttribute(words, 4, true)];
      this.build(this.topology);
    }
    this.vertices = header.vertexCount;
    this.decode.boxMinimum.value.set(...header.boxMinimum);
    this.decode.boxExtent.value.set(...header.boxExtent);
    this.box.min.set(...header.boxMinimum);
    this.box.max.copy(this.box.min).add(this.decode.boxExtent.value);
    return true;
  }

  // A frame without a field leaves the last one where it is, unseen.
  private takeField(frame: ShownFrame): void {
    const bytes = fieldBytes(frame);
    this.decode.coloured.value = bytes ? 1 : 0;
    if (!bytes || !frame.field) return;
    this.decode.fieldPower.value = fields[frame.field].power;
    this.decode.fieldScale.value = frame.header.range / (fixedRange(frame.field) ?? frame.header.range);
    this.fields ??= [new BufferAttribute(bytes, 1, true), new BufferAttribute(bytes, 1, true)];
    this.fields.reverse();
    this.fields[0].array = bytes;
    this.fields[0].needsUpdate = true;
  }

  /// Empty objects with the materials of a cloth, its pins and its shadow. They let WebGL compile the programs before
  /// there is a cloth.
  samples(): { shown: Object3D[]; cast: Object3D[] } {
    const nothing = new BufferGeometry();
    return {
      shown: [new Mesh(nothing, this.material(0)), new Points(nothing, this.pinMaterial)],
      cast: [new Mesh(nothing, this.casterMaterial)],
    };
  }

  private material(index: number): FabricMaterial {
    return (this.materials[index] ??= new FabricMaterial(this.decode, this.stage));
  }

  // Binds both buffers. The one not in use is bound so that it is freed with the geometry.
  private bindWords(geometry: BufferGeometry | undefined): void {
    if (!geometry || !this.words) return;
    geometry.setAttribute("q16", this.words[0]);
    geometry.setAttribute("resting", this.words[1]);
    if (!this.fields) return;
    geometry.setAttribute("field", this.fields[0]);
    geometry.setAttribute("restingField", this.fields[1]);
  }

  private build(topology: Topology): void {
    const geometry = new BufferGeometry();
    this.bindWords(geometry);
    geometry.setAttribute("textureCoordinate", new BufferAttribute(topology.textureCoordinates, 2));
    geometry.setIndex(new BufferAttribute(topology.triangles, 1));
    this.addGroups(geometry, topology);
    this.mesh = new Mesh(
      geometry,
      topology.cloths.map((_, i) => this.material(i)),
    );
    this.mesh.frustumCulled = false; // only the shader knows its box
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.mesh.customDepthMaterial = this.depthMaterial;
    this.object.add(this.mesh);
    const caster = new Mesh(
      geometry,
      topology.cloths.map(() => this.casterMaterial),
    );
    caster.frustumCulled = false;
    this.caster.add(caster);
    this.rebuildMarkers();
  }

  // Adds a group of the index for each run of triangles of one cloth.
  private addGroups(geometry: BufferGeometry, topology: Topology): void {
    const clothOf = (vertex: number) =>
      topology.cloths.findIndex(
        ({ firstVertex, vertexCount }) => vertex >= firstVertex && vertex < firstVertex + vertexCount,
      );
    let start = 0;
    let current = clothOf(topology.triangles[0] ?? 0);
    for (let at = 3; at <= topology.triangles.length; at += 3) {
      const cloth = at < topology.triangles.length ? clothOf(topology.triangles[at] ?? 0) : -1;
      if (cloth === current) continue;
      geometry.addGroup(start, at - start, current);
      start = at;
      current = cloth;
    }
  }

  private rebuildMarkers(): void {
    if (this.markers) {
      this.object.remove(this.markers);
      this.markers.geometry.dispose();
      this.markers = null;
    }
    if (!this.words || !this.topology || !this.document) return;
    const ranges = this.topology.cloths;
    const pinned = this.document.cloths.flatMap((cloth, i) => {
      const range = ranges[i];
      return range
        ? [...heldVertices(cloth).keys()].filter((v) => v < range.vertexCount).map((v) => range.firstVertex + v)
        : [];
    });
    if (pinned.length === 0 || pinned.length > mostMarkers) return;
    const geometry = new BufferGeometry();
    this.bindWords(geometry);
    geometry.setIndex(pinned);
    this.pinMaterial.uniforms.diameter = { value: pinned.length <= 8 ? 9 : 5 };
    this.markers = new Points(geometry, this.pinMaterial);
    this.markers.frustumCulled = false;
    this.object.add(this.markers);
  }

  private dispose(): void {
    if (this.mesh) this.object.remove(this.mesh);
    this.caster.clear();
    this.mesh?.geometry.dispose();
    this.mesh = null;
    this.words = this.fields = null;
    this.rebuildMarkers();
  }
}
