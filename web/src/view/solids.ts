// How each kind of shape is shown, and what a view knows of it. What is the same for all of them: collider_view.ts.
import {
  Box3,
  CircleGeometry,
  DoubleSide,
  type IUniform,
  Mesh,
  MeshLambertMaterial,
  type Object3D,
  ShaderMaterial,
  Sphere as Ball,
  SphereGeometry,
  Vector3,
  type Vector4,
} from "three";
import { casterMaterial, type StageUniforms } from "./fabric_material";
import { byKind, type Motion, type Plane, type Shape } from "../link/scene_types";
import { sweep } from "./motion";
import { groundFragment, groundVertex, porcelain } from "./shaders";

export const forward = new Vector3(0, 0, 1); // the normal of a disc

/// One of a scene's shapes on the stage, and what falls into the ground's shadow of it.
export interface Shown {
  mesh: Mesh;
  caster: Mesh | null;
}

const levelled = 0.7; // a normal that rises so far is that of a floor
const rises = ({ normal }: Plane): boolean => new Vector3(...normal).normalize().y > levelled;

/// How high the floor is that a shape makes [m]; null where it makes none.
export const floorOf = (shape: Shape): number | null =>
  byKind<number | null>(shape, { sphere: () => null, plane: (plane) => (rises(plane) ? plane.point[1] : null) });

/// The lowest point of a shape [m]; null where it has none.
export const bottomOf = (shape: Shape): number | null =>
  byKind<number | null>(shape, { sphere: ({ center, radius }) => center[1] - radius, plane: () => null });

const corners = (box: Box3): Vector3[] =>
  Array.from(
    { length: 8 },
    (_, i) => new Vector3((i & 1 ? box.max : box.min).x, (i & 2 ? box.max : box.min).y, (i & 4 ? box.max : box.min).z),
  );

/// A ball's outline, nearly: the corners of a box around it stick out of it.
function ballPoints(center: Vector3, radius: number): Vector3[] {
  const box = corners(new Ball(center, radius).getBoundingBox(new Box3()));
  return box.map((corner) => corner.sub(center).multiplyScalar(0.75).add(center));
}

/// Points around all that a shape sweeps [m]; none of what has no end.
export const outlineOf = (shape: Shape, motion: Motion): Vector3[] =>
  byKind<Vector3[]>(shape, {
    sphere: ({ center, radius }) => sweep(center, motion).flatMap((point) => ballPoints(point, radius)),
    plane: () => [],
  }) ?? [];

/// Puts the ball (centre, radius) by which a shape hides the sky into `occluder`; false where it hides none.
export const occlude = (shape: Shape, occluder: Vector4 | undefined): boolean =>
  byKind<boolean>(shape, {
    sphere: ({ center, radius }) => {
      occluder?.set(...center, radius);
      return true;
    },
    plane: () => false,
  }) ?? false;

/// Puts what is shown of a shape where the shape is.
export const place = ({ mesh, caster }: Shown, shape: Shape): void => {
  byKind<void>(shape, {
    sphere: ({ center }) => {
      mesh.position.set(...center);
      caster?.position.copy(mesh.position);
    },
    plane: ({ point, normal }) => {
      mesh.position.set(...point);
      mesh.quaternion.setFromUnitVectors(forward, new Vector3(...normal).normalize());
    },
  });
};

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

export function groundMaterial(uniforms: Record<string, IUniform>, solid: boolean): ShaderMaterial {
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

/// Makes the meshes of shapes, which share their geometries and materials.
export class SolidMaker {
  readonly disc = new CircleGeometry(1, 64);
  private readonly sphere = new SphereGeometry(1, 40, 24);
  private readonly coarseSphere = new SphereGeometry(1, 16, 10); // a blurred shadow needs no more
  private readonly sphereMaterial;
  private readonly planeMaterial;
  private readonly casterMaterial = casterMaterial();
  private readonly depthMaterial = casterMaterial();

  constructor(stage: StageUniforms, ground: Record<string, IUniform>) {
    this.sphereMaterial = sphereMaterial(stage);
    this.planeMaterial = groundMaterial(ground, true);
  }

  /// What has no end is shown as far as `far` [m].
  make(shape: Shape, far: number): Shown | null {
    return byKind<Shown>(shape, {
      sphere: ({ radius }) => {
        const mesh = new Mesh(this.sphere, this.sphereMaterial);
        mesh.scale.setScalar(radius);
        mesh.castShadow = mesh.receiveShadow = true;
        mesh.customDepthMaterial = this.depthMaterial;
        const caster = new Mesh(this.coarseSphere, this.casterMaterial);
        caster.scale.setScalar(radius);
        return { mesh, caster };
      },
      plane: () => {
        const mesh = new Mesh(this.disc, this.planeMaterial);
        mesh.scale.setScalar(far);
        return { mesh, caster: null };
      },
    });
  }

  /// What is drawn like every body, and like the shadow of one: see ClothView.samples.
  samples(): { shown: Object3D[]; cast: Object3D[] } {
    return {
      shown: [new Mesh(this.sphere, this.sphereMaterial)],
      cast: [new Mesh(this.coarseSphere, this.casterMaterial)],
    };
  }
}
