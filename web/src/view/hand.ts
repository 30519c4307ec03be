// The hand on the picture: pulling the cloth, the handles of bodies and cloths, and the keys of both.
import { Grab, type GrabEvents, type HandAt } from "./grab";
import { bindGrabKeys } from "./grab_keys";
import { GrabPointers } from "./grab_pointers";
import type { HandleEvents } from "./handles";
import { HandlesDoor } from "./handles_door";
import type { Stage } from "./stage";

export type HandHost = Omit<GrabEvents, "took"> & HandleEvents;

export class Hand {
  private readonly grab: Grab;
  private readonly handles: HandlesDoor;

  constructor(stage: Stage, host: HandHost) {
    const { notify, patch, document, mayGrab } = host;
    this.handles = new HandlesDoor(stage, host);
    this.grab = new Grab(stage, { notify, patch, document, mayGrab, took: () => this.handles.leave() });
    new GrabPointers(stage, this.grab, {
      busy: (event) => this.handles.takes(event),
      clicked: (x, y) => this.handles.click(x, y),
      clickedCloth: (cloth) => this.handles.chooseCloth(cloth),
    });
    bindGrabKeys(this.grab, this.handles);
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
  /// Gives a cloth handles, once it is as it starts.
  chooseCloth(index: number): void {
    this.handles.chooseCloth(index);
  }
  /// Gives a body handles, once the document has it.
  chooseBody(index: number): void {
    this.handles.chooseBody(index);
  }
  /// The document has changed.
  sceneChanged(): void {
    this.handles.follow();
  }
}
