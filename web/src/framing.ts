// Where the camera stands so that the whole scene fits into the part of the window no panel covers.
import { Box3, MathUtils, PerspectiveCamera, Sphere, Vector3 } from "three";
import { moved, reach } from "./motion";
import { pinnedVertices, restPositions } from "./pins";
import type { Cloth, SceneDocument } from "./scene_types";

/// The part of the window that panels leave free [CSS pixels].
export interface FreeArea { left: number; top: number; width: number; height: number }

const viewFrom = new Vector3(1, 0.34, 0.5).normalize();  // from the side: the seed's cloth hides its sphere from the front

function clothBox(cloth: Cloth, falls: boolean): Box3 {
  const rest = restPositions(cloth);
  const box = new Box3().setFromPoints(rest);
  const pinned = pinnedVertices(cloth);
  if (pinned.length === 0 || !falls) return box;
  // A pinned cloth hangs down from its pins by about its own length.
  const hold = new Box3().setFromPoints(pinned.flatMap((i) => rest[i] ?? []));
  const size = box.getSize(new Vector3());
  const length = Math.max(size.y, size.z);
  const swing = Math.max(...cloth.pins.map((pin) => reach(pin.motion)));
  const hanging = hold.clone().expandByScalar(swing);
  hanging.min.y = Math.min(hanging.min.y, hold.min.y - length);
  // It leaves its rest shape within a second: half of the way out there is enough.
  box.min.lerp(hold.min, 0.5);
  box.max.lerp(hold.max, 0.5);
  return box.union(hanging);
}

/// The space a scene is going to use [m]: known before the first frame, and the same whenever F is pressed.
export function sceneBox(document: SceneDocument): Box3 {
  const falls = document.gravity[1] < 0;
  const box = new Box3();
  for (const cloth of document.cloths) box.union(clothBox(cloth, falls));
  for (const { sphere, motion } of document.colliders) {
    if (!sphere) continue;
    const ball = new Sphere(moved(sphere.center, motion, 0), sphere.radius + reach(motion));
    box.union(ball.getBoundingBox(new Box3()));
  }
  for (const { plane } of document.colliders) {
    if (plane && plane.normal[1] > 0.7) box.min.y = Math.max(Math.min(box.min.y, box.max.y), plane.point[1]);
  }
  return box;
}

/// Distance at which the box just fits a view of these half-angle tangents, seen along `direction`.
function distanceToFit(box: Box3, direction: Vector3, tangentX: number, tangentY: number): number {
  const center = box.getCenter(new Vector3());
  const right = new Vector3(0, 1, 0).cross(direction).normalize();
  const above = direction.clone().cross(right);
  let distance = 0.1;
  for (let corner = 0; corner < 8; ++corner) {
    const point = new Vector3(
      corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y, corner & 4 ? box.max.z : box.min.z).sub(center);
    const towards = point.dot(direction);
    distance = Math.max(distance, towards + Math.abs(point.dot(right)) / tangentX, towards + Math.abs(point.dot(above)) / tangentY);
  }
  return distance;
}

/// Places the camera; returns the point it should orbit around.
export function frame(camera: PerspectiveCamera, box: Box3, area: FreeArea, windowHeight: number): Vector3 {
  const perPixel = Math.tan(MathUtils.degToRad(camera.fov / 2)) / (windowHeight / 2);
  const margin = 0.9;  // corners of the box are empty
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
