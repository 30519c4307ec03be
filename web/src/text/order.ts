// The keys of a scene in the order in which people write them; the server keeps them in that of the alphabet.
import { isObject } from "../link/json_patch";

const keys = `version name gravity cloths colliders self_collision wind air_drag solver
  mesh grid columns rows width height file obj node mend pattern pattern_scale vertices triangles
  sphere plane capsule box point normal a b center half radius at place transform translate rotate scale
  mass per_vertex area_density material model fabric structural warp weft twist poisson shear bend bending damping grain
  strain_limit pins weights start scatter size seed dress kind thickness friction restitution
  motion oscillate linear spin axis amplitude frequency degrees_per_second velocity gust gust_frequency drag lift
  color texture method dt iterations tolerance keys of ease`.split(/\s+/);
const rank = new Map(keys.map((key, i) => [key, i]));

/// The same value, its keys in that order; keys that no scene has come last.
export function ordered<T>(value: T): T {
  if (Array.isArray(value)) return value.map(ordered) as T;
  if (!isObject(value)) return value;
  const place = ([key]: [string, unknown]): number => rank.get(key) ?? keys.length;
  const entries = Object.entries(value).sort((one, other) => place(one) - place(other));
  return Object.fromEntries(entries.map(([key, each]) => [key, ordered(each)])) as T;
}
