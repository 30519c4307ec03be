// A cloth that lies elsewhere, with the places by which pins and weights hold it.
import type { At, Cloth, Vec3 } from "./scene_types";

export const shiftedPlace = (place: Vec3, by: Vec3): Vec3 =>
  place.map((value, axis) => Number((value + (by[axis] as number)).toFixed(5))) as Vec3;

/// A box goes along; names of vertices stay.
export const shiftedAt = (at: At, by: Vec3): At =>
  typeof at === "string" ? at : { box: [shiftedPlace(at.box[0], by), shiftedPlace(at.box[1], by)] };

export const shiftedCloth = (cloth: Cloth, name: string, by: Vec3): Cloth => ({
  ...cloth,
  name,
  transform: { ...cloth.transform, translate: shiftedPlace(cloth.transform.translate, by) },
  pins: cloth.pins.map((pin) => ({
    ...pin,
    at: shiftedAt(pin.at, by),
    ...(pin.place ? { place: shiftedPlace(pin.place, by) } : {}),
  })),
  weights: cloth.weights.map((weight) => ({ ...weight, at: shiftedAt(weight.at, by) })),
});
