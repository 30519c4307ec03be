// The way to the handles of bodies and cloths, which are loaded when somebody chooses one.
import { noticeError } from "../panel/notices";
import type { HandleEvents, Handles } from "./handles";
import { Picker } from "./picking";
import type { Stage } from "./stage";

export class HandlesDoor {
  private handles: Handles | null = null;
  private loading: Promise<typeof import("./handles")> | null = null;
  private readonly picker: Picker;
  private awaited: number | null = null; // the body that is chosen once it is there

  constructor(
    private readonly stage: Stage,
    private readonly events: HandleEvents,
  ) {
    this.picker = new Picker(stage);
  }

  get hasChosen(): boolean {
    return this.handles?.hasChosen ?? false;
  }

  /// True if a handle is under the pointer: the press is its own.
  takes(event: PointerEvent): boolean {
    return this.handles?.takes(event) ?? false;
  }

  /// A click at this point of the canvas, not on cloth.
  click(x: number, y: number): void {
    const index = this.picker.body(x, y)?.index ?? null;
    if (index === null) this.leave();
    else this.with((handles) => handles.choose({ of: "body", index }));
  }

  /// Chooses the cloth of this number, if it is as it starts: that is what handles move.
  chooseCloth(index: number): void {
    if (this.stage.frame?.header.step === 0) this.with((handles) => handles.chooseCloth(index));
  }

  /// Chooses the body of this number, once the document has it.
  chooseBody(index: number): void {
    this.awaited = index;
    this.follow();
  }

  /// Chooses the next body, for keys.
  chooseNext(): void {
    this.with((handles) => handles.chooseNext());
  }

  /// No body is chosen any more.
  leave(): void {
    this.handles?.choose(null);
  }

  /// The document has changed.
  follow(): void {
    this.handles?.follow();
    const index = this.awaited;
    if (index === null || !this.events.document()?.colliders[index]) return;
    this.awaited = null;
    this.with((handles) => handles.choose({ of: "body", index }));
  }
  toggleMode(): void {
    this.handles?.toggleMode();
  }
  nudge(right: number, up: number, away: number): void {
    this.handles?.nudge(right, up, away);
  }

  private with(use: (handles: Handles) => void): void {
    if (!this.events.mayEdit()) return;
    this.loading ??= import("./handles");
    this.loading
      .then((module) => use((this.handles ??= new module.Handles(this.stage, this.events))))
      .catch((error: Error) => {
        this.loading = null;
        noticeError("The handles could not be loaded", error);
      });
  }
}
