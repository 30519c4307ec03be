// Cloths as they start: how wide they are then, and their handles, which move them there.
import { Box3 } from "three";
import type { Box } from "../link/free_place";
import { boxOf } from "./places";
import type { Stage } from "./stage";

export interface StartEvents {
  stop(): void; ///< pauses the session
  reset(): void; ///< brings back the start
  chooseCloth(index: number): void; ///< gives it handles
}

export class StartState {
  private boxes: Box3[] = []; // of the cloths
  private waiting: number | null = null; // the cloth that gets handles once it is back at its start

  constructor(
    private readonly stage: Stage,
    private readonly events: StartEvents,
  ) {}

  /// A frame is on screen.
  drawn(step: number): void {
    if (step !== 0) return;
    this.boxes = this.present;
    if (this.waiting !== null) this.events.chooseCloth(this.waiting);
    this.waiting = null;
  }

  /// How wide a cloth is along x, at its start or at present [m].
  wide(cloth: number): number {
    const wide = (box: Box3 | undefined): number => (box ? box.max.x - box.min.x : 0);
    return Math.max(wide(this.boxes[cloth]), wide(this.present[cloth]));
  }

  /// What cloths take at their start and at present, and bodies.
  taken(): Box[] {
    const bodies = this.stage.colliders.bodies.map(({ mesh }) => new Box3().setFromObject(mesh));
    return [...this.boxes, ...this.present, ...bodies]
      .filter((box) => !box.isEmpty())
      .map(({ min, max }) => ({ low: min.toArray(), high: max.toArray() }));
  }

  private get present(): Box3[] {
    const { frame, cloth } = this.stage;
    return frame ? (cloth.topology?.cloths ?? []).map((range) => boxOf(frame, range)) : [];
  }

  /// Goes to the start and gives this cloth handles.
  giveHandles(cloth: number): void {
    this.events.stop();
    this.stage.canvas.focus({ preventScroll: true }); // keys are the handles' now, not the button's
    this.waiting = cloth;
    if (this.stage.frame?.header.step === 0) this.drawn(0);
    else this.events.reset();
  }
}
