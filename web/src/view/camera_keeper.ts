// Keeps the camera on the scene until somebody moves it: fitted at the start, and drawn back where the cloth goes
// farther than was foreseen. It never comes nearer by itself, as a picture that breathes with the cloth is hard to look
// at.
import type { PerspectiveCamera, Vector3 } from "three";
import { between, centerIn, Outline, place, standFor, type FreeArea, type Stand } from "./framing";

const timeToFollow = 0.15; // [s]
const mostDrawnBack = 2; // times the distance that was foreseen: what flies away is let go
const worthMoving = 1e-3; // of the distance

export class CameraKeeper {
  fitted = true; ///< until the user moves the camera
  private area: FreeArea = { left: 0, top: 0, width: 1, height: 1 };
  private height = 1; // of the window [CSS pixels]
  private foreseen = new Outline();
  private seen = new Outline();
  private stand: Stand | null = null;
  private goal: Stand | null = null;

  constructor(private readonly camera: PerspectiveCamera) {}

  /// Another window, or another part of it.
  resize(area: FreeArea, width: number, height: number): void {
    this.area = area;
    this.height = height;
    centerIn(this.camera, area, width, height);
  }

  /// Only these are to be seen, from now on. Returns what to orbit around.
  fit(points: Vector3[], now: Vector3[] = []): Vector3 | null {
    this.foreseen = new Outline();
    this.foreseen.add(points);
    this.seen = new Outline();
    this.seen.add([...points, ...now]);
    return this.jump();
  }

  /// Where it should be, at once.
  jump(): Vector3 | null {
    if (this.seen.empty) return null;
    this.fitted = true;
    this.stand = this.goal = this.wanted();
    return place(this.camera, this.stand);
  }

  /// These are on screen now.
  see(points: Vector3[]): void {
    if (!this.fitted || this.seen.empty) return;
    this.seen.add(points);
    this.goal = this.wanted();
  }

  /// Some of the way to where it should be; null: it is there.
  follow(seconds: number): Vector3 | null {
    const { stand, goal } = this;
    if (!this.fitted || !stand || !goal) return null;
    const distance = goal.away - goal.middle;
    const apart = Math.hypot(goal.away - stand.away, goal.across - stand.across, goal.up - stand.up);
    if (apart < worthMoving * distance) return null;
    this.stand = between(stand, goal, 1 - Math.exp(-seconds / timeToFollow));
    return place(this.camera, this.stand);
  }

  private wanted(): Stand {
    const all = standFor(this.seen, this.area, this.height, this.camera.fov);
    const known = standFor(this.foreseen, this.area, this.height, this.camera.fov);
    return all.away - known.middle <= mostDrawnBack * (known.away - known.middle) ? all : (this.goal ?? known);
  }
}
