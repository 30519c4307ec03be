// The vertex that this page holds and pulls, whoever moves it: pointers (grab_pointers.ts) or keys (grab_keys.ts). It
// moves in the plane parallel to the screen, and along the view.
import { Vector3 } from "three";
import { HandHint } from "./hand_hint";
import { HandMarks, type Mark } from "./hand_marks";
import { PinChoice, type PinnedVertex } from "./pin_choice";
import { Picker } from "./picking";
import { Places } from "./places";
import type { Stage } from "./stage";
import type { Operation, SceneDocument, Vec3 } from "../link/scene_types";
import { inDocument } from "../link/vertex_numbers";

/// A hand as sim.status tells of it.
export interface HandAt {
  by: number;
  hand: number;
  cloth: number;
  vertex: number; ///< of the cloth
  target: Vec3; ///< [m]
}

export interface GrabEvents {
  notify(method: string, params: Record<string, unknown>): void;
  patch(operations: Operation[]): Promise<unknown>;
  document(): SceneDocument | null;
  mayGrab(): boolean;
  took(): void; ///< the hand has something, or a pin is chosen
}

/// What is held.
export interface Held {
  by: "mouse" | "touch" | "key";
  pointer: number; // -1: keys
  vertex: number; // in the frame
  cloth: number;
  target: Vector3; // [m]
  away: number; // of the target's plane from the camera, along the view [m]
  grabbedAway: number; // the same when it was grabbed [m]
  offset: Vector3; // of the vertex from where the pointer met that plane
  x: number; // of the pointer [CSS pixels]
  y: number;
  since: number; // [ms]
  travelled: boolean; // it has left the place of the press
  stillSince: number; // [ms]
  told: boolean; // the server's status has had it
}

const sendEvery = 8; // [ms]: a mouse may tell of itself 1000 times a second
const pinAfter = 800; // [ms] that a finger is still: then it pins when it leaves
const unknownNumber = "The server has not said yet which vertex of the file this is: P again in a moment.";
const farthest = 4; // times the distance at which the cloth was grabbed

export class Grab {
  held: Held | null = null;
  private others: HandAt[] = [];
  private client = 0;
  private sentAt = 0;
  private unsent = false;
  readonly picker: Picker;
  readonly pins: PinChoice;
  private readonly marks: HandMarks;
  private readonly hint = new HandHint("hand");

  constructor(
    private readonly stage: Stage,
    private readonly events: GrabEvents,
  ) {
    this.picker = new Picker(stage);
    this.pins = new PinChoice(this.picker, () => events.document());
    this.marks = new HandMarks(stage.canvas);
  }

  get holding(): boolean {
    return this.held !== null;
  }
  get holdsByKeys(): boolean {
    return this.held?.by === "key";
  }
  get hasChosen(): boolean {
    return this.pins.chosen !== null;
  }
  get mayGrab(): boolean {
    return this.events.mayGrab();
  }

  hold(vertex: number, place: Vector3, by: Held["by"], pointer: number, x: number, y: number): void {
    const topology = this.picker.topology;
    const cloth = topology?.cloths.findIndex((of) => vertex < of.firstVertex + of.vertexCount) ?? -1;
    if (cloth < 0) return;
    this.choose(null);
    const now = performance.now();
    const away = this.picker.away(place);
    const offset = place.clone().sub(this.picker.through(x, y, away));
    const common = { travelled: false, told: false, since: now, stillSince: now };
    this.held = { by, pointer, vertex, cloth, target: place.clone(), away, grabbedAway: away, offset, x, y, ...common };
    this.events.took();
    this.stage.keepStill(true);
    this.events.notify("grab.start", {
      cloth,
      vertex: vertex - (topology?.cloths[cloth]?.firstVertex ?? 0),
      target: place.toArray(),
    });
    this.sentAt = now;
    this.tellHint();
  }

  /// Lets go of what is held.
  drop(): void {
    if (!this.held) return;
    this.events.notify("grab.end", {});
    this.forget();
  }

  private forget(): void {
    this.held = null;
    this.unsent = false;
    this.stage.keepStill(false);
    this.tellHint();
  }

  /// Pins the held vertex where it is, and lets go once that is done: meanwhile it does not fall.
  pin(): void {
    const { held } = this;
    const document = this.events.document();
    const frame = this.picker.frame;
    if (!held || !document || !frame) return;
    const number = this.numberOf(held);
    if (number === null) {
      this.hint.say(unknownNumber);
      return;
    }
    const place = new Places(frame).of(held.vertex).toArray();
    const path = `/cloths/${held.cloth}/pins/${document.cloths[held.cloth]?.pins.length ?? 0}`;
    const value = { at: `vertex:${number}`, place };
    const ended = () => {
      if (!this.held) this.events.notify("grab.end", {}); // else the hand has let go by taking something else
    };
    this.events.patch([{ op: "add", path, value }]).then(ended, ended);
    this.forget();
  }

  /// The number of what is held in the document; null: the server has not told it yet.
  private numberOf({ cloth, vertex }: Held): number | null {
    const of = this.events.document()?.cloths[cloth];
    const range = this.picker.topology?.cloths[cloth];
    return of && range ? inDocument(vertex, of, range) : null;
  }

  /// Takes off the pin that is chosen.
  unpin(): void {
    const removal = this.pins.removal();
    if (removal.length > 0) void this.events.patch(removal);
    this.choose(null);
  }

  /// Chooses the next pin, for keys.
  chooseNext(): void {
    this.choose(this.pins.next());
  }

  choose(pin: PinnedVertex | null): void {
    this.pins.chosen = pin;
    if (pin) this.events.took();
    this.tellHint();
  }

  /// Holds the vertex in the middle of the view, for keys.
  grabMiddle(): void {
    if (this.held || !this.mayGrab) return;
    const { x, y } = this.picker.middle;
    const hit = this.picker.cloth(x, y, this.pins.vertices) ?? this.picker.nearestVertex(x, y, this.pins.vertices);
    if (!hit) return;
    const at = this.picker.onScreen(hit.place);
    if (at) this.hold(hit.vertex, hit.place, "key", -1, at.x, at.y);
  }

  /// Moves what keys hold, by CSS pixels.
  nudge(x: number, y: number): void {
    if (!this.held) return;
    this.held.x += x;
    this.held.y += y;
    this.aim();
  }

  /// Moves what is held away along the view, by this share of the distance.
  deepen(share: number): void {
    const { held } = this;
    if (!held) return;
    const [least, most] = [held.grabbedAway / farthest, held.grabbedAway * farthest];
    held.away = Math.min(Math.max(held.away * Math.exp(share), least), most);
    held.travelled = true;
    this.aim();
  }

  aim(): void {
    const held = this.held as Held;
    held.target = this.picker.through(held.x, held.y, held.away).add(held.offset);
    this.unsent = true;
    this.send(performance.now());
  }

  private send(now: number): void {
    if (!this.unsent || !this.held || now - this.sentAt < sendEvery) return;
    this.unsent = false;
    this.sentAt = now;
    this.events.notify("grab.move", { target: this.held.target.toArray() });
  }

  /// Called for every animation frame: sends what waits, draws the marks.
  tick(): void {
    this.send(performance.now());
    const { held } = this;
    if (held?.by === "touch") this.tellHint();
    this.marks.show(this.marksNow());
  }

  /// True for a finger that has kept still after its pull: it pins when it leaves.
  still(held: Held): boolean {
    const waited = held.by === "touch" && held.travelled && performance.now() - held.stillSince >= pinAfter;
    return waited && this.numberOf(held) !== null;
  }

  private marksNow(): Mark[] {
    const frame = this.picker.frame;
    const topology = this.picker.topology;
    if (!frame || !topology) return [];
    const places = new Places(frame);
    const mark = (kind: Mark["kind"], vertex: number, target: Vector3 | null, still = false): Mark[] => {
      if (vertex >= places.count) return [];
      const at = this.picker.onScreen(places.of(vertex));
      return at ? [{ kind, at, target: target && this.picker.onScreen(target), still }] : [];
    };
    const { held } = this;
    return [
      ...this.others.flatMap(({ cloth, vertex, target }) =>
        mark("other", (topology.cloths[cloth]?.firstVertex ?? 0) + vertex, new Vector3(...target)),
      ),
      ...(held ? mark("mine", held.vertex, held.target, this.still(held)) : []),
      ...(this.pins.chosen ? mark("pin", this.pins.chosen.vertex, null) : []),
    ];
  }

  greeted(client: number): void {
    this.client = client;
  }

  /// The link is down, or there is another cloth: nothing is held any more.
  lost(): void {
    if (this.held) this.forget();
    this.others = [];
    this.choose(null);
  }

  /// Takes the hands of a status. One of this page that was there and is gone was ended by the server.
  told(hands: HandAt[]): void {
    const mine = hands.some(({ by }) => by === this.client);
    this.others = hands.filter(({ by }) => by !== this.client);
    if (!this.held) return;
    if (mine) this.held.told = true;
    else if (this.held.told) this.forget();
  }

  private tellHint(): void {
    const { held } = this;
    const words = {
      mouse: "P pins it here. Wheel: farther, nearer.",
      touch: "Second finger up or down: farther, nearer. Keep still to pin.",
      key: "Arrows pull, Page Up and Page Down: farther, nearer. P pins, Enter lets go.",
    };
    if (held) this.hint.say(this.still(held) ? "Lift the finger: it is pinned here." : words[held.by]);
    else if (this.pins.chosen && this.events.mayGrab())
      this.hint.say("A pin holds this. Delete or P takes it off.", { label: "Take off", run: () => this.unpin() });
    else this.hint.say(null);
  }
}
