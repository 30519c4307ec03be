// Lists the numbers of a scene over which a stability map can be drawn, by name.
import type { SceneDocument } from "../link/scene_types";

export interface SceneNumber {
  path: string;
  name: string;
  value: number;
}

// The keys that no map varies: versions, the axis every map has, and numbers that are no quantity (places, directions).
const without =
  /^\/(version|solver\/|cloths\/\d+\/(mesh|transform|pins|weights|start)\/|colliders\/\d+\/(motion\b|\w+\/\w+\/\d))/;

function walk(node: unknown, path: string, names: string[], found: SceneNumber[]): void {
  if (without.test(path)) return;
  if (typeof node === "number") found.push({ path, name: names.join(" "), value: node });
  else if (Array.isArray(node))
    node.forEach((child, i) => walk(child, `${path}/${i}`, [...names, nameOf(child, i, names)], found));
  else if (typeof node === "object" && node !== null) {
    for (const [key, child] of Object.entries(node))
      walk(child, `${path}/${key}`, [...names, key.replaceAll("_", " ")], found);
  }
}

const axes = ["x", "y", "z"];

function nameOf(child: unknown, i: number, names: string[]): string {
  const own = (child as { name?: unknown } | null)?.name;
  if (typeof own === "string" && own !== "") return own;
  return typeof child === "number" && names.length > 0 ? (axes[i] ?? String(i)) : String(i + 1);
}

const plain = (name: string): string =>
  name
    .replace(/^(cloths|colliders) /, "")
    .replace(/ material /, " ")
    .replace(/ mass /, " mass ");

/// All numbers that a map can vary, without those that are 0: a map spans ratios of a number.
export function numbersOf(document: SceneDocument): SceneNumber[] {
  const found: SceneNumber[] = [];
  walk(
    {
      cloths: document.cloths,
      air_drag: document.air_drag,
      gravity: document.gravity,
      wind: document.wind,
      self_collision: document.self_collision,
      colliders: document.colliders,
    },
    "",
    [],
    found,
  );
  return found.filter(({ value }) => value > 0).map(({ path, name, value }) => ({ path, value, name: plain(name) }));
}
