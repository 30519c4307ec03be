// A place for something new in a scene that nothing there takes.
import type { SceneDocument, Vec3 } from "./scene_types";

/// What something takes of the scene, along the axes [m].
export interface Box {
  low: Vec3;
  high: Vec3;
}

const gap = 0.03; // that stays free around it [m]
const spacing = 0.1; // of the places that are tried [m]
const farthest = 15; // of them along an axis, either way

type Plane = { point: Vec3; normal: Vec3 };

const axes = [0, 1, 2] as const;
const sum = (of: (axis: 0 | 1 | 2) => number): number => axes.reduce((total: number, axis) => total + of(axis), 0);

const meets = (place: Vec3, half: Vec3, { low, high }: Box): boolean =>
  axes.every((axis) => {
    const reach = half[axis] + gap;
    return place[axis] + reach > low[axis] && place[axis] - reach < high[axis];
  });

const behind = (place: Vec3, half: Vec3, { point, normal }: Plane): boolean =>
  sum((axis) => normal[axis] * (place[axis] - point[axis])) <
  sum((axis) => Math.abs(normal[axis]) * half[axis]) + gap * Math.hypot(...normal);

/// All places that are tried, as steps from the wished one, the nearest first.
function tried(): Vec3[] {
  const line = Array.from({ length: 2 * farthest + 1 }, (_, i) => i - farthest);
  const all = line.flatMap((x) => line.flatMap((y) => line.map((z): Vec3 => [x, y, z])));
  const away = ([x, y, z]: Vec3): number => x * x + y * y + z * z;
  return all.sort((one, other) => away(one) - away(other));
}

/// The place nearest to the `wished` one where what is `half` as large along each axis meets nothing that is taken and
/// is in front of all planes; above everything where there is none near.
export function freePlace(wished: Vec3, half: Vec3, taken: Box[], { colliders }: SceneDocument): Vec3 {
  const planes = colliders.flatMap((each): Plane[] => ("plane" in each ? [each.plane] : []));
  for (const steps of tried()) {
    const place = axes.map((axis) => Number((wished[axis] + spacing * steps[axis]).toFixed(3))) as Vec3;
    if (!taken.some((box) => meets(place, half, box)) && !planes.some((plane) => behind(place, half, plane)))
      return place;
  }
  const top = Math.max(...taken.map(({ high }) => high[1]));
  return [wished[0], Number((top + half[1] + 2 * gap).toFixed(3)), wished[2]];
}
