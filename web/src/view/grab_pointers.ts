// Pulls the cloth by mouse or finger. A press on the cloth holds the vertex under it; a press beside the cloth, or with
// a modifier key, is the camera's. The wheel or a second finger moves what is held along the view.
import type { Grab, Held } from "./grab";
import type { PinnedVertex } from "./pin_choice";
import type { Stage } from "./stage";

export interface PressEvents {
  busy(event: PointerEvent): boolean; ///< something over the cloth takes this press
  clicked(x: number, y: number): void; ///< a click on neither cloth nor pin, at this point of the canvas
  clickedCloth(cloth: number): void; ///< a click on this cloth
}

const slop = 6; // [CSS pixels] within which a press is a click, or a finger is still
const pinsReach = { mouse: 12, touch: 24 }; // [CSS pixels]
const clickTime = 400; // [ms] a longer press is a pull
const secondFinger = 200; // [ms] after the first, both still: they are the camera's

export class GrabPointers {
  private pressed: { pin: PinnedVertex | null; x: number; y: number } | null = null;
  private depthFinger: { pointer: number; y: number } | null = null;

  constructor(
    private readonly stage: Stage,
    private readonly grab: Grab,
    private readonly events: PressEvents,
  ) {
    const { canvas } = stage;
    const early = { capture: true }; // before the camera's controls
    canvas.addEventListener("pointerdown", (event) => this.down(event), early);
    canvas.addEventListener("pointermove", (event) => this.move(event), early);
    for (const end of ["pointerup", "pointercancel"] as const)
      canvas.addEventListener(end, (event) => this.up(event), early);
    canvas.addEventListener("wheel", (event) => this.wheel(event), { capture: true, passive: false });
  }

  private down(event: PointerEvent): void {
    const touch = event.pointerType === "touch";
    if (this.grab.held) {
      if (touch && this.grab.held.by === "touch") this.second(event);
      else stop(event);
      return;
    }
    this.pressed = null;
    if (event.button !== 0 || event.ctrlKey || event.shiftKey || event.altKey || event.metaKey) return;
    if (!this.grab.mayGrab || this.events.busy(event)) return;
    const [x, y] = [event.offsetX, event.offsetY];
    this.pressed = { pin: this.grab.pins.at(x, y, pinsReach[touch ? "touch" : "mouse"]), x, y };
    const hit = this.pressed.pin ? null : this.grab.picker.cloth(x, y, this.grab.pins.vertices);
    if (!hit) return;
    stop(event);
    this.grab.picker.canvas.setPointerCapture(event.pointerId);
    (document.activeElement as HTMLElement | null)?.blur(); // keys are the hand's now, not a field's
    this.depthFinger = null;
    this.grab.hold(hit.vertex, hit.place, touch ? "touch" : "mouse", event.pointerId, x, y);
  }

  /// A second finger at once, before the first has pulled: they are the camera's, which hears of the first one now.
  /// Later, it moves what is held along the view.
  private second(event: PointerEvent): void {
    const held = this.grab.held as Held;
    if (!held.travelled && performance.now() - held.since < secondFinger) {
      this.grab.drop();
      const { left, top } = this.grab.picker.canvas.getBoundingClientRect();
      const [clientX, clientY] = [held.x + left, held.y + top];
      const first = { pointerId: held.pointer, pointerType: "touch", clientX, clientY, bubbles: true, isPrimary: true };
      this.stage.controls.domElement?.dispatchEvent(new PointerEvent("pointerdown", { ...first, shiftKey: true }));
      return;
    }
    stop(event);
    this.depthFinger = { pointer: event.pointerId, y: event.offsetY };
  }

  private move(event: PointerEvent): void {
    const { held } = this.grab;
    if (!held || held.by === "key") return;
    stop(event);
    const now = performance.now();
    if (event.pointerId === this.depthFinger?.pointer) {
      this.grab.deepen((this.depthFinger.y - event.offsetY) * 0.005);
      this.depthFinger.y = event.offsetY;
      held.stillSince = now;
      return;
    }
    if (event.pointerId !== held.pointer) return;
    const moved = Math.hypot(event.offsetX - held.x, event.offsetY - held.y);
    held.travelled ||= moved > slop;
    if (moved > slop || !held.travelled) held.stillSince = held.travelled ? now : held.stillSince;
    [held.x, held.y] = [event.offsetX, event.offsetY];
    this.grab.aim();
  }

  private up(event: PointerEvent): void {
    if (event.pointerId === this.depthFinger?.pointer) {
      stop(event);
      this.depthFinger = null;
      return;
    }
    const { held } = this.grab;
    const { pressed } = this;
    if (held && event.pointerId === held.pointer) {
      stop(event);
      if (event.type === "pointerup" && this.grab.still(held)) this.grab.pin();
      else this.grab.drop();
      const click = event.type === "pointerup" && !held.travelled && performance.now() - held.since < clickTime;
      if (click) this.events.clickedCloth(held.cloth);
      return;
    }
    if (held || !pressed || event.type !== "pointerup") return;
    const click = Math.hypot(event.offsetX - pressed.x, event.offsetY - pressed.y) <= slop;
    if (click) this.grab.choose(pressed.pin);
    if (click && !pressed.pin) this.events.clicked(pressed.x, pressed.y);
    this.pressed = null;
  }

  private wheel(event: WheelEvent): void {
    if (!this.grab.held) return;
    stop(event);
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    this.grab.deepen(-event.deltaY * lines * 0.0008);
  }
}

function stop(event: Event): void {
  event.stopImmediatePropagation();
}
