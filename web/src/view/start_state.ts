// Cloths as they start: how wide they are then, and their handles, which move them there.
import { Picker } from "./picking";
import type { Stage } from "./stage";

export interface StartEvents {
  stop(): void; ///< pauses the session
  reset(): void; ///< brings back the start
  chooseCloth(index: number): void; ///< gives it handles
}

export class StartState {
  private widths: number[] = []; // along x [m]
  private waiting: number | null = null; // the cloth that gets handles once it is back at its start
  private readonly picker: Picker;

  constructor(
    private readonly stage: Stage,
    private readonly events: StartEvents,
  ) {
    this.picker = new Picker(stage);
  }

  /// A frame is on screen.
  drawn(step: number): void {
    if (step !== 0) return;
    this.widths = (this.picker.topology?.cloths ?? []).map((_, cloth) => this.picker.wide(cloth));
    if (this.waiting !== null) this.events.chooseCloth(this.waiting);
    this.waiting = null;
  }

  /// How wide a cloth is along x, at its start or at present [m].
  wide(cloth: number): number {
    return Math.max(this.widths[cloth] ?? 0, this.picker.wide(cloth));
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
