// Draws each kind of shape, and knows what a view needs of it. collider_view.ts has what all kinds share.
import {
  Box3,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  CircleGeometry,
  DoubleSide,
  Euler,
  FrontSide,
  type IUniform,
  MathUtils,
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
import {
  type Body,
  type Box,
  byKind,
  type Capsule,
  type InlineMesh,
  type Motion,
  type Plane,
  type Shape,
  type Vec3,
} from "../link/scene_types";
import { sweep } from "./motion";
import { groundFragment, groundVertex, porcelain } from "./shaders";
import { studio } from "./studio_shader";

export const forward = new Vector3(0, 0, 1); // the normal of a disc
const upwards = new Vector3(0, 1, 0); // a capsule's axis

/// A shape of the scene on the stage, and the mesh that casts its shadow on the ground.
export interface Shown {
  mesh: Mesh;
  caster: Mesh | null;
  dispose?: () => void; ///< frees what no other shape shares
}

const levelled = 0.7; // a plane counts as a floor if its normal rises more than this
const rises = ({ normal }: Plane): boolean => new Vector3(...normal).normalize().y > levelled;

/// Height of the floor that a shape is [m]; null if it is none.
export const floorOf = (shape: Shape): number | null =>
  byKind<number | null>(shape, {
    sphere: () => null,
    plane: (plane) => (rises(plane) ? plane.point[1] : null),
    capsule: () => null,
    box: () => null,
    mesh: () => null,
  });

const middleOf = ({ a, b }: Capsule): Vector3 => new Vector3(...a).add(new Vector3(...b)).multiplyScalar(0.5);
const turnOf = ({ rotate: [x, y, z] }: { rotate: Vec3 }): Euler =>
  new Euler(MathUtils.degToRad(x), MathUtils.degToRad(y), MathUtils.degToRad(z), "ZYX"); // about x first

const cornersOf = (box: Box): Vector3[] => {
  const half = new Vector3(...box.half);
  return corners(new Box3(half.clone().negate(), half)).map((corner) =>
    corner.applyEuler(turnOf(box)).add(new Vector3(...box.center)),
  );
};
const meshOf = ({ mesh }: Body): InlineMesh => ("vertices" in mesh ? mesh : { vertices: [], triangles: [] });

/// The box around a body [m]; an empty one while its triangles are on their way.
function boundsOf(body: Body): Box3 {
  const { translate, scale } = body.transform;
  const [turn, move, point] = [turnOf(body.transform), new Vector3(...translate), new Vector3()];
  const box = new Box3();
  for (const vertex of meshOf(body).vertices)
    box.expandByPoint(
      point
        .set(...vertex)
        .multiplyScalar(scale)
        .applyEuler(turn)
        .add(move),
    );
  return box;
}

const axisOf = ({ a, b }: Capsule): Vector3 => new Vector3(...b).sub(new Vector3(...a));

/// Lowest point of a shape [m]; null if it has none.
export const bottomOf = (shape: Shape): number | null =>
  byKind<number | null>(shape, {
    sphere: ({ center, radius }) => center[1] - radius,
    plane: () => null,
    capsule: ({ a, b, radius }) => Math.min(a[1], b[1]) - radius,
    box: (box) => Math.min(...cornersOf(box).map(({ y }) => y)),
    mesh: (body) => (meshOf(body).vertices.length > 0 ? boundsOf(body).min.y : null),
  });

const corners = (box: Box3): Vector3[] =>
  Array.from(
    { length: 8 },
    (_, i) => new Vector3((i & 1 ? box.max : box.min).x, (i & 2 ? box.max : box.min).y, (i & 4 ? box.max : box.min).z),
  );

/// Points near a ball's surface: the corners of its bounding box, moved inwards.
function ballPoints(center: Vector3, radius: number): Vector3[] {
  const box = corners(new Ball(center, radius).getBoundingBox(new Box3()));
  return box.map((corner) => corner.sub(center).multiplyScalar(0.75).add(center));
}

/// Points around everything that a shape's motion covers [m]; none for an endless shape.
export const outlineOf = (shape: Shape, motion: Motion): Vector3[] =>
  byKind<Vector3[]>(shape, {
    sphere: ({ center, radius }) => sweep(center, motion).flatMap((point) => ballPoints(point, radius)),
    plane: () => [],
    capsule: ({ a, b, radius }) =>
      [...sweep(a, motion), ...sweep(b, motion)].flatMap((point) => ballPoints(point, radius)),
    box: (box) => cornersOf(box).flatMap((corner) => sweep(corner.toArray(), motion)),
    mesh: (body) => {
      const box = boundsOf(body);
      return box.isEmpty() ? [] : corners(box).flatMap((corner) => sweep(corner.toArray(), motion));
    },
  }) ?? [];

/// Sets `occluder` to the ball (centre, radius) with which a shape hides the sky: a large one inside it; false if it
/// hides none.
export const occlude = (shape: Shape, occluder: Vector4 | undefined): boolean =>
  byKind<boolean>(shape, {
    sphere: ({ center, radius }) => {
      occluder?.set(...center, radius);
      return true;
    },
    plane: () => false,
    capsule: (capsule) => {
      occluder?.set(...middleOf(capsule).toArray(), capsule.radius);
      return true;
    },
    box: ({ center, half }) => {
      occluder?.set(...center, Math.min(...half));
      return true;
    },
    mesh: () => false, // no ball is sure to be inside it
  }) ?? false;

/// Moves a shape's meshes to the shape.
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
    capsule: (capsule) => {
      for (const each of [mesh, caster]) {
        each?.position.copy(middleOf(capsule));
        each?.quaternion.setFromUnitVectors(upwards, axisOf(capsule).normalize());
      }
    },
    box: (box) => {
      for (const each of [mesh, caster]) {
        each?.position.set(...box.center);
        each?.quaternion.setFromEuler(turnOf(box));
      }
    },
    mesh: ({ transform }) => {
      for (const each of [mesh, caster]) {
        each?.position.set(...transform.translate);
        each?.quaternion.setFromEuler(turnOf(transform));
        each?.scale.setScalar(transform.scale);
      }
    },
  });
};

/// Of solids and bodies. A round one's mesh is scaled by its radius.
function bodyMaterial(stage: StageUniforms, round: boolean, bothSides = false): MeshLambertMaterial {
  const material = new MeshLambertMaterial({ color: 0xd9d4c8, side: bothSides ? DoubleSide : FrontSide });
  material.onBeforeCompile = (shader) => {
    // A round one is drawn a little deeper than it is: the middles of the triangles of cloth on it are inside it.
    if (round)
      shader.vertexShader = shader.vertexShader.replace(
        "#include <project_vertex>",
        `#include <project_vertex>
      float more = 1.0 + 0.08 * length(modelViewMatrix[0]) / length(mvPosition.xyz);
      vec4 deeper = projectionMatrix * vec4(more * mvPosition.xyz, 1.0);
      gl_Position.z = deeper.z / deeper.w * gl_Position.w;`,
      );
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <lights_lambert_pars_fragment>", `#include <lights_lambert_pars_fragment>\n${studio}`)
      .replace("#include <opaque_fragment>", `${porcelain}\n#include <opaque_fragment>`);
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

function triangleGeometry({ vertices, triangles }: InlineMesh): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(vertices.flat()), 3));
  geometry.setIndex(new BufferAttribute(new Uint32Array(triangles.flat()), 1));
  geometry.computeVertexNormals();
  return geometry;
}

/// Makes the meshes of shapes; these share their materials, and the geometries that a scale fits to a shape.
export class SolidMaker {
  readonly disc = new CircleGeometry(1, 64);
  private readonly sphere = new SphereGeometry(1, 40, 24);
  private readonly coarseSphere = new SphereGeometry(1, 16, 10); // enough for a blurred shadow
  private readonly roundMaterial;
  private readonly flatMaterial;
  private readonly meshMaterial; // a mesh may be turned inside out, or be a sheet
  private readonly planeMaterial;
  private readonly geometries = new Map<InlineMesh, { geometry: BufferGeometry; shown: number }>();
  private readonly casterMaterial = casterMaterial();
  private readonly depthMaterial = casterMaterial();

  constructor(stage: StageUniforms, ground: Record<string, IUniform>) {
    this.roundMaterial = bodyMaterial(stage, true);
    this.flatMaterial = bodyMaterial(stage, false);
    this.meshMaterial = bodyMaterial(stage, false, true);
    this.planeMaterial = groundMaterial(ground, true);
  }

  /// Makes the meshes of a shape. An endless shape is drawn as far as `far` [m].
  make(shape: Shape, far: number): Shown | null {
    return byKind<Shown>(shape, {
      sphere: ({ radius }) => {
        const mesh = this.body(this.sphere, this.roundMaterial);
        mesh.scale.setScalar(radius);
        const caster = new Mesh(this.coarseSphere, this.casterMaterial);
        caster.scale.setScalar(radius);
        return { mesh, caster };
      },
      plane: () => {
        const mesh = new Mesh(this.disc, this.planeMaterial);
        mesh.scale.setScalar(far);
        return { mesh, caster: null };
      },
      capsule: (capsule) => {
        const lengths = axisOf(capsule).length() / capsule.radius;
        return this.own(new CapsuleGeometry(1, lengths, 12, 40), this.roundMaterial, capsule.radius);
      },
      box: ({ half: [x, y, z] }) => this.own(new BoxGeometry(2 * x, 2 * y, 2 * z), this.flatMaterial, 1),
      mesh: (body) => this.triangles(meshOf(body)),
    });
  }

  private body(geometry: BufferGeometry, material: MeshLambertMaterial): Mesh {
    const mesh = new Mesh(geometry, material);
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.customDepthMaterial = this.depthMaterial;
    return mesh;
  }

  /// A body with a geometry of its own.
  private own(geometry: BufferGeometry, material: MeshLambertMaterial, scale: number): Shown {
    const mesh = this.body(geometry, material);
    const caster = new Mesh(geometry, this.casterMaterial);
    for (const each of [mesh, caster]) each.scale.setScalar(scale);
    return { mesh, caster, dispose: () => geometry.dispose() };
  }

  /// A body of triangles, whose geometry lives as long as it is shown: a slider makes the shapes anew at every move.
  private triangles(mesh: InlineMesh): Shown {
    const kept = this.geometries.get(mesh) ?? { geometry: triangleGeometry(mesh), shown: 0 };
    this.geometries.set(mesh, kept);
    kept.shown++;
    const made = this.own(kept.geometry, this.meshMaterial, 1);
    return {
      ...made,
      dispose: () => {
        if (--kept.shown > 0) return;
        this.geometries.delete(mesh);
        kept.geometry.dispose();
      },
    };
  }

  /// Objects with the materials of every body and of its shadow: see ClothView.samples.
  samples(): { shown: Object3D[]; cast: Object3D[] } {
    return {
      shown: [this.roundMaterial, this.flatMaterial, this.meshMaterial].map(
        (material) => new Mesh(this.sphere, material),
      ),
      cast: [new Mesh(this.coarseSphere, this.casterMaterial)],
    };
  }
}
