// Applies accepted patches to the page's copy of the document: RFC 7396 (object) and RFC 6902 (array).
import type { Operation, Patch } from "./scene_types";

type Node = Record<string, unknown> | unknown[];

export const isObject = (value: unknown): value is Record<string, unknown> =>
  typeof value === "object" && value !== null && !Array.isArray(value);

/// The keys of a JSON Pointer.
export function keysOf(pointer: string): string[] {
  if (pointer === "") return [];
  if (!pointer.startsWith("/")) throw new Error(`not a JSON Pointer: ${pointer}`);
  return pointer
    .slice(1)
    .split("/")
    .map((key) => key.replaceAll("~1", "/").replaceAll("~0", "~"));
}

function child(node: unknown, key: string): unknown {
  if (Array.isArray(node)) return node[Number(key)];
  if (isObject(node) && Object.hasOwn(node, key)) return node[key];
  return undefined;
}

/// The value at a JSON Pointer; undefined if there is none.
export function valueAt(document: unknown, pointer: string): unknown {
  return keysOf(pointer).reduce(child, document);
}

function mergePatch(target: unknown, patch: unknown): unknown {
  if (!isObject(patch)) return patch;
  const merged: Record<string, unknown> = isObject(target) ? { ...target } : {};
  for (const [key, value] of Object.entries(patch)) {
    if (value === null) delete merged[key];
    else merged[key] = mergePatch(merged[key], value);
  }
  return merged;
}

function insert(parent: Node, key: string, value: unknown): void {
  if (Array.isArray(parent)) parent.splice(key === "-" ? parent.length : Number(key), 0, value);
  else parent[key] = value;
}

function remove(parent: Node, key: string): void {
  if (Array.isArray(parent)) parent.splice(Number(key), 1);
  else delete parent[key];
}

function operate(root: { document: unknown }, operation: Operation): void {
  const locate = (pointer: string): [Node, string] => {
    const keys = ["document", ...keysOf(pointer)];
    const last = keys.pop() as string;
    const parent = keys.reduce(child, root as unknown);
    if (typeof parent !== "object" || parent === null) throw new Error(`nothing at ${pointer}`);
    return [parent as Node, last];
  };
  const [parent, key] = locate(operation.path);
  switch (operation.op) {
    case "add":
      insert(parent, key, operation.value);
      break;
    case "remove":
      remove(parent, key);
      break;
    case "replace":
      if (Array.isArray(parent)) parent[Number(key)] = operation.value;
      else parent[key] = operation.value;
      break;
    case "copy":
    case "move": {
      const [source, sourceKey] = locate(operation.from ?? "");
      const value = structuredClone(child(source, sourceKey));
      if (operation.op === "move") remove(source, sourceKey);
      const [target, targetKey] = locate(operation.path);
      insert(target, targetKey, value);
      break;
    }
    case "test":
      break; // the server has tested already
  }
}

/// Returns a patched copy; `document` is not changed.
export function applyPatch<T>(document: T, patch: Patch): T {
  if (!Array.isArray(patch)) return mergePatch(document, patch) as T;
  const root = { document: structuredClone(document) as unknown };
  for (const operation of patch) operate(root, operation);
  return root.document as T;
}
