// What the lab's settings replace in the scene, in words.
import { valueAt } from "../link/json_patch";
import { methodText } from "../panel/methods";
import type { Patch } from "../link/scene_types";

type Tree = Record<string, unknown>;

const isTree = (value: unknown): value is Tree => typeof value === "object" && value !== null && !Array.isArray(value);

const written = (value: unknown): string =>
  typeof value === "number" ? String(Number(value.toPrecision(4))) : String(value).replaceAll("_", " ");

/// The plain values of `document` that `patch` replaces, in words: "method was symplectic euler, dt was 0.001".
export function formerly(document: unknown, patch: Patch): string {
  const places = Array.isArray(patch) ? patch.map(({ path, value }) => ({ path, value })) : leaves(patch, "");
  const changed = places.filter(({ path, value }) => valueAt(document, path) !== value && !isContainer(value));
  return changed
    .map(({ path }) => {
      const before = valueAt(document, path);
      const key = path.split("/").at(-1);
      return isContainer(before)
        ? ""
        : `${key} was ${key === "method" ? methodText(String(before)).name : written(before)}`;
    })
    .filter((part) => part !== "")
    .join(", ");
}

const isContainer = (value: unknown): boolean => typeof value === "object" && value !== null;

function leaves(patch: Tree, path: string): { path: string; value: unknown }[] {
  return Object.entries(patch).flatMap(([key, value]) =>
    isTree(value) ? leaves(value, `${path}/${key}`) : [{ path: `${path}/${key}`, value }],
  );
}
