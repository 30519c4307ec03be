// The scene document (server/scene/README.md): the parts that the page shows. The server fills in every default but the
// numbers that a cloth leaves to a fabric: `fabrics.ts` does.

export type Vec3 = [number, number, number];

export interface Oscillate {
  axis: Vec3;
  amplitude: number;
  frequency: number;
}
export interface Linear {
  velocity: Vec3;
}
export interface Spin {
  axis: Vec3;
  center: Vec3;
  degrees_per_second: number;
}
export type Motion = null | { oscillate: Oscillate } | { linear: Linear } | { spin: Spin };

export interface Grid {
  columns: number;
  rows: number;
  width: number;
  height: number;
}
/// A flat piece by its outline, [x, z] [m].
export interface Panel {
  outline: [number, number][];
  holes: [number, number][][];
  edge: number; ///< length of a mesh's edge [m]
  edges: Record<string, [number, number]>;
}
export interface InlineMesh {
  vertices: Vec3[];
  triangles: Vec3[];
}
/// A file, or a mesh that was uploaded.
export type NamedMesh = ({ file: string } | { obj: string }) & {
  node?: null | string;
  mend?: boolean;
  pattern?: null | "uv";
  pattern_scale?: number;
};
export type Mesh = { grid: Grid } | { panel: Panel } | InlineMesh | NamedMesh;

export type At = string | { box: [Vec3, Vec3] };
export interface Pin {
  at: At;
  place?: Vec3; ///< instead of the rest place [m]
  motion: Motion;
}
export interface Weight {
  at: At;
  mass: number;
}
export type Start = null | { scatter: { size: number; seed: number } } | { scale: Vec3 } | { dress: number };

export interface Springs {
  model: "springs";
  fabric?: string;
  structural: number;
  shear: number;
  bend: number;
  damping: number;
  strain_limit: number | null;
}
export interface Fem {
  model: "fem";
  fabric?: string;
  warp: number;
  weft: number;
  poisson: number;
  shear: number;
  bending: number | { warp: number; weft: number; twist: number | null };
  damping: number;
  grain: number;
  strain_limit: number | { warp: number; weft: number } | null;
}

export type Material = Springs | Fem;

/// Scales, rotates about x, then y, then z, then translates.
export interface Transform {
  translate: Vec3; ///< [m]
  rotate: Vec3; ///< [degrees]
  scale: number;
}

export interface Cloth {
  name: string;
  mesh: Mesh;
  transform: Transform;
  mass: { per_vertex: number } | { area_density: number };
  material: Material;
  pins: Pin[];
  weights: Weight[];
  start: Start;
  color: string;
  texture: string;
}

export interface Sphere {
  center: Vec3;
  radius: number;
}
export interface Plane {
  point: Vec3;
  normal: Vec3;
}
export interface Capsule {
  a: Vec3;
  b: Vec3;
  radius: number;
}
export interface Box {
  center: Vec3;
  half: Vec3;
  rotate: Vec3; ///< [degrees]
}
/// A rigid body of triangles. Where the document names a file, bodies.ts puts its triangles in.
export interface Body {
  mesh: InlineMesh | NamedMesh;
  transform: Transform;
}
/// The kinds of solid, under their names in the document.
export interface Solids {
  sphere: Sphere;
  plane: Plane;
  capsule: Capsule;
  box: Box;
}
type Kind = keyof Solids;
/// One shape: a solid under the name of its kind, or a body.
export type Shape = { [K in Kind]: { [Name in K]: Solids[K] } }[Kind] | Body;

type SolidCases<T> = { [K in Kind]: (of: Solids[K]) => T };
type Cases<T> = SolidCases<T> & { mesh: (of: Body) => T };

/// Calls the function of `cases` for the shape's kind; null for a kind that this page does not know. A missing kind
/// does not compile.
export function byKind<T>(shape: Shape, cases: Cases<T>): T | null {
  if ("mesh" in shape) return cases.mesh(shape);
  const solids: SolidCases<T> = cases;
  const made = <K extends Kind>(kind: K): T | null => {
    const of = (shape as Partial<Solids>)[kind];
    return of === undefined ? null : solids[kind](of);
  };
  const kind = (Object.keys(cases) as Kind[]).find((each) => each in shape);
  return kind === undefined ? null : made(kind);
}

export type Collider = Shape & {
  name: string;
  friction: number;
  restitution: number;
  motion: Motion;
};

/// Where a moving collider is at the time of a frame: of a solid its shape, of a body its transform. `index`: its place
/// in the document's list.
export type MovedCollider = (Exclude<Shape, Body> | Pick<Body, "transform">) & { index: number };

export interface Wind {
  velocity: Vec3;
  gust: number;
  gust_frequency: number;
  drag: number;
  lift: number;
}

/// A value of the scene by times [s]; `of` is its JSON Pointer.
export interface Key {
  of: string;
  at: [number, number | boolean | Vec3][];
  ease: "linear" | "smooth" | "step";
}

export interface SceneDocument {
  version: number;
  name: string;
  gravity: Vec3;
  cloths: Cloth[];
  colliders: Collider[];
  self_collision: null | { thickness: number; friction: number; kind: "points" | "surface" };
  wind: null | Wind;
  air_drag: number;
  solver: { method: string; dt: number; iterations: number; tolerance: number };
  keys: Key[];
}

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };

/// One operation of an RFC 6902 patch.
export interface Operation {
  op: "add" | "remove" | "replace" | "move" | "copy" | "test";
  path: string;
  from?: string;
  value?: unknown;
}

/// A patch: an array is RFC 6902, an object an RFC 7396 merge patch.
export type Patch = Operation[] | { [key: string]: unknown };
