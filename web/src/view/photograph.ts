// Where the camera stands for a picture of its own size: what the user sees between the cards, in the picture's middle.
import { Box3, MathUtils, type Mesh, type PerspectiveCamera, Vector3 } from "three";
import { centerIn, type FreeArea, Outline, place, standFor } from "./framing";

export interface PictureSize {
  width: number; ///< [pixels]
  height: number;
}

const mostOfBody = 400; // vertices of a body: more tell nothing new of its outline

/// Some of a body's vertices, where it is now [m].
export function bodyPoints(body: Mesh): Vector3[] {
  const { position } = body.geometry.attributes;
  if (!position) return [];
  body.updateWorldMatrix(true, false);
  const stride = Math.ceil(position.count / mostOfBody);
  const points: Vector3[] = [];
  for (let i = 0; i < position.count; i += stride)
    points.push(new Vector3().fromBufferAttribute(position, i).applyMatrix4(body.matrixWorld));
  return points;
}

/// Fits these points into the picture, seen as the page sees a scene at first.
export function frameSubject(camera: PerspectiveCamera, points: Vector3[], { width, height }: PictureSize): void {
  const outline = new Outline();
  outline.add(points);
  const all = { left: 0, top: 0, width, height };
  centerIn(camera, all, width, height);
  camera.lookAt(place(camera, standFor(outline, all, height, camera.fov)));
  // In the direction that has room to spare perspective makes the near side wider: the middle of what is seen counts.
  camera.updateMatrixWorld();
  const seen = new Box3().setFromPoints(points.map((point) => point.clone().project(camera)));
  const { x, y } = seen.getCenter(new Vector3());
  camera.setViewOffset(width, height, (x * width) / 2, (-y * height) / 2, width, height);
}

/// Keeps where the camera stands and looks to, and has all of the window's `area` in the picture's middle.
export function frameArea(camera: PerspectiveCamera, area: FreeArea, window: PictureSize, picture: PictureSize): void {
  const half = Math.tan(MathUtils.degToRad(camera.fov / 2)) / window.height; // of the view, for a pixel of the window
  const high = Math.max(area.height, (area.width * picture.height) / picture.width);
  camera.fov = 2 * MathUtils.radToDeg(Math.atan(half * high));
  centerIn(camera, { left: 0, top: 0, ...picture }, picture.width, picture.height);
  camera.updateProjectionMatrix();
}
