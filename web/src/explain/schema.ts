// Looks a place of the scene up in its schema (server/scene/scene.schema.json): what it means, its unit, its range, its
// default; and completes a preset's file by the defaults, as the server does.
import { isObject, keysOf } from "../link/json_patch";
import type { SceneDocument } from "../link/scene_types";

/// The part of JSON Schema that the scene's uses.
export interface Schema {
  $ref?: string;
  $defs?: Record<string, Schema>;
  type?: string | string[];
  description?: string;
  default?: unknown;
  const?: unknown;
  enum?: unknown[];
  minimum?: number;
  maximum?: number;
  properties?: Record<string, Schema>;
  required?: string[];
  dependentRequired?: Record<string, string[]>; ///< keys that a key stands beside only
  items?: Schema;
  oneOf?: Schema[];
}

/// What the schema says about one place.
export interface Words {
  says: string; ///< sentences; "" if there are none
  unit: string; ///< "" if it has none
  least?: number;
  most?: number;
  choices?: unknown[];
  initial?: unknown; ///< the default; undefined if the place has none
}

const copy = <T>(value: T): T => structuredClone(value);

/// A schema without `$ref`: the definition, completed by the place that refers to it.
function resolved(root: Schema, part: Schema): Schema {
  if (!part.$ref) return part;
  const found = resolved(root, root.$defs?.[part.$ref.split("/").at(-1) ?? ""] ?? {});
  return {
    ...found,
    ...part,
    $ref: undefined,
    ...(part.properties && { properties: { ...found.properties, ...part.properties } }),
  };
}

/// True if the value has the keys and the constants that a branch of `oneOf` asks for.
function suits(branch: Schema, value: unknown, key?: string): boolean {
  if (!branch.properties) return branch.type === "null" ? value === null : !isObject(value) && key === undefined;
  if (!isObject(value)) return false;
  const own = branch.properties;
  if (key !== undefined && !Object.hasOwn(own, key)) return false;
  return Object.entries(value).every(
    ([name, is]) => Object.hasOwn(own, name) && (own[name]?.const === undefined || own[name]?.const === is),
  );
}

/// The branch of `oneOf` that a value is of; the schema itself if it has no branches.
function branchOf(root: Schema, part: Schema, value: unknown, key?: string): Schema {
  const whole = resolved(root, part);
  if (!whole.oneOf || whole.properties) return whole;
  const named = isObject(value) && "fabric" in value && !("model" in value) ? { ...value, model: "fem" } : value;
  const branch = whole.oneOf.map((each) => resolved(root, each)).find((each) => suits(each, named, key));
  return branch ? { description: whole.description, default: whole.default, ...branch } : whole;
}

/// What the schema says about the place `path` (JSON Pointer) of a document; null if it knows no such place.
export function wordsFor(root: Schema, document: unknown, path: string): Words | null {
  let part: Schema | undefined = root;
  let value: unknown = document;
  let around: Schema | null = null; // the list that an element is of
  let index = 0;
  for (const key of keysOf(path)) {
    const branch: Schema = branchOf(root, part, value, Array.isArray(value) ? undefined : key);
    around = branch.items ? branch : null;
    index = Number(key);
    part = branch.items ?? branch.properties?.[key];
    if (!part) return null;
    part = resolved(root, part);
    value = Array.isArray(value) ? value[index] : isObject(value) ? value[key] : undefined;
  }
  const whole: Schema = part;
  part = branchOf(root, part, value);
  const description = whole.description ?? part.description ?? around?.description ?? "";
  const list = around?.default;
  const ranged =
    part.minimum === undefined ? (whole.oneOf?.find(({ minimum }) => minimum !== undefined) ?? part) : part;
  return {
    says: description.replace(/^\[[^\]]*\]$/, ""),
    unit: /\[([^\]]+)\]/.exec(description)?.[1] ?? "",
    least: ranged.minimum,
    most: ranged.maximum,
    choices: part.enum,
    initial: Array.isArray(list) ? list[index] : (whole.default ?? part.default),
  };
}

function filled(root: Schema, part: Schema, value: unknown): unknown {
  const whole = branchOf(root, part, value);
  if (Array.isArray(value)) return value.map((each) => filled(root, whole.items ?? {}, each));
  if (!isObject(value)) return value;
  const made: Record<string, unknown> = { ...value };
  const fabric = "fabric" in value;
  for (const [key, inner] of Object.entries(whole.properties ?? {})) {
    const initial = resolved(root, inner).default;
    // numbers that are absent beside a fabric are the fabric's own
    const left = fabric && key !== "strain_limit" && key !== "grain";
    const beside = whole.dependentRequired?.[key] ?? [];
    const apart = !beside.every((other) => other in value); // a sphere has no transform
    if (made[key] === undefined && initial !== undefined && !left && !apart) made[key] = copy(initial);
    if (made[key] !== undefined) made[key] = filled(root, inner, made[key]);
  }
  return made;
}

/// A preset's file with the defaults that the server fills in.
export function completed(root: Schema, preset: SceneDocument): SceneDocument {
  const made = filled(root, root, preset) as SceneDocument;
  for (const [i, cloth] of made.cloths.entries())
    if (cloth.material.fabric && !("mass" in (preset.cloths[i] ?? {}))) delete (cloth as Partial<typeof cloth>).mass;
  return made;
}
