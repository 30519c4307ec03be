// The frames on their way to the screen: the newest that came is drawn, acknowledged and counted at the next animation
// frame. The server sends no more than what is acknowledged.
import type { FieldName, Frame, ShownFrame } from "./link/protocol";
import type { MovedCollider } from "./link/scene_types";
import { KeptFrames } from "./link/kept_frames";
import { hook } from "./test_hook";
import type { Stage } from "./view/stage";

interface PictureEvents {
  acknowledge(sequence: number): void;
  ticked(): void; ///< an animation frame, whether or not it shows a new one of the cloth
  drawn(frame: ShownFrame): void;
  first(): void; ///< the first frame is on screen
}

export class Picture {
  held = false; ///< what comes is acknowledged, and not drawn: another scene is about to come
  moved: MovedCollider[] = []; ///< colliders' places for the next frame
  readonly kept = new KeptFrames();
  private latest: ShownFrame | null = null;
  private lookedAt: ShownFrame | null = null; // an earlier frame, which is shown instead of what comes
  private unseen = false; // it is not on screen yet
  private fitNext = false;

  constructor(private readonly events: PictureEvents) {}

  /// Takes a frame from the link.
  take(frame: Frame, field: FieldName | null): void {
    hook.framesReceived++;
    if (this.held) {
      this.events.acknowledge(frame.header.sequence);
      return;
    }
    const replaced = this.latest; // a newer frame came before this one was drawn
    if (replaced && !document.hidden) this.events.acknowledge(replaced.header.sequence);
    this.latest = { ...frame, field, moved: this.moved };
    this.kept.take(this.latest, performance.now());
  }

  /// Shows a frame that was recorded, and goes on showing it; null: what comes is shown again.
  lookAt(frame: ShownFrame | null): void {
    if (!frame && this.lookedAt) this.latest ??= this.kept.all.at(-1)?.frame ?? null;
    this.lookedAt = frame;
    this.unseen = frame !== null;
  }

  /// Draws the newest frame once more: something else was drawn in its place.
  again(): void {
    if (this.lookedAt) this.unseen = true;
    else this.latest ??= this.kept.all.at(-1)?.frame ?? null;
  }

  /// What is on screen is of the present, not looked at again.
  get live(): boolean {
    return this.lookedAt === null;
  }

  /// The next frame is the first of another cloth: it is fitted into the view.
  fitAtNext(): void {
    this.fitNext = true;
  }

  /// Draws on this stage from now on.
  start(stage: Stage): void {
    const animate = (): void => {
      requestAnimationFrame(animate);
      this.animate(stage);
    };
    requestAnimationFrame(animate);
  }

  private animate(stage: Stage): void {
    const arrived = this.latest;
    this.latest = null;
    if (this.lookedAt && arrived) this.events.acknowledge(arrived.header.sequence);
    const frame = this.lookedAt ? (this.unseen ? this.lookedAt : null) : arrived;
    this.unseen = false;
    const shown = frame !== null && stage.show(frame);
    stage.draw();
    this.events.ticked();
    if (!frame) return;
    if (frame !== this.lookedAt) this.events.acknowledge(frame.header.sequence);
    if (!shown) return;
    this.events.drawn(frame);
    hook.framesDrawn++;
    hook.lastFrame = frame;
    hook.simTime = frame.header.time;
    hook.step = frame.header.step;
    if (hook.firstFrameAt === 0) {
      hook.firstFrameAt = performance.now();
      this.events.first();
    }
    if (this.fitNext) stage.fit();
    this.fitNext = false;
  }
}
