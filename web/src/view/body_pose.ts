// Where a body is as a place and a turn, and the edits that put it elsewhere.
import { Euler, MathUtils, Quaternion, Vector3 } from "three";
import { byKind, type Collider, type Operation, type Shape, type Vec3 } from "../link/scene_types";

export interface Pose {
  place: Vector3; ///< [m]
  turn: Quaternion;
}

const quaternionOf = (rotate: Vec3): Quaternion =>
  new Quaternion().setFromEuler(new Euler(...(rotate.map(MathUtils.degToRad) as Vec3), "ZYX")); // about x first

function anglesOf(turn: Quaternion): Vec3 {
  const { x, y, z } = new Euler().setFromQuaternion(turn, "ZYX");
  return [x, y, z].map((angle) => Number(MathUtils.radToDeg(angle).toFixed(3))) as Vec3;
}

const rounded = (place: Vector3): Vec3 => place.toArray().map((value) => Number(value.toFixed(5))) as Vec3;
const middle = (a: Vec3, b: Vec3): Vector3 => new Vector3(...a).add(new Vector3(...b)).multiplyScalar(0.5);
const upright = (): Quaternion => new Quaternion();

/// The pose of a body at home; null of a plane.
export const poseOf = (shape: Shape): Pose | null =>
  byKind<Pose | null>(shape, {
    sphere: ({ center }) => ({ place: new Vector3(...center), turn: upright() }),
    plane: () => null,
    capsule: ({ a, b }) => ({
      place: middle(a, b),
      turn: upright().setFromUnitVectors(new Vector3(0, 1, 0), new Vector3(...b).sub(new Vector3(...a)).normalize()),
    }),
    box: ({ center, rotate }) => ({ place: new Vector3(...center), turn: quaternionOf(rotate) }),
    mesh: ({ transform }) => ({ place: new Vector3(...transform.translate), turn: quaternionOf(transform.rotate) }),
  });

/// The operations that put collider number `index` at `to`.
export function moved(collider: Collider, index: number, { place, turn }: Pose): Operation[] {
  const at = `/colliders/${index}`;
  const put = (values: Record<string, Vec3>): Operation[] =>
    Object.entries(values).map(([path, value]) => ({ op: "replace", path: `${at}/${path}`, value }));
  return (
    byKind<Operation[]>(collider, {
      sphere: () => put({ "sphere/center": rounded(place) }),
      plane: () => [],
      capsule: ({ a, b }) => {
        const half = new Vector3(0, new Vector3(...a).distanceTo(new Vector3(...b)) / 2, 0).applyQuaternion(turn);
        return put({
          "capsule/a": rounded(place.clone().sub(half)),
          "capsule/b": rounded(place.clone().add(half)),
        });
      },
      box: () => put({ "box/center": rounded(place), "box/rotate": anglesOf(turn) }),
      mesh: () => put({ "transform/translate": rounded(place), "transform/rotate": anglesOf(turn) }),
    }) ?? []
  );
}
