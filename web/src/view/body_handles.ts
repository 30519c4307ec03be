// Handles that move and turn the body that was clicked: three.js' TransformControls on an empty object, whose pose
// becomes edits of the scene. A mesh is put in place when the drag ends, as that starts the cloth anew.
import { Object3D } from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import { moved, poseOf } from "./body_pose";
import { HandHint } from "./hand_hint";
import { Picker } from "./picking";
import type { Stage } from "./stage";
import type { Collider, Operation, SceneDocument } from "../link/scene_types";

export interface BodyEvents {
  edit(operations: Operation[]): void;
  document(): SceneDocument | null;
  mayEdit(): boolean;
}

const step = 0.02; // share of the view's distance that a key moves a body by
const turnStep = Math.PI / 36;

export class BodyHandles {
  private readonly controls: TransformControls;
  private readonly proxy = new Object3D();
  private readonly picker: Picker;
  private readonly hint = new HandHint("body");
  private chosen: number | null = null;

  constructor(
    private readonly stage: Stage,
    private readonly events: BodyEvents,
  ) {
    this.picker = new Picker(stage);
    this.controls = new TransformControls(stage.camera, stage.canvas);
    this.controls.setSize(0.8);
    stage.scene.add(this.proxy, this.controls.getHelper());
    this.controls.addEventListener("change", () => stage.invalidate());
    this.controls.addEventListener("objectChange", () => this.edited(false));
    this.controls.addEventListener("dragging-changed", () => {
      stage.controls.enabled = !this.controls.dragging;
      if (!this.controls.dragging) this.edited(true);
    });
    this.choose(null);
  }

  get hasChosen(): boolean {
    return this.chosen !== null;
  }

  /// True if a handle is under the pointer: the press is its own.
  takes(event: PointerEvent): boolean {
    if (this.chosen === null) return false;
    const { clientWidth, clientHeight } = this.stage.canvas;
    const [x, y] = [(2 * event.offsetX) / clientWidth - 1, 1 - (2 * event.offsetY) / clientHeight];
    this.controls.pointerHover({ x, y, button: event.button } as PointerEvent);
    return this.controls.axis !== null;
  }

  /// Chooses the next body, for keys.
  chooseNext(): void {
    const bodies = (this.events.document()?.colliders ?? []).flatMap((of, i) => (poseOf(of) ? [i] : []));
    this.choose(bodies.find((i) => i > (this.chosen ?? -1)) ?? bodies[0] ?? null);
  }

  choose(index: number | null): void {
    this.chosen = this.events.mayEdit() ? index : null;
    this.follow();
    this.tell();
    this.stage.invalidate();
  }

  /// The document has changed: the handles go where the body is now.
  follow(): void {
    if (this.controls.dragging) return;
    const body = this.body();
    const pose = body && poseOf(body);
    if (!pose || body.motion) {
      this.controls.detach();
      if (!pose && this.chosen !== null) this.choose(null);
      return;
    }
    this.proxy.position.copy(pose.place);
    this.proxy.quaternion.copy(pose.turn);
    if (this.controls.object !== this.proxy) this.controls.attach(this.proxy);
    this.tell();
    this.stage.invalidate();
  }

  toggleMode(): void {
    const turns = this.controls.mode === "translate" && !("sphere" in (this.body() ?? {}));
    this.controls.setMode(turns ? "rotate" : "translate");
    this.controls.setSpace(turns ? "local" : "world");
    this.tell();
  }

  /// Moves the body by keys, or turns it: along the axes of the screen.
  nudge(right: number, up: number, away: number): void {
    if (this.chosen === null || this.controls.object !== this.proxy) return;
    const axes = [0, 1, 2].map((k) =>
      this.proxy.position.clone().setFromMatrixColumn(this.stage.camera.matrixWorld, k),
    );
    const far = this.picker.away(this.proxy.position) * step;
    [right, up, -away].forEach((amount, k) => {
      const axis = axes[k] ?? this.proxy.position;
      if (this.controls.mode === "translate") this.proxy.position.addScaledVector(axis, amount * far);
    });
    if (this.controls.mode === "rotate") {
      this.proxy.rotateOnWorldAxis(axes[1] ?? this.proxy.up, right * turnStep);
      this.proxy.rotateOnWorldAxis(axes[0] ?? this.proxy.up, -up * turnStep);
      this.proxy.rotateOnWorldAxis(axes[2] ?? this.proxy.up, away * turnStep);
    }
    this.edited(true);
    this.stage.invalidate();
  }

  private body(): Collider | null {
    return this.chosen === null ? null : (this.events.document()?.colliders[this.chosen] ?? null);
  }

  private edited(ended: boolean): void {
    const body = this.body();
    if (!body || this.chosen === null || (!ended && "mesh" in body)) return;
    const pose = { place: this.proxy.position, turn: this.proxy.quaternion };
    const changes = moved(body, this.chosen, pose).filter(({ path, value }) => !same(body, path, value));
    if (changes.length > 0) this.events.edit(changes);
  }

  private tell(): void {
    const body = this.body();
    if (!body || body.motion) {
      this.hint.say(body && `${body.name} moves by itself; the panel has its motion.`);
      return;
    }
    const turning = this.controls.mode === "rotate";
    const round = "sphere" in body;
    this.hint.say(
      `${body.name}: ${turning ? "turn" : "move"} it by its handles or arrows. Escape ends.`,
      round ? undefined : { label: turning ? "Move" : "Turn", run: () => this.toggleMode() },
    );
  }
}

/// True if the body has this value there already: a drag that only moves must not set angles.
function same(body: Collider, path: string, value: unknown): boolean {
  const now = path
    .split("/")
    .slice(3)
    .reduce<unknown>((of, key) => (of as Record<string, unknown> | undefined)?.[key], body);
  if (!Array.isArray(now) || !Array.isArray(value)) return false;
  return now.every((each, k) => Math.abs(Number(each) - Number(value[k])) < 1e-4);
}
