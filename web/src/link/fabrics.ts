// The scene as it is shown: a cloth that names a fabric leaves numbers to it, which the server tells in `sim.status`.
import { applyPatch, valueAt } from "./json_patch";
import type { Operation, SceneDocument } from "./scene_types";

/// A fabric that a cloth may name.
export interface Fabric {
  name: string;
  feel: string; ///< in one line
  source: string; ///< of its numbers
}

/// What a cloth leaves to its fabric; null for a cloth that names none.
export type LeftToFabric = null | { material: Record<string, unknown>; mass?: unknown };

/// The document with the numbers that it leaves to fabrics.
export function withFabrics(document: SceneDocument, left: LeftToFabric[]): SceneDocument {
  if (left.every((each) => each === null)) return document;
  const cloths = document.cloths.map((cloth, i) => {
    const more = left[i];
    if (!more || !("fabric" in cloth.material)) return cloth;
    return { ...more, ...cloth, material: { ...more.material, ...cloth.material } };
  });
  return { ...document, cloths } as SceneDocument;
}

const parentOf = (path: string): string => path.slice(0, path.lastIndexOf("/"));

/// One operation on `shown`, as one on the document, which lacks what it leaves to fabrics. Null: nothing to do.
function addressedOne(document: SceneDocument, shown: SceneDocument, operation: Operation): Operation | null {
  const { op, path } = operation;
  if (valueAt(document, path) !== undefined) return operation;
  if (op === "remove") return null;
  if (op !== "replace" || valueAt(document, parentOf(path)) !== undefined) return { ...operation, op: "add" };
  const parent = { ...(valueAt(shown, parentOf(path)) as object | undefined) } as Record<string, unknown>;
  parent[path.slice(path.lastIndexOf("/") + 1)] = operation.value;
  return addressedOne(document, shown, { op: "replace", path: parentOf(path), value: parent });
}

/// Operations on the document as it is shown, as ones on the document. Each counts on those before it.
export function addressed(document: SceneDocument, shown: SceneDocument, operations: Operation[]): Operation[] {
  const result: Operation[] = [];
  let now = document;
  for (const operation of operations) {
    const made = addressedOne(now, shown, operation);
    if (!made) continue;
    result.push(made);
    if (made !== operation) now = applyPatch(now, [made]);
  }
  return result;
}
