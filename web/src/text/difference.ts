// What makes one document another: the operations of an RFC 6902 patch, as few and as deep as can be.
import { isObject } from "../link/json_patch";
import type { Operation } from "../link/scene_types";

const escaped = (key: string): string => key.replaceAll("~", "~0").replaceAll("/", "~1");

/// Whatever the order of keys is.
function same(a: unknown, b: unknown): boolean {
  if (Array.isArray(a)) return Array.isArray(b) && a.length === b.length && a.every((each, i) => same(each, b[i]));
  if (!isObject(a) || !isObject(b)) return a === b;
  const keys = Object.keys(a);
  return keys.length === Object.keys(b).length && keys.every((key) => Object.hasOwn(b, key) && same(a[key], b[key]));
}

export function difference(from: unknown, to: unknown, path = ""): Operation[] {
  if (same(from, to)) return [];
  if (Array.isArray(from) && Array.isArray(to)) return listDifference(from, to, path);
  if (!isObject(from) || !isObject(to)) return [{ op: "replace", path, value: to }];
  const gone = Object.keys(from).filter((key) => !Object.hasOwn(to, key));
  const come = Object.keys(to).filter((key) => !Object.hasOwn(from, key));
  // Another kind of thing, such as a box in place of a sphere: half of each is nothing.
  if (path !== "" && gone.length > 0 && gone.length === Object.keys(from).length)
    return [{ op: "replace", path, value: to }];
  return [
    ...gone.map((key): Operation => ({ op: "remove", path: `${path}/${escaped(key)}` })),
    ...Object.keys(to)
      .filter((key) => Object.hasOwn(from, key))
      .flatMap((key) => difference(from[key], to[key], `${path}/${escaped(key)}`)),
    ...come.map((key): Operation => ({ op: "add", path: `${path}/${escaped(key)}`, value: to[key] })),
  ];
}

const isScalar = (value: unknown): boolean => typeof value !== "object" || value === null;

function listDifference(from: unknown[], to: unknown[], path: string): Operation[] {
  // Coordinates change as one.
  if ([...from, ...to].every(isScalar)) return [{ op: "replace", path, value: to }];
  const common = Math.min(from.length, to.length);
  // One element taken out or put in between: the others are as they were.
  let start = 0;
  while (start < common && same(from[start], to[start])) start++;
  let end = 0;
  while (end < common - start && same(from.at(-1 - end), to.at(-1 - end))) end++;
  const gone = from.slice(start, from.length - end);
  const come = to.slice(start, to.length - end);
  const both = Math.min(gone.length, come.length);
  const at = (index: number): string => `${path}/${index}`;
  return [
    ...gone.slice(0, both).flatMap((each, i) => difference(each, come[i], at(start + i))),
    ...gone.slice(both).map((): Operation => ({ op: "remove", path: at(start + both) })),
    ...come.slice(both).map((value, i): Operation => ({ op: "add", path: at(start + both + i), value })),
  ];
}
