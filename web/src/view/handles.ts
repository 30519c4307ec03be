// Handles that move, turn and scale the body or the cloth that is chosen: three.js' TransformControls on an empty
// object, whose pose becomes edits of the scene. What starts the cloth anew is put in place when the drag ends.
import { Object3D, Vector3 } from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import { Ghost } from "./ghost";
import { type Choice, type Handled, handled, type Mode } from "./handled";
import { HandHint } from "./hand_hint";
import { Picker } from "./picking";
import { boxOf } from "./places";
import { inMesh, poseOf } from "./poses";
import type { Stage } from "./stage";
import type { Operation, SceneDocument } from "../link/scene_types";

export interface HandleEvents {
  edit(operations: Operation[], keepStable?: boolean): void;
  document(): SceneDocument | null;
  mayEdit(): boolean;
}

const step = 0.02; // share of the view's distance that a key moves it by
const turnStep = Math.PI / 36;
const scaleStep = 1.05;
const words: Record<Mode, string> = { translate: "Move", rotate: "Turn", scale: "Scale" };

export class Handles {
  private readonly controls: TransformControls;
  private readonly proxy = new Object3D();
  private readonly picker: Picker;
  private readonly hint = new HandHint("body");
  private readonly ghost: Ghost;
  private chosen: Choice | null = null;

  constructor(
    private readonly stage: Stage,
    private readonly events: HandleEvents,
  ) {
    this.picker = new Picker(stage);
    this.ghost = new Ghost(stage);
    this.controls = new TransformControls(stage.camera, stage.canvas);
    this.controls.setSize(0.8);
    this.proxy.add(this.ghost.object);
    stage.scene.add(this.proxy, this.controls.getHelper());
    this.controls.addEventListener("change", () => stage.invalidate());
    this.controls.addEventListener("objectChange", () => this.dragged());
    this.controls.addEventListener("dragging-changed", () => {
      const { dragging } = this.controls;
      stage.controls.enabled = !dragging;
      if (dragging && this.chosen?.of === "cloth") this.ghost.show(this.chosen.index, this.proxy);
      if (dragging) return;
      this.ghost.hide();
      this.edited(true);
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
    const now = this.chosen?.of === "body" ? this.chosen.index : -1;
    const next = bodies.find((i) => i > now) ?? bodies[0];
    this.choose(next === undefined ? null : { of: "body", index: next });
  }

  /// Chooses a cloth that is as it starts; the handles are in its middle.
  chooseCloth(index: number): void {
    const { frame, cloth } = this.stage;
    const range = cloth.topology?.cloths[index];
    const of = this.events.document()?.cloths[index];
    if (!frame || !range || !of) return;
    const middle = boxOf(frame, range).getCenter(new Vector3());
    this.choose({ of: "cloth", index, middle: inMesh(of, middle) });
  }

  choose(choice: Choice | null): void {
    this.chosen = this.events.mayEdit() ? choice : null;
    const modes = this.held()?.modes ?? [];
    if (!modes.includes(this.controls.mode)) this.setMode("translate");
    this.follow();
    this.tell();
    this.stage.invalidate();
  }

  /// The document has changed: the handles go where it is now.
  follow(): void {
    if (this.controls.dragging) return;
    const held = this.held();
    if (!held || held.moves) {
      this.controls.detach();
      if (!held && this.chosen !== null) this.choose(null);
      return;
    }
    this.proxy.position.copy(held.pose.place);
    this.proxy.quaternion.copy(held.pose.turn);
    this.proxy.scale.setScalar(held.pose.scale);
    if (this.controls.object !== this.proxy) this.controls.attach(this.proxy);
    this.tell();
    this.stage.invalidate();
  }

  toggleMode(): void {
    const modes = this.held()?.modes ?? [];
    this.setMode(modes[(modes.indexOf(this.controls.mode) + 1) % modes.length] ?? "translate");
    this.tell();
  }

  private setMode(mode: Mode): void {
    this.controls.setMode(mode);
    this.controls.setSpace(mode === "translate" ? "world" : "local");
  }

  /// Moves it by keys, turns or scales it: along the axes of the screen.
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
    if (this.controls.mode === "scale") this.proxy.scale.multiplyScalar(scaleStep ** (right + up));
    this.edited(true);
    this.stage.invalidate();
  }

  private held(): Handled | null {
    const document = this.events.document();
    return document && this.chosen ? handled(document, this.chosen) : null;
  }

  // Scaled along one axis, it is along all: the document has one scale.
  private dragged(): void {
    if (this.controls.mode === "scale") {
      const before = this.held()?.pose.scale ?? 1;
      const factors = this.proxy.scale.toArray().map((each) => Math.max(each / before, 1e-3));
      const most = factors.reduce((a, b) => (Math.abs(Math.log(b)) > Math.abs(Math.log(a)) ? b : a));
      this.proxy.scale.setScalar(before * most);
    }
    this.edited(false);
  }

  private edited(ended: boolean): void {
    const held = this.held();
    if (!held || (!ended && held.whole)) return;
    const { position: place, quaternion: turn, scale } = this.proxy;
    const changes = held.edits({ place, turn, scale: scale.x });
    if (changes.length > 0) this.events.edit(changes, this.chosen?.of === "cloth");
  }

  private tell(): void {
    const held = this.held();
    if (!held || held.moves) {
      this.hint.say(held && `${held.name} moves by itself; the panel has its motion.`);
      return;
    }
    const { mode } = this.controls;
    const { modes } = held;
    const next = modes[(modes.indexOf(mode) + 1) % modes.length] ?? mode;
    this.hint.say(
      `${held.name}: ${words[mode].toLowerCase()} it by its handles or arrows. Escape ends.`,
      next === mode ? undefined : { label: words[next], run: () => this.toggleMode() },
    );
  }
}
