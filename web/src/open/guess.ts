// What a file does not say, guessed from what it holds: its unit, which way is up, cloth or body, where it hangs.
import type { Part } from "../link/mesh_upload";
import type { Vec3 } from "../link/scene_types";

export type Role = "cloth" | "body" | "none";
export type Up = "x" | "y" | "z";

export interface Unit {
  key: string;
  name: string;
  factor: number; ///< metres of one
}
export const units: Unit[] = [
  { key: "m", name: "metres", factor: 1 },
  { key: "cm", name: "centimetres", factor: 0.01 },
  { key: "mm", name: "millimetres", factor: 0.001 },
  { key: "in", name: "inches", factor: 0.0254 },
];
const axes = { x: 0, y: 1, z: 2 };

export type Box = [Vec3, Vec3];
const three = (of: (axis: number) => number): Vec3 => [of(0), of(1), of(2)];
const low = (box: Box, axis: number): number => box[0][axis] as number;
const high = (box: Box, axis: number): number => box[1][axis] as number;
const sides = (box: Box): Vec3 => three((axis) => high(box, axis) - low(box, axis));

/// The box around all of these.
export const around = (boxes: Box[]): Box => [
  three((axis) => Math.min(...boxes.map((box) => low(box, axis)))),
  three((axis) => Math.max(...boxes.map((box) => high(box, axis)))),
];

/// As scene::unit_factor guesses: metres from 5 cm to 10 m, else the unit that makes it 0.2 to 5 m large.
export function guessUnit(box: Box): Unit {
  const size = Math.max(...sides(box));
  const fits = (from: number, to: number) => (unit: Unit) => size * unit.factor >= from && size * unit.factor <= to;
  const [metres] = units as [Unit];
  return fits(0.05, 10)(metres) ? metres : (units.find(fits(0.2, 5)) ?? metres);
}

/// glTF says that y is up. Else z is, if it lies flat about y, or if it is far longer along z than along y.
export function guessUp(box: Box, file: string): Up {
  const [x, y, z] = sides(box);
  if (/\.(glb|gltf)$/i.test(file)) return "y";
  return (y < 0.05 * Math.max(x, z) && z > y) || (z > 1.5 * y && z >= x) ? "z" : "y";
}

/// The turn that brings `up` upright [degrees].
export const turnOf = (up: Up): Vec3 => ({ x: [0, 0, 90], y: [0, 0, 0], z: [-90, 0, 0] })[up] as Vec3;

/// The box as it lies in the scene, in the file's unit.
export const turned = ([from, to]: Box, up: Up): Box =>
  ({
    x: [
      [-to[1], from[0], from[2]],
      [-from[1], to[0], to[2]],
    ],
    y: [from, to],
    z: [
      [from[0], from[2], -to[1]],
      [to[0], to[2], -from[1]],
    ],
  })[up] as Box;

const bodies = /body|figure|avatar|torso|mannequin|dummy|human|person|skin|chair|table|floor/i;
const clothes = /cloth|shirt|dress|skirt|trouser|pants|jacket|coat|hood|sleeve|garment|fabric|scarf|cape|curtain/i;

/// By its name, else by its openings: cloth has some, a body is closed.
export function guessRole({ no_cloth, borders, node }: Part, file: string): Role {
  if (no_cloth !== null) return "body";
  for (const name of [node, file])
    if (name !== undefined && bodies.test(name) !== clothes.test(name)) return bodies.test(name) ? "body" : "cloth";
  return borders.length === 0 ? "body" : "cloth";
}

/// Where a cloth can be held.
export interface Hold {
  name: string; ///< "waist"
  vertices: number[]; ///< as pins count them
}

/// The highest openings, and the highest 3 %; of what lies flat its outline. The first is the likeliest.
export function holds({ borders, box, ends }: Part, up: Up): Hold[] {
  const axis = axes[up];
  const height = sides(box)[axis] as number;
  const outline = borders[0]?.vertices ?? [];
  if (height < 0.05 * Math.max(...sides(box)))
    return outline.length > 0 ? [{ name: "outline", vertices: outline }] : [];
  const top: Hold = { name: borders.length > 2 ? "shoulders" : "top", vertices: ends[axis] as number[] };
  const raised = ({ middle }: { middle: Vec3 }): number => ((middle[axis] as number) - low(box, axis)) / height;
  const [highest] = [...borders].sort((one, other) => raised(other) - raised(one));
  if (!highest || borders.length < 2 || raised(highest) < 0.5) return [top];
  return [{ name: borders.length === 2 ? "waist" : "neck", vertices: highest.vertices }, top];
}

/// Makes the flat pattern as large as the mesh is: a power of ten if the pattern is in another unit, else as areas say.
export function patternScale({ area, pattern_area }: Part): number {
  const factor = Math.sqrt(area / pattern_area);
  const unit = [1, 1000, 100, 10, 0.1, 0.01, 0.001].find((each) => factor / each < 1.3 && factor / each > 1 / 1.3);
  return unit ?? Number(factor.toPrecision(3));
}

/// As `clothlab validate --fit` has it: a tenth of an edge, from 0.1 to 3 mm [m].
export const thicknessFor = (edge: number): number => Number(Math.min(Math.max(0.1 * edge, 1e-4), 3e-3).toPrecision(2));

const digits = (metres: number): string =>
  metres >= 1 ? `${metres.toPrecision(2)} m` : `${Number((100 * metres).toPrecision(2))} cm`;

/// "1.7 m tall, 48 cm wide, 26 cm deep": of a box in metres.
export function sizeText(box: Box): string {
  const [wide, tall, deep] = sides(box).map(digits);
  return `${tall} tall, ${wide} wide, ${deep} deep`;
}
