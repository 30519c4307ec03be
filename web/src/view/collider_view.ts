// Shows the colliders of the scene, and a studio floor if the scene has no floor. The session says where colliders are
// now; solids.ts shows each kind of shape.
import { type Color, Group, type IUniform, Mesh, type Object3D, Vector3 } from "three";
import type { StageUniforms } from "./fabric_material";
import type { Collider, MovedCollider, SceneDocument, Shape } from "../link/scene_types";
import { bottomOf, floorOf, forward, groundMaterial, occlude, place, type Shown, SolidMaker } from "./solids";

const up = new Vector3(0, 1, 0);

/// Colours of the ground, set by the theme.
export interface GroundUniforms {
  groundColor: IUniform<Color>;
  shadowColor: IUniform<Color>;
  lineColor: IUniform<Color>;
}

export class ColliderView {
  readonly object = new Group();
  readonly caster = new Group(); ///< casts the ground's shadow
  private readonly maker: SolidMaker;
  private readonly studio: Mesh;
  private readonly radius = { value: 1 };
  private shown: (Shown & { collider: Collider; index: number })[] = [];
  private lowest = 0; // height of the studio floor [m]

  constructor(
    private readonly stage: StageUniforms,
    ground: GroundUniforms,
    shadow: Record<string, IUniform>,
  ) {
    const uniforms = { ...ground, ...shadow, fadeRadius: this.radius };
    this.maker = new SolidMaker(stage, uniforms);
    this.studio = new Mesh(this.maker.disc, groundMaterial(uniforms, false));
    this.studio.quaternion.setFromUnitVectors(forward, up);
    this.studio.frustumCulled = false;
  }

  /// The meshes on the stage, without planes, with their numbers in the document.
  get bodies(): { mesh: Mesh; index: number }[] {
    return this.shown.filter(({ collider }) => !("plane" in collider));
  }

  setDocument(document: SceneDocument, sceneRadius: number): void {
    this.object.clear();
    this.caster.clear();
    const before = this.shown;
    this.radius.value = sceneRadius * 2.8;
    this.shown = document.colliders.flatMap((collider, index) => {
      const made = this.maker.make(collider, this.radius.value);
      return made ? [{ ...made, collider, index }] : [];
    });
    for (const { dispose } of before) dispose?.(); // not before: what is in the scene still is kept
    for (const { mesh, caster } of this.shown) {
      this.object.add(mesh);
      if (caster) this.caster.add(caster);
    }
    const floored = document.colliders.some((collider) => floorOf(collider) !== null);
    if (!floored) this.object.add(this.studio);
    this.lowest = Math.min(0, ...document.colliders.map((collider) => bottomOf(collider) ?? 0));
    this.studio.scale.setScalar(this.radius.value);
    this.studio.position.y = this.lowest;
  }

  /// Places everything: colliders as `moved` says, else as the scene does. The studio floor is no collider: it stays
  /// below `clothBottom` [m].
  update(moved: MovedCollider[], clothBottom: number): void {
    const occluders = this.stage.occluders.value;
    let used = 0;
    for (const shown of this.shown) {
      // A body that moves keeps its mesh.
      const now: Shape = { ...shown.collider, ...moved.find(({ index }) => index === shown.index) };
      place(shown, now);
      if (occlude(now, occluders[used])) ++used;
    }
    for (; used < occluders.length; ++used) occluders[used]?.set(0, 0, 0, 0);
    this.studio.position.y = Math.min(this.lowest, clothBottom - 0.01);
  }

  /// Objects with the materials of every body, the studio floor and a body's shadow: see ClothView.samples.
  samples(): { shown: Object3D[]; cast: Object3D[] } {
    const { shown, cast } = this.maker.samples();
    return { shown: [...shown, this.studio], cast };
  }
}
