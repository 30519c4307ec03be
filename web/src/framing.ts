// Where the camera stands so that the whole scene fits into the part of the window no panel covers.
import { Box3, MathUtils, PerspectiveCamera, Sphere, Vector3 } from "three";
import { extremes, moved } from "./motion";
import { heldVertices, restPositions } from "./pins";
import type { Cloth, SceneDocument } from "./scene_types";

/// The part of the window that panels leave free [CSS pixels].
export interface FreeArea { left: number; top: number; width: number; height: number }

const viewFrom = new Vector3(1, 0.34, 0.5).normalize();  // from the side: the seed's cloth hides its sphere from the front

/// How far a cloth can hang from its pins [m]: the largest distance from a vertex to the nearest pin, at rest.
function hangingLength(rest: Vector3[], pins: Vector3[]): number {
  const every = (points: Vector3[], most: number) => points.filter((_, i) => i % Math.ceil(points.length / most) === 0);
  const some = every(pins, 64);
  return Math.max(...every(rest, 400).map((point) => Math.min(...some.map((pin) => pin.distanceTo(point)))));
}

function clothBox(cloth: Cloth, falls: boolean): Box3 {
  const rest = restPositions(cloth);
  const box = new Box3().setFromPoints(rest);
  const held = [...heldVertices(cloth)].filter(([vertex]) => rest[vertex]);
  if (held.length === 0) return box;
  const pins = held.map(([vertex]) => rest[vertex] as Vector3);
  const swept = new Box3().setFromPoints(held.flatMap(([vertex, motion]) =>
    extremes(motion).map((time) => moved((rest[vertex] as Vector3).toArray(), motion, time))));
  if (!falls) return box.union(swept);
  const length = hangingLength(rest, pins);
  // What hangs far from its pins leaves its rest shape within a second: not all of the way out there counts.
  const hold = new Box3().setFromPoints(pins);
  const share = 0.42 * Math.min(1, length / box.getSize(new Vector3()).length());
  box.min.lerp(hold.min, share);
  box.max.lerp(hold.max, share);
  swept.min.y = Math.min(swept.min.y, hold.min.y - length);
  return box.union(swept);
}

/// The space a scene is going to use [m]: known before the first frame, and the same whenever F is pressed.
export function sceneBox(document: SceneDocument): Box3 {
  const falls = document.gravity[1] < 0;
  const box = new Box3();
  for (const cloth of document.cloths) box.union(clothBox(cloth, falls));
  for (const { sphere, motion } of document.colliders) {
    if (!sphere) continue;
    for (const time of extremes(motion)) {
      box.union(new Sphere(moved(sphere.center, motion, time), sphere.radius).getBoundingBox(new Box3()));
    }
  }
  for (const { plane } of document.colliders) {
    if (plane && plane.normal[1] > 0.7) box.min.y = Math.max(Math.min(box.min.y, box.max.y), plane.point[1]);
  }
  return box;
}

/// Half of the width of what is in the box along a direction [m]. Corners of a bulky box are empty and those of a thin
/// one are not: between the box itself and the ellipsoid that touches its sides.
function halfWidth(box: Box3, along: Vector3): number {
  const parts = box.getSize(new Vector3()).multiplyScalar(0.5).multiply(along).toArray().map(Math.abs);
  return 0.4 * parts.reduce((sum, part) => sum + part, 0) + 0.6 * Math.hypot(...parts);
}

/// Distance at which the box just fits a view of these half-angle tangents, seen along `direction`.
function distanceToFit(box: Box3, direction: Vector3, tangentX: number, tangentY: number): number {
  const right = new Vector3(0, 1, 0).cross(direction).normalize();
  const above = direction.clone().cross(right);
  const flat = Math.max(halfWidth(box, right) / tangentX, halfWidth(box, above) / tangentY, 0.05);
  return flat + 0.6 * halfWidth(box, direction);
}

/// Places the camera; returns the point it should orbit around.
export function frame(camera: PerspectiveCamera, box: Box3, area: FreeArea, windowHeight: number): Vector3 {
  const perPixel = Math.tan(MathUtils.degToRad(camera.fov / 2)) / (windowHeight / 2);
  const margin = 1.04;
  const distance = margin * distanceToFit(box, viewFrom, (perPixel * area.width) / 2, (perPixel * area.height) / 2);
  const center = box.getCenter(new Vector3());
  camera.position.copy(center).addScaledVector(viewFrom, distance);
  camera.near = distance / 100;
  camera.far = distance * 40;
  camera.updateProjectionMatrix();
  return center;
}

/// Shifts the picture so that its middle is the middle of the free area.
export function centerIn(camera: PerspectiveCamera, area: FreeArea, width: number, height: number): void {
  const x = width / 2 - (area.left + area.width / 2);
  const y = height / 2 - (area.top + area.height / 2);
  camera.aspect = width / height;
  camera.setViewOffset(width, height, x, y, width, height);
}
