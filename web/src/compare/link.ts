// A comparison in a link: what it asks for, packed like a scene, after `#compare=`, or after a scene's `&compare=`.
import { type Wish, standard } from "./host";
import { isObject } from "../link/json_patch";
import type { Patch, SceneDocument } from "../link/scene_types";
import { fragmentOf, packed, unpacked } from "../text/share";

const key = "#compare=";

/// The part of a link from # on, which carries the scene, too.
export const linkOf = async (scene: SceneDocument, wish: Wish): Promise<string> =>
  `${await fragmentOf(scene)}&${key.slice(1)}${await packed(wish)}`;

/// The comparison in a link. Throws an Error that says in words why there is none.
export async function wishIn(fragment: string, mostBytes: number): Promise<Wish> {
  const value = await unpacked(fragment.slice(key.length), mostBytes);
  if (!isObject(value) || !(Array.isArray(value.patch) || isObject(value.patch)))
    throw new Error("The link carries no comparison: it has no patch.");
  return {
    patch: value.patch as Patch,
    truth: value.truth === true,
    time: typeof value.time === "number" ? value.time : standard.time,
    view: value.view === "ghost" ? "ghost" : "side",
  };
}
