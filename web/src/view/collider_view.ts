// Spheres and planes of the scene, and the studio floor where a scene has none. Where they are now, the session says.
import {
  CircleGeometry,
  type Color,
  DoubleSide,
  Group,
  Mesh,
  MeshLambertMaterial,
  ShaderMaterial,
  SphereGeometry,
  Vector3,
  type IUniform,
  type Object3D,
} from "three";
import { casterMaterial, type StageUniforms } from "./fabric_material";
import type { Collider, MovedCollider, Plane, SceneDocument } from "../link/scene_types";
import { groundFragment, groundVertex, porcelain } from "./shaders";

const up = new Vector3(0, 1, 0),
  forward = new Vector3(0, 0, 1);

/// Colours of the ground, set by the theme.
export interface GroundUniforms {
  groundColor: IUniform<Color>;
  shadowColor: IUniform<Color>;
  lineColor: IUniform<Color>;
}

function sphereMaterial(stage: StageUniforms): MeshLambertMaterial {
  const material = new MeshLambertMaterial({ color: 0xd9d4c8 });
  material.onBeforeCompile = (shader) => {
    shader.fragmentShader = shader.fragmentShader.replace(
      "#include <opaque_fragment>",
      `${porcelain}\n#include <opaque_fragment>`,
    );
    Object.assign(shader.uniforms, stage);
  };
  return material;
}

function groundMaterial(uniforms: Record<string, IUniform>, solid: boolean): ShaderMaterial {
  return new ShaderMaterial({
    uniforms,
    defines: solid ? { LINES: 1 } : {},
    vertexShader: groundVertex,
    fragmentShader: groundFragment,
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
  });
}

interface Shown {
  collider: Collider;
  index: number;
  mesh: Mesh;
  caster: Mesh | null;
}

function layPlane(mesh: Mesh, { point, normal }: Plane): void {
  mesh.position.set(...point);
  mesh.quaternion.setFromUnitVectors(forward, new Vector3(...normal).normalize());
}

export class ColliderView {
  readonly object = new Group();
  readonly caster = new Group(); ///< drawn into the ground's shadow
  private readonly sphere = new SphereGeometry(1, 40, 24);
  private readonly coarseSphere = new SphereGeometry(1, 16, 10); // a blurred shadow needs no more
  private readonly disc = new CircleGeometry(1, 64);
  private readonly sphereMaterial;
  private readonly planeMaterial;
  private readonly casterMaterial = casterMaterial();
  private readonly depthMaterial = casterMaterial();
  private readonly studio: Mesh;
  private readonly radius = { value: 1 };
  private shown: Shown[] = [];
  private lowest = 0; // where the studio floor is [m]

  constructor(
    private readonly stage: StageUniforms,
    ground: GroundUniforms,
    shadow: Record<string, IUniform>,
  ) {
    this.sphereMaterial = sphereMaterial(stage);
    const uniforms = { ...ground, ...shadow, fadeRadius: this.radius };
    this.planeMaterial = groundMaterial(uniforms, true);
    this.studio = new Mesh(this.disc, groundMaterial(uniforms, false));
    this.studio.quaternion.setFromUnitVectors(forward, up);
    this.studio.frustumCulled = false;
  }

  setDocument(document: SceneDocument, sceneRadius: number): void {
    this.object.clear();
    this.caster.clear();
    this.radius.value = sceneRadius * 2.8;
    this.shown = document.colliders.flatMap((collider, index) => {
      const mesh = this.meshOf(collider);
      return mesh ? [{ collider, index, mesh, caster: this.casterOf(collider) }] : [];
    });
    for (const { mesh, caster } of this.shown) {
      this.object.add(mesh);
      if (caster) this.caster.add(caster);
    }
    const floored = document.colliders.some(({ plane }) => plane && new Vector3(...plane.normal).normalize().y > 0.7);
    if (!floored) this.object.add(this.studio);
    const bottoms = document.colliders.flatMap(({ sphere }) => (sphere ? [sphere.center[1] - sphere.radius] : []));
    this.lowest = Math.min(0, ...bottoms);
    this.studio.scale.setScalar(this.radius.value);
    this.studio.position.y = this.lowest;
  }

  /// Puts everything where it is now, by `moved` or else by the scene; `clothBottom` [m] pushes the studio floor down,
  /// it is no collider.
  update(moved: MovedCollider[], clothBottom: number): void {
    let spheres = 0;
    for (const { collider, index, mesh, caster } of this.shown) {
      const { sphere, plane } = moved.find((one) => one.index === index) ?? collider;
      if (plane) layPlane(mesh, plane);
      if (!sphere) continue;
      mesh.position.set(...sphere.center);
      caster?.position.copy(mesh.position);
      this.stage.occluders.value[spheres++]?.set(...sphere.center, sphere.radius);
    }
    for (; spheres < this.stage.occluders.value.length; ++spheres) this.stage.occluders.value[spheres]?.set(0, 0, 0, 0);
    this.studio.position.y = Math.min(this.lowest, clothBottom - 0.01);
  }

  /// What is drawn like every sphere and the studio floor, and like a sphere's shadow: see ClothView.samples.
  samples(): { shown: Object3D[]; cast: Object3D[] } {
    return {
      shown: [new Mesh(this.sphere, this.sphereMaterial), this.studio],
      cast: [new Mesh(this.coarseSphere, this.casterMaterial)],
    };
  }

  private meshOf(collider: Collider): Mesh | null {
    if (collider.sphere) {
      const mesh = new Mesh(this.sphere, this.sphereMaterial);
      mesh.scale.setScalar(collider.sphere.radius);
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.customDepthMaterial = this.depthMaterial;
      return mesh;
    }
    if (!collider.plane) return null;
    const mesh = new Mesh(this.disc, this.planeMaterial);
    mesh.scale.setScalar(this.radius.value);
    return mesh;
  }

  private casterOf(collider: Collider): Mesh | null {
    if (!collider.sphere) return null;
    const caster = new Mesh(this.coarseSphere, this.casterMaterial);
    caster.scale.setScalar(collider.sphere.radius);
    return caster;
  }
}
