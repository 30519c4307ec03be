// Keeps the scene in view until the user moves the camera. The camera is fitted at the start, and moves back if the
// cloth goes farther than expected. It never comes nearer by itself: a picture that follows every motion of the cloth
// is hard to look at.
import type { PerspectiveCamera, Vector3 } from "three";
import { between, centerIn, Outline, place, standFor, type FreeArea, type Stand } from "./framing";

const timeToFollow = 0.15; // [s]: time constant
const mostDrawnBack = 2; // times the expected distance: the camera does not follow what flies farther
const worthMoving = 1e-3; // share of the distance: shorter ways are not worth moving

export class CameraKeeper {
  fitted = true; ///< false once the user has moved the camera
  private area: FreeArea = { left: 0, top: 0, width: 1, height: 1 };
  private height = 1; // height of the window [CSS pixels]
  private foreseen = new Outline();
  private seen = new Outline();
  private stand: Stand | null = null;
  private goal: Stand | null = null;

  constructor(private readonly camera: PerspectiveCamera) {}

  /// The window, or its free part, has another size.
  resize(area: FreeArea, width: number, height: number): void {
    this.area = area;
    this.height = height;
    centerIn(this.camera, area, width, height);
  }

  /// Fits the camera to these points. Returns the point to orbit around; null if there are none.
  fit(points: Vector3[], now: Vector3[] = []): Vector3 | null {
    this.foreseen = new Outline();
    this.foreseen.add(points);
    this.seen = new Outline();
    this.seen.add([...points, ...now]);
    return this.jump();
  }

  /// Moves the camera to the fitted place at once. Returns the point to orbit around.
  jump(): Vector3 | null {
    if (this.seen.empty) return null;
    this.fitted = true;
    this.stand = this.goal = this.wanted();
    return place(this.camera, this.stand);
  }

  /// Takes the first points that show where a scene reaches, where its document does not tell that.
  foresee(points: Vector3[]): void {
    this.foreseen.add(points);
    this.seen.add(points);
    if (this.fitted) this.goal = this.wanted();
  }

  /// Takes points that are on screen now: the camera must show them too.
  see(points: Vector3[]): void {
    if (!this.fitted || this.seen.empty) return;
    this.seen.add(points);
    this.goal = this.wanted();
  }

  /// Moves part of the way to the fitted place. Returns the point to orbit around; null if the camera is there.
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
