// What handles can hold: a body or a cloth of the document, with its pose and the edits that give it another.
import type { Vector3 } from "three";
import { clothPose, moved, movedCloth, type Pose, poseOf } from "./poses";
import type { Operation, SceneDocument } from "../link/scene_types";

export type Mode = "translate" | "rotate" | "scale";

/// A body or a cloth by its number. `middle`: of a cloth, the point of its mesh where the handles are.
export type Choice = { of: "body"; index: number } | { of: "cloth"; index: number; middle: Vector3 };

export interface Handled {
  name: string;
  pose: Pose;
  modes: Mode[];
  moves: boolean; ///< by a motion of its own: it has no handles
  whole: boolean; ///< it is put in place when a drag ends, as that starts the cloth anew
  edits(to: Pose): Operation[];
}

/// Null: the document has no such thing any more, or it is a plane.
export function handled({ colliders, cloths }: SceneDocument, choice: Choice): Handled | null {
  if (choice.of === "cloth") {
    const cloth = cloths[choice.index];
    if (!cloth) return null;
    const { index, middle } = choice;
    return {
      name: cloth.name,
      pose: clothPose(cloth, middle),
      modes: ["translate", "rotate", "scale"],
      moves: false,
      whole: true,
      edits: (to) => changed(cloth, movedCloth(cloth, index, middle, to)),
    };
  }
  const body = colliders[choice.index];
  const pose = body && poseOf(body);
  if (!pose) return null;
  const mesh = "mesh" in body;
  return {
    name: body.name,
    pose,
    modes: "sphere" in body ? ["translate"] : mesh ? ["translate", "rotate", "scale"] : ["translate", "rotate"],
    moves: body.motion !== null,
    whole: mesh,
    edits: (to) => changed(body, moved(body, choice.index, to)),
  };
}

/// Those that change something: a drag that only moves must not set angles.
const changed = (of: object, operations: Operation[]): Operation[] =>
  operations.filter(({ path, value }) => !same(of, path, value));

function same(of: object, path: string, value: unknown): boolean {
  const now = path
    .split("/")
    .slice(3)
    .reduce<unknown>((within, key) => (within as Record<string, unknown> | undefined)?.[key], of);
  if (typeof value === "number") return Math.abs(Number(now) / value - 1) < 1e-5;
  if (!Array.isArray(now) || !Array.isArray(value)) return false;
  return now.every((each, k) => Math.abs(Number(each) - Number(value[k])) < 1e-4);
}
