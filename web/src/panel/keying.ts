// "Key this value": sets a keyframe of what a field shows, at the time that the picture shows. What can be keyed is the
// server's to say (server/scene/keyable.cpp): these are its places that have sliders.
import type { Field } from "./field";
import { valueAt } from "../link/json_patch";
import type { Key, Operation, SceneDocument, Vec3 } from "../link/scene_types";

const vectors = /^(\/gravity|\/wind\/velocity)\/[0-2]$/;
const numbers = [
  /^\/air_drag$/,
  /^\/wind\/(gust|gust_frequency|drag|lift)$/,
  /^\/self_collision\/friction$/,
  /^\/colliders\/\d+\/(friction|restitution)$/,
  /^\/cloths\/\d+\/material\/(damping|warp|weft)$/,
];
/// 0 has no elements, and cannot be keyed.
const stiffnesses = /^\/cloths\/\d+\/material\/(structural|shear|bend|bending)$/;

/// The value that a key of a field is of, as a JSON Pointer; null: the field has none.
export function keyedPlace(field: Field, document: SceneDocument): string | null {
  const [path, ...others] = field.paths;
  if (field.kind !== "number" || path === undefined || others.length > 0) return null;
  const [, vector] = path.match(vectors) ?? [];
  if (vector !== undefined) return vector;
  if (numbers.some((place) => place.test(path))) return path;
  return stiffnesses.test(path) && Number(valueAt(document, path)) > 0 ? path : null;
}

export const keyOf = (place: string, document: SceneDocument): Key | undefined =>
  document.keys.find(({ of }) => of === place);

/// Sets the value that the document has at `place` as a keyframe at `time` [s].
export function keyOperations(place: string, document: SceneDocument, time: number): Operation[] {
  const at = Number(time.toFixed(6)); // float32 frames and steps' times end in digits that nobody wrote
  const value = valueAt(document, place) as number | Vec3;
  const { at: before = [], ease = "linear" } = keyOf(place, document) ?? {};
  const others = before.filter(([when]) => Math.abs(when - at) > 1e-9);
  const key: Key = { of: place, at: [...others, [at, value] as Key["at"][number]].sort((a, b) => a[0] - b[0]), ease };
  const rest = document.keys.filter(({ of }) => of !== place);
  return [{ op: "replace", path: "/keys", value: [...rest, key] }];
}
