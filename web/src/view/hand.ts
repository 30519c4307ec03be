// The hand on the picture: pulling the cloth, the handles of bodies, and the keys of both.
import { BodyDoor } from "./body_door";
import type { BodyEvents } from "./body_handles";
import { Grab, type GrabEvents, type HandAt } from "./grab";
import { bindGrabKeys } from "./grab_keys";
import { GrabPointers } from "./grab_pointers";
import type { Stage } from "./stage";

export type HandHost = Omit<GrabEvents, "took"> & BodyEvents;

export class Hand {
  private readonly grab: Grab;
  private readonly bodies: BodyDoor;

  constructor(stage: Stage, host: HandHost) {
    const { notify, patch, document, mayGrab } = host;
    this.bodies = new BodyDoor(stage, host);
    this.grab = new Grab(stage, { notify, patch, document, mayGrab, took: () => this.bodies.leave() });
    new GrabPointers(stage, this.grab, {
      busy: (event) => this.bodies.takes(event),
      clicked: (x, y) => this.bodies.click(x, y),
    });
    bindGrabKeys(this.grab, this.bodies);
  }

  /// True while it holds the cloth.
  get holding(): boolean {
    return this.grab.holding;
  }

  tick(): void {
    this.grab.tick();
  }
  greeted(client: number): void {
    this.grab.greeted(client);
  }
  told(hands: HandAt[]): void {
    this.grab.told(hands);
  }
  lost(): void {
    this.grab.lost();
  }
  /// The document has changed.
  sceneChanged(): void {
    this.bodies.follow();
  }
}
