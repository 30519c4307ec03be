// Where a body or a cloth is as a place, a turn and a scale, and the edits that put it elsewhere.
import { Euler, MathUtils, Quaternion, Vector3 } from "three";
import {
  type At,
  byKind,
  type Cloth,
  type Collider,
  type Operation,
  type Shape,
  type Transform,
  type Vec3,
} from "../link/scene_types";
import { shiftedAt } from "../link/shifted_cloth";

export interface Pose {
  place: Vector3; ///< [m]
  turn: Quaternion;
  scale: number;
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

const put = (at: string, values: Record<string, unknown>): Operation[] =>
  Object.entries(values).map(([path, value]) => ({ op: "replace", path: `${at}/${path}`, value }));

const ofTransform = ({ translate, rotate, scale }: Transform): Pose => ({
  place: new Vector3(...translate),
  turn: quaternionOf(rotate),
  scale,
});

const asTransform = ({ place, turn, scale }: Pose): Record<string, unknown> => ({
  "transform/translate": rounded(place),
  "transform/rotate": anglesOf(turn),
  "transform/scale": Number(scale.toPrecision(6)),
});

/// The pose of a body at home; null of a plane.
export const poseOf = (shape: Shape): Pose | null =>
  byKind<Pose | null>(shape, {
    sphere: ({ center }) => ({ place: new Vector3(...center), turn: upright(), scale: 1 }),
    plane: () => null,
    capsule: ({ a, b }) => ({
      place: middle(a, b),
      turn: upright().setFromUnitVectors(new Vector3(0, 1, 0), new Vector3(...b).sub(new Vector3(...a)).normalize()),
      scale: 1,
    }),
    box: ({ center, rotate }) => ({ place: new Vector3(...center), turn: quaternionOf(rotate), scale: 1 }),
    mesh: ({ transform }) => ofTransform(transform),
  });

/// The operations that put collider number `index` at `to`.
export function moved(collider: Collider, index: number, to: Pose): Operation[] {
  const { place, turn } = to;
  const at = `/colliders/${index}`;
  return (
    byKind<Operation[]>(collider, {
      sphere: () => put(at, { "sphere/center": rounded(place) }),
      plane: () => [],
      capsule: ({ a, b }) => {
        const half = new Vector3(0, new Vector3(...a).distanceTo(new Vector3(...b)) / 2, 0).applyQuaternion(turn);
        return put(at, {
          "capsule/a": rounded(place.clone().sub(half)),
          "capsule/b": rounded(place.clone().add(half)),
        });
      },
      box: () => put(at, { "box/center": rounded(place), "box/rotate": anglesOf(turn) }),
      mesh: () => put(at, asTransform(to)),
    }) ?? []
  );
}

/// A place of the scene [m] in the frame of a cloth's mesh.
export function inMesh({ transform }: Cloth, place: Vector3): Vector3 {
  const { place: origin, turn, scale } = ofTransform(transform);
  return place.clone().sub(origin).applyQuaternion(turn.invert()).divideScalar(scale);
}

/// The pose of a cloth at its start, about its mesh's point `middle`.
export function clothPose({ transform }: Cloth, middle: Vector3): Pose {
  const pose = ofTransform(transform);
  const { place, turn, scale } = pose;
  return { ...pose, place: middle.clone().multiplyScalar(scale).applyQuaternion(turn).add(place) };
}

/// The operations that put cloth number `index` at `to`. Places where pins hold it go with it; so do boxes in which
/// pins and weights look for vertices, as far as it only moves.
export function movedCloth(cloth: Cloth, index: number, middle: Vector3, to: Pose): Operation[] {
  const at = `/cloths/${index}`;
  const offset = middle.clone().multiplyScalar(to.scale).applyQuaternion(to.turn);
  const pose = { ...to, place: to.place.clone().sub(offset) };
  const carry = (place: Vec3): Vec3 => {
    const local = inMesh(cloth, new Vector3(...place));
    return rounded(local.multiplyScalar(to.scale).applyQuaternion(to.turn).add(pose.place));
  };
  return [...put(at, asTransform(pose)), ...carried(cloth, at, carry)];
}

function carried(
  { pins, weights, transform: { translate } }: Cloth,
  at: string,
  carry: (of: Vec3) => Vec3,
): Operation[] {
  const by = carry(translate).map((value, axis) => value - (translate[axis] as number)) as Vec3;
  const isBox = (of: At): boolean => typeof of !== "string";
  return [
    ...pins.flatMap((pin, i) => [
      ...(pin.place ? put(`${at}/pins/${i}`, { place: carry(pin.place) }) : []),
      ...(isBox(pin.at) ? put(`${at}/pins/${i}`, { at: shiftedAt(pin.at, by) }) : []),
    ]),
    ...weights.flatMap((weight, i) =>
      isBox(weight.at) ? put(`${at}/weights/${i}`, { at: shiftedAt(weight.at, by) }) : [],
    ),
  ];
}
