// The change of the scene that puts opened files into it, by what was answered of them.
import { thicknessFor, turned, turnOf, around, type Box, type Role, type Up } from "./guess";
import type { Part } from "../link/mesh_upload";
import type { Operation, Patch, SceneDocument, Transform, Vec3 } from "../link/scene_types";

export interface Item {
  file: string; ///< the name of the upload
  part: Part;
  role: Role;
  fabric: string;
  pattern: number | null; ///< the scale of its flat pattern; null: the file's shape is at rest
  held: number[]; ///< vertices
}
export interface Answers {
  items: Item[];
  factor: number; ///< metres of the files' unit
  up: Up;
  fresh: boolean; ///< the scene before goes
  edge: number | null; ///< least mean edge of what was opened into this scene before [m]
}

/// What does not hold the cloth where its file has it, and so stands elsewhere.
export interface Aside {
  move: Vec3; ///< of each cloth [m]
  points: boolean; ///< vertices keep apart, and not surfaces: cloth goes through cloth
}

const friction = 0.3; // cotton on skin or cotton: 0.2 to 0.5, as validate --fit has it
const colors = ["#b03a2e", "#2e6f95", "#4d7c4a", "#8a5a9e", "#b5792a"];

const rounded = (value: number): number => Number(value.toFixed(5)) || 0;

/// Everything of that role, in the scene [m].
export function extent({ items, factor, up }: Answers, role?: Role): Box | null {
  const boxes = items.filter((item) => (role ? item.role === role : item.role !== "none"));
  if (boxes.length === 0) return null;
  const box = around(boxes.map(({ part }) => turned(part.box, up)));
  return box.map((corner) => corner.map((value) => value * factor)) as Box;
}

/// Where the cloths stand beside all bodies: as far along x as both are wide, and a tenth more.
export function beside(answers: Answers): Vec3 {
  const [cloth, body] = [extent(answers, "cloth"), extent(answers, "body")];
  return cloth && body ? [rounded(body[1][0] - cloth[0][0] + 0.1 * (body[1][0] - body[0][0])), 0, 0] : [0, 0, 0];
}

function namesOf({ items }: Answers, taken: string[]): string[] {
  const names = new Set(taken);
  return items.map(({ file, part }) => {
    const stem = (part.node ?? file.replace(/\.[^.]*$/, "")).slice(0, 60) || "mesh";
    let name = stem;
    for (let number = 2; names.has(name); ++number) name = `${stem}-${number}`;
    names.add(name);
    return name;
  });
}

type Made = Record<string, unknown>;

function made(answers: Answers, aside: Aside, taken: string[], first: number): { cloths: Made[]; colliders: Made[] } {
  const names = namesOf(answers, taken);
  const cloths: Made[] = [];
  const colliders: Made[] = [];
  answers.items.forEach(({ file, part, role, fabric, pattern, held }, i) => {
    const mesh = { file, ...(part.node === undefined ? {} : { node: part.node }) };
    const transform: Transform = { translate: [0, 0, 0], rotate: turnOf(answers.up), scale: answers.factor };
    const name = names[i];
    if (role === "body") colliders.push({ name, mesh, transform, friction });
    if (role !== "cloth") return;
    cloths.push({
      name,
      mesh: { ...mesh, ...(pattern === null ? {} : { pattern: "uv", pattern_scale: pattern }) },
      transform: { ...transform, translate: aside.move },
      material: { fabric },
      color: colors[(first + cloths.length) % colors.length],
      pins: held.map((vertex) => ({ at: `vertex:${vertex}` })),
    });
  });
  return { cloths, colliders };
}

/// The distance that surfaces keep [m], and the mean edge that it is for.
export function contact({ items, factor, edge: before }: Answers): { thickness: number; edge: number } | null {
  const edges = items.filter(({ role }) => role === "cloth").map(({ part }) => part.mean_edge * factor);
  if (before !== null) edges.push(before);
  if (edges.length === 0) return null;
  const edge = Math.min(...edges);
  return { thickness: thicknessFor(edge), edge };
}

/// The thickness of contact in the scene that comes [m]; null: what was opened touches nothing.
export function thicknessIn(answers: Answers, stored: SceneDocument): number | null {
  const fits = contact(answers);
  const has = (of: Role): number => answers.items.filter(({ role }) => role === of).length;
  const [cloths, colliders] = answers.fresh ? [0, 0] : [stored.cloths.length, stored.colliders.length];
  if (!fits || (has("body") + colliders === 0 && has("cloth") + cloths < 2)) return null;
  return Math.min(fits.thickness, (!answers.fresh && stored.self_collision?.thickness) || Infinity);
}

/// Nothing carries the cloth: it would fall away.
export const falls = ({ items }: Answers, stored: SceneDocument | null, fresh: boolean): boolean =>
  items.some(({ role, held }) => role === "cloth" && held.length === 0) &&
  !items.some(({ role }) => role === "body") &&
  (fresh || stored === null || stored.colliders.length === 0);

/// The patch. Keys of the scene before that a fresh one does not have go, so that their defaults hold. A fresh scene
/// has the name of the first file, which is not to be taken for a preset's.
export function patchFor(answers: Answers, stored: SceneDocument, aside: Aside, presets: string[]): Patch {
  const { fresh, items } = answers;
  const before = fresh ? { cloths: [], colliders: [], self_collision: null } : stored;
  const names = [...before.cloths, ...before.colliders].map(({ name }) => name);
  const { cloths, colliders } = made(answers, aside, names, before.cloths.length);
  const kind = aside.points ? "points" : "surface";
  const thickness = thicknessIn(answers, stored);
  const self_collision = thickness === null ? before.self_collision : { kind, thickness, friction };
  if (fresh) {
    const gone = Object.fromEntries(Object.keys(stored).map((key) => [key, null]));
    const name = String([...cloths, ...colliders][0]?.name ?? items[0]?.file);
    return {
      ...gone,
      version: 1,
      name: presets.includes(name) ? `my ${name}` : name,
      cloths,
      colliders,
      self_collision,
    };
  }
  const add = (list: "cloths" | "colliders", values: Made[]): Operation[] =>
    values.map((value, i) => ({ op: "add", path: `/${list}/${stored[list].length + i}`, value }));
  return [
    ...add("cloths", cloths),
    ...add("colliders", colliders),
    { op: "replace", path: "/self_collision", value: self_collision },
  ];
}
