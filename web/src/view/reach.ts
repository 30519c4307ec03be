// Finds how far a scene reaches: what is known before the first frame, and what a frame shows.
import { Vector3 } from "three";
import { sweep } from "./motion";
import { heldVertices, restPositions } from "./pins";
import { Places } from "./places";
import { floorOf, outlineOf } from "./solids";
import type { Frame } from "../link/protocol";
import type { Cloth, SceneDocument } from "../link/scene_types";

const mostLooked = 400; // vertices of a cloth: more tell nothing new of its outline
// share: a falling cloth swings beyond its pins by this part of its distance; air and springs take the rest
const swung = 0.6;

function every<T>(items: T[], most: number): T[] {
  const stride = Math.ceil(items.length / most);
  return items.filter((_, i) => i % stride === 0);
}

/// Points where a cloth starts, where its pins go, and where the cloth that hangs on them swings to.
function clothPoints(cloth: Cloth, falls: boolean): Vector3[] {
  const rest = restPositions(cloth);
  const held = [...heldVertices(cloth)].filter(([vertex]) => rest[vertex]);
  const swept = held.flatMap(([vertex, motion]) => sweep((rest[vertex] as Vector3).toArray(), motion));
  const placed = cloth.pins.flatMap(({ place, motion }) => (place ? sweep(place, motion) : []));
  const points = [...rest, ...swept, ...placed];
  if (!falls || held.length === 0) return points;
  const pins = every(held, 64).map(([vertex]) => rest[vertex] as Vector3);
  for (const point of every(rest, mostLooked)) {
    const pin = pins.reduce((near, other) =>
      other.distanceToSquared(point) < near.distanceToSquared(point) ? other : near,
    );
    const length = pin.distanceTo(point);
    points.push(new Vector3(pin.x, pin.y - length, pin.z));
    const beyond = new Vector3(pin.x - point.x, 0, pin.z - point.z).multiplyScalar(swung);
    points.push(beyond.add(pin).setY(pin.y - Math.sqrt(Math.max(0, length * length - beyond.lengthSq()))));
  }
  return points;
}

/// Points that a scene is going to reach [m]. They are known before the first frame and always the same.
export function scenePoints(document: SceneDocument): Vector3[] {
  const falls = document.gravity[1] < 0;
  const points = document.cloths.flatMap((cloth) => clothPoints(cloth, falls));
  const floors = document.colliders.flatMap((collider) => floorOf(collider) ?? []);
  const floor = Math.max(-Infinity, ...floors.filter((height) => points.some(({ y }) => y >= height)));
  for (const point of points) point.y = Math.max(point.y, floor);
  points.push(...document.colliders.flatMap((collider) => outlineOf(collider, collider.motion)));
  // A cloth that nothing holds falls to the floor.
  const loose = document.cloths.filter(({ pins }) => pins.length === 0);
  if (falls && Number.isFinite(floor))
    points.push(...loose.flatMap((cloth) => every(restPositions(cloth), mostLooked).map((point) => point.setY(floor))));
  return points;
}

/// Some of a frame's vertices [m].
export function framePoints(frame: Frame): Vector3[] {
  const places = new Places(frame);
  const stride = Math.ceil(places.count / mostLooked);
  const points: Vector3[] = [];
  for (let i = 0; i < places.count; i += stride) points.push(places.of(i));
  return points;
}
