// Finds what the pointer is on: the cloth's nearest vertex, by a ray through the triangles of the frame on screen.
import { type Box3, type PerspectiveCamera, Ray, Raycaster, Vector2, Vector3 } from "three";
import { Places } from "./places";
import type { Stage } from "./stage";
import type { Frame, Topology } from "../link/protocol";

export interface Hit {
  vertex: number; ///< of all cloths, as in the frame
  place: Vector3; ///< of the vertex [m]
  distance: number; ///< from the camera to the triangle [m]
}

/// The ray of a pointer at `x`, `y` [CSS pixels in the canvas].
function rayThrough(camera: PerspectiveCamera, x: number, y: number, canvas: HTMLElement): Ray {
  const at = new Vector2((2 * x) / canvas.clientWidth - 1, 1 - (2 * y) / canvas.clientHeight);
  const origin = new Vector3().setFromMatrixPosition(camera.matrixWorld);
  const direction = new Vector3(at.x, at.y, 0.5).unproject(camera).sub(origin).normalize();
  return new Ray(origin, direction);
}

/// The free vertex nearest to where the ray first meets a triangle; null if it meets none, or one that pins hold whole.
/// A mesh of a million triangles takes some 50 ms, once a press.
function hitCloth(ray: Ray, frame: Frame, topology: Topology, box: Box3, pinned: Set<number>): Hit | null {
  if (!ray.intersectsBox(box)) return null;
  const { triangles } = topology;
  const places = new Places(frame);
  const corners: [Vector3, Vector3, Vector3] = [new Vector3(), new Vector3(), new Vector3()];
  const point = new Vector3();
  let first = -1;
  let nearest = Infinity;
  const met = new Vector3();
  for (let t = 0; t < triangles.length; t += 3) {
    for (const k of [0, 1, 2] as const) places.of(triangles[t + k] ?? 0, corners[k]);
    if (!ray.intersectTriangle(...corners, false, point)) continue;
    const distance = point.distanceTo(ray.origin);
    if (distance >= nearest) continue;
    [first, nearest] = [t, distance];
    met.copy(point);
  }
  if (first < 0) return null;
  const free = [...triangles.subarray(first, first + 3)].filter((vertex) => !pinned.has(vertex));
  const [vertex] = free.sort((a, b) => places.of(a).distanceToSquared(met) - places.of(b).distanceToSquared(met));
  return vertex === undefined ? null : { vertex, place: places.of(vertex), distance: nearest };
}

/// Where a place is on the canvas [CSS pixels]; null behind the camera.
function onScreen(place: Vector3, camera: PerspectiveCamera, canvas: HTMLElement): Vector2 | null {
  if (place.clone().applyMatrix4(camera.matrixWorldInverse).z >= 0) return null;
  const { x, y } = place.clone().project(camera);
  return new Vector2(((x + 1) / 2) * canvas.clientWidth, ((1 - y) / 2) * canvas.clientHeight);
}

/// Answers in the coordinates of the canvas [CSS pixels] what is where on a stage.
export class Picker {
  constructor(private readonly stage: Stage) {}

  get canvas(): HTMLCanvasElement {
    return this.stage.canvas;
  }
  get frame(): Frame | null {
    return this.stage.frame;
  }
  get topology(): Topology | null {
    return this.stage.cloth.topology;
  }

  /// The middle of the part of the window that shows the scene.
  get middle(): Vector2 {
    const { left, top, width, height } = this.stage.area;
    return new Vector2(left + width / 2, top + height / 2);
  }

  private ray(x: number, y: number): Ray {
    return rayThrough(this.stage.camera, x, y, this.canvas);
  }

  /// The cloth, if it is what a ray through this point meets first, and a vertex of it that no pin holds.
  cloth(x: number, y: number, pinned: Set<number>): Hit | null {
    const { frame, topology } = this;
    if (!frame || !topology) return null;
    const ray = this.ray(x, y);
    const hit = hitCloth(ray, frame, topology, this.stage.cloth.box, pinned);
    const body = this.body(x, y);
    // cloth that lies on a body may be a little inside it
    return hit && (!body || hit.distance < body.distance + 0.02 * this.stage.radius) ? hit : null;
  }

  /// The number of the body, no plane, that a ray through this point meets first.
  body(x: number, y: number): { index: number; distance: number } | null {
    const ray = this.ray(x, y);
    const caster = new Raycaster(ray.origin, ray.direction);
    const [first] = this.stage.colliders.bodies
      .flatMap(({ mesh, index }) => caster.intersectObject(mesh, false).map(({ distance }) => ({ index, distance })))
      .sort((a, b) => a.distance - b.distance);
    return first ?? null;
  }

  /// The free vertex that is seen nearest to this point.
  nearestVertex(x: number, y: number, pinned: Set<number>): Hit | null {
    if (!this.frame) return null;
    const places = new Places(this.frame);
    let best: Hit | null = null;
    for (let vertex = 0; vertex < places.count; ++vertex) {
      const place = places.of(vertex);
      const at = pinned.has(vertex) ? null : this.onScreen(place);
      const distance = at ? Math.hypot(at.x - x, at.y - y) : Infinity;
      if (distance < (best?.distance ?? Infinity)) best = { vertex, place, distance };
    }
    return best;
  }

  onScreen(place: Vector3): Vector2 | null {
    return onScreen(place, this.stage.camera, this.canvas);
  }

  /// Distance of a place from the camera along the view [m].
  away(place: Vector3): number {
    return -place.clone().applyMatrix4(this.stage.camera.matrixWorldInverse).z;
  }

  /// The place that is seen at this point, this far away along the view [m].
  through(x: number, y: number, away: number): Vector3 {
    const ray = this.ray(x, y);
    return ray.at(away / ray.direction.dot(this.stage.camera.getWorldDirection(new Vector3())), new Vector3());
  }
}
