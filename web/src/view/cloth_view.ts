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
  setSmooth,
  type DecodeUniforms,
  type StageUniforms,
} from "./fabric_material";
import { lookOf, metresPerTexture } from "./fabric_looks";
import { fields } from "./fields";
import { fixedRange } from "./field_ranges";
import { heldInFrame } from "./pins";
import { decodePlaces } from "./places";
import { stepsFor } from "./refinement";
import { SmoothCloth } from "./smooth_cloth";
import { fieldBytes, q16Words, type ShownFrame, type Topology } from "../link/protocol";
import type { SceneDocument } from "../link/scene_types";

const mostMarkers = 160; // more would hide the cloth
const hemLayers = 3; // a hem is the cloth folded twice

/// How finely the cloths of a stage are drawn.
export interface Detail {
  triangles: number; ///< at most so many of a finer mesh
  details: boolean; ///< uneven threads and seams
  mesh: boolean; ///< the simulated triangles instead, flat
  below: boolean; ///< the simulated triangles, as something is drawn over them
}

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
  private readonly depthMaterial; // of the shadow map
  private readonly casterMaterial; // of the ground's shadow, too soft to show more than the simulated triangles
  private raw: BufferGeometry | null = null; // the frame as it came
  private smooth: SmoothCloth | null = null; // what is drawn instead, if the stage's detail allows it
  private latest: ShownFrame | null = null;
  private readonly pinMaterial;
  private metres: number[] = []; // per unit of texture coordinates, of each cloth
  private mesh: Mesh | null = null;
  private markers: Points | null = null;

  constructor(
    private readonly stage: StageUniforms,
    pixelRatio: IUniform<number>,
    private readonly detail: Detail,
  ) {
    this.depthMaterial = clothCasterMaterial(this.decode, stage, true);
    this.casterMaterial = clothCasterMaterial(this.decode, stage, false);
    this.pinMaterial = pinMaterial(this.decode, pixelRatio);
  }

  setDocument(document: SceneDocument): void {
    this.document = document;
    this.dress();
    this.rebuildMarkers();
  }

  private dress(): void {
    this.document?.cloths.forEach((cloth, i) => this.material(i).show(cloth, this.metres[i] ?? 1));
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
      this.bindWords(this.markers?.geometry);
    } else {
      this.words = [new BufferAttribute(words, 4, true), new BufferAttribute(words, 4, true)];
      this.measure(frame, this.topology);
    }
    this.latest = frame;
    this.fill(frame, this.topology);
    this.vertices = header.vertexCount;
    this.decode.boxMinimum.value.set(...header.boxMinimum);
    this.decode.boxExtent.value.set(...header.boxExtent);
    this.box.min.set(...header.boxMinimum);
    this.box.max.copy(this.box.min).add(this.decode.boxExtent.value);
    return true;
  }

  /// Takes the stage's detail as it is now.
  refit(): void {
    if (this.latest && this.topology && this.words) this.fill(this.latest, this.topology);
  }

  // Puts a frame into the mesh that is drawn, which is made if there is none as fine as it should be.
  private fill(frame: ShownFrame, topology: Topology): void {
    const { detail } = this;
    const steps = detail.mesh || detail.below ? 0 : stepsFor(topology.triangles.length / 3, detail.triangles);
    if (!this.mesh || !this.raw) this.build(topology);
    if (steps !== (this.smooth?.steps ?? 0)) {
      this.smooth?.dispose();
      this.smooth = steps > 0 ? new SmoothCloth(topology, steps) : null;
    }
    this.bindWords(this.raw ?? undefined);
    this.smooth?.show({ header: frame.header, words: q16Words(frame) }, fieldBytes(frame), this.hems());
    if (this.mesh && this.raw) this.mesh.geometry = this.smooth?.geometry ?? this.raw;
    for (const material of [...this.materials, this.depthMaterial]) setSmooth(material, steps > 0);
    for (const material of this.materials)
      if (material.flatShading !== detail.mesh) {
        material.flatShading = detail.mesh;
        material.needsUpdate = true;
      }
  }

  /// Before a picture: the size of its pixels on the nearest cloth [m].
  set pixel(size: number) {
    for (const material of this.materials) {
      material.pixel = size;
      material.details = this.detail.details;
    }
  }

  // Radii of the hems of the cloths [m].
  private hems(): number[] {
    return (this.document?.cloths ?? []).map(
      ({ material }) => (hemLayers / 2 / 1000) * lookOf(material.fabric).thickness,
    );
  }

  // Texture coordinates of mesh files have no unit: their first frame tells it.
  private measure({ header }: ShownFrame, { triangles, textureCoordinates, cloths }: Topology): void {
    const places = new Float32Array(3 * header.vertexCount);
    decodePlaces({ header, words: this.words?.[0].array as Uint16Array }, places);
    this.metres = cloths.map((range) => metresPerTexture(places, textureCoordinates, triangles, range));
    this.dress();
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
    this.material(0).details = this.detail.details;
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
    const geometry = (this.raw = new BufferGeometry());
    geometry.setAttribute("textureCoordinate", new BufferAttribute(topology.textureCoordinates, 2));
    geometry.setIndex(new BufferAttribute(topology.triangles, 1));
    this.addGroups(geometry, topology);
    this.mesh = new Mesh(
      geometry,
      topology.cloths.map((_, i) => this.material(i)),
    );
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.mesh.customDepthMaterial = this.depthMaterial;
    const caster = new Mesh(
      geometry,
      topology.cloths.map(() => this.casterMaterial),
    );
    for (const mesh of [this.mesh, caster]) mesh.frustumCulled = false; // only the shader knows its box
    this.object.add(this.mesh);
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

  /// The markers of pins; null: there are none.
  get marks(): Object3D | null {
    return this.markers;
  }

  /// Makes the markers of pins anew: where they are is known now.
  rebuildMarkers(): void {
    if (this.markers) {
      this.object.remove(this.markers);
      this.markers.geometry.dispose();
      this.markers = null;
    }
    if (!this.words || !this.topology || !this.document) return;
    const ranges = this.topology.cloths;
    const pinned = this.document.cloths.flatMap((cloth, i) => {
      const range = ranges[i];
      return range ? [...heldInFrame(cloth, range)] : [];
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
    this.raw?.dispose();
    this.smooth?.dispose();
    this.mesh = this.raw = this.smooth = null;
    this.words = this.fields = this.latest = null;
    this.rebuildMarkers();
  }
}
