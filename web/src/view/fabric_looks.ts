// How fabrics look: their weave at true scale, and how it takes the light. Lengths are of typical cloths of the name.
export const weaves = ["plain", "twill", "satin", "knit", "rib"] as const;
export type Weave = (typeof weaves)[number];

export interface FabricLook {
  weave: Weave;
  pitch: [number, number]; ///< from a thread to the next, across the warp and the weft; of a knit, a stitch [mm]
  relief: number; ///< slope of a thread's side
  slub: number; ///< share by which threads are unevenly dyed and thick
  slubSize: number; ///< width of uneven streaks [mm]
  roughness: number;
  specular: number; ///< of smooth threads: 1 as a dielectric of index 1.5
  anisotropy: number; ///< how far highlights are drawn out across the warp
  sheen: number; ///< light that loose fibres catch
  sheenRoughness: number;
  shines: number; ///< share of the light that comes through
  back: number; ///< 0: the back is as the front; 1: it is as pale as undyed weft, and dull
  thickness: number; ///< [mm]
}

const cotton: FabricLook = {
  weave: "plain",
  pitch: [0.4, 0.4],
  relief: 0.4,
  slub: 0.1,
  slubSize: 9,
  roughness: 0.82,
  specular: 0.45,
  anisotropy: 0,
  sheen: 0.22,
  sheenRoughness: 0.6,
  shines: 0.12,
  back: 0.12,
  thickness: 0.3,
};
const jersey: FabricLook = {
  ...cotton,
  weave: "knit",
  pitch: [1, 0.8],
  relief: 0.7,
  slub: 0.05,
  slubSize: 4,
  roughness: 0.9,
  specular: 0.3,
  sheen: 0.6,
  sheenRoughness: 0.7,
  shines: 0.08,
  thickness: 0.8,
};
const silk: FabricLook = {
  ...cotton,
  weave: "satin",
  pitch: [0.12, 0.12],
  relief: 0.25,
  slub: 0.03,
  slubSize: 8,
  roughness: 0.36,
  specular: 1,
  anisotropy: 0.62,
  sheen: 0.15,
  sheenRoughness: 0.35,
  shines: 0.2,
  back: 0.35,
  thickness: 0.2,
};

/// By the fabric's name (server/scene/fabrics.json).
export const looks: Record<string, FabricLook> = {
  cotton,
  silk,
  denim: {
    ...cotton,
    weave: "twill",
    pitch: [0.8, 0.8],
    relief: 0.75,
    slub: 0.3,
    slubSize: 7,
    roughness: 0.92,
    specular: 0.25,
    sheen: 0.25,
    shines: 0.02,
    back: 0.8,
    thickness: 0.9,
  },
  canvas: { ...cotton, pitch: [0.9, 0.9], relief: 0.7, slub: 0.12, roughness: 0.93, shines: 0.04, thickness: 0.7 },
  wool: {
    ...cotton,
    weave: "twill",
    pitch: [1.2, 1.2],
    relief: 0.4,
    slub: 0.22,
    slubSize: 3,
    roughness: 1,
    specular: 0.15,
    sheen: 1,
    sheenRoughness: 0.85,
    shines: 0.02,
    thickness: 1.6,
  },
  polyester: {
    ...silk,
    weave: "plain",
    pitch: [0.15, 0.15],
    roughness: 0.48,
    specular: 0.8,
    anisotropy: 0.25,
    back: 0.1,
  },
  interlock: jersey,
  rib: { ...jersey, weave: "rib", thickness: 1 },
  ponte: { ...jersey, pitch: [0.7, 0.6], relief: 0.45, roughness: 0.85, thickness: 1.1 },
  swimsuit: { ...jersey, pitch: [0.4, 0.35], relief: 0.3, roughness: 0.45, specular: 0.9, sheen: 0.2, thickness: 0.6 },
  ribbon: { ...silk, anisotropy: 0.5, shines: 0.1, thickness: 0.3 },
  tango: { ...jersey, pitch: [0.5, 0.45], relief: 0.4, roughness: 0.6, specular: 0.6, thickness: 0.5 },
};

/// The look of a fabric; of one that has no name, or a new one, that of cotton.
export const lookOf = (fabric: string | undefined): FabricLook => looks[fabric ?? "cotton"] ?? cotton;

/// Metres per unit of texture coordinates that mesh files have: the root of the area of the triangles at `places`
/// [vertex_count * 3] over theirs in the texture, for the vertices of one cloth. 1 where that says nothing.
export function metresPerTexture(
  places: Float32Array,
  texture: Float32Array,
  triangles: Uint32Array,
  { firstVertex, vertexCount }: { firstVertex: number; vertexCount: number },
): number {
  const at = (array: ArrayLike<number>, size: number, v: number): number[] =>
    Array.from({ length: size }, (_, i) => array[size * v + i] as number);
  let inSpace = 0;
  let inTexture = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const corners = [...triangles.subarray(t, t + 3)];
    if (corners.some((v) => v < firstVertex || v >= firstVertex + vertexCount)) continue;
    const [a, b, c] = corners as [number, number, number];
    const side = (array: ArrayLike<number>, size: number, v: number): number[] => {
      const from = at(array, size, a);
      return at(array, size, v).map((value, i) => value - (from[i] as number));
    };
    const [ux = 0, uy = 0, uz = 0] = side(places, 3, b);
    const [vx = 0, vy = 0, vz = 0] = side(places, 3, c);
    inSpace += Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
    const [pu = 0, pv = 0] = side(texture, 2, b);
    const [qu = 0, qv = 0] = side(texture, 2, c);
    inTexture += Math.abs(pu * qv - pv * qu);
  }
  const metres = Math.sqrt(inSpace / inTexture);
  return Number.isFinite(metres) && metres > 0 ? metres : 1;
}
