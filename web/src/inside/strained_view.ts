// Draws springs and finite elements, and marks those that are strained most.
import { Group, Vector3, type PerspectiveCamera } from "three";
import type { Choices } from "./choices";
import { mostWorst } from "./choices";
import { ThickLines, ThinLines } from "./lines";
import type { ShownPlaces } from "./shown_places";
import {
  strainElements,
  strainRounding,
  strainSprings,
  strainText,
  worst,
  type Elements,
  type Springs,
} from "./strain";
import { compressed, stretched, type LineKind } from "./tones";

const springKinds = ["structural", "shear", "bend"] as const;

/// What is strained most among what is shown, in words and on the screen.
export interface Largest {
  strain: number;
  rounding: number; ///< as frames have places in whole steps
  what: string; ///< `structural spring 3–28`
  middle: Vector3; ///< [m]
}

export class StrainedView {
  readonly object = new Group();
  largest: Largest | null = null;
  private readonly thin: Record<(typeof springKinds)[number] | "elements", ThinLines>;
  private readonly thick = new ThickLines(3 * mostWorst, 7);
  private springs: Springs | null = null;
  private elements: Elements | null = null;

  constructor() {
    this.thin = {
      structural: new ThinLines(),
      shear: new ThinLines(),
      bend: new ThinLines(),
      elements: new ThinLines(),
    };
    this.object.add(...Object.values(this.thin).map(({ object }) => object), this.thick.object);
  }

  /// Takes what inspect.springs and inspect.elements told; null: not told, or of another cloth.
  take(springs: Springs | null, elements: Elements | null): void {
    this.springs = springs;
    this.elements = elements;
    springKinds.forEach((kind, number) => {
      const index: number[] = [];
      springs?.kind.forEach((of, i) => {
        if (of === number) index.push(springs.vertices[2 * i] as number, springs.vertices[2 * i + 1] as number);
      });
      this.thin[kind].index = springs && Uint32Array.from(index);
    });
    const sides: number[] = [];
    for (let i = 0; elements && i < elements.vertices.length; i += 3) {
      const [a, b, c] = elements.vertices.subarray(i, i + 3) as unknown as [number, number, number];
      sides.push(a, b, b, c, c, a);
    }
    this.thin.elements.index = elements && Uint32Array.from(sides);
  }

  paint(tones: Record<LineKind, { colour: string; opacity: number }>): void {
    for (const [kind, lines] of Object.entries(this.thin)) lines.look = tones[kind as LineKind];
  }

  /// Shows what is chosen where the frame has it.
  show(shown: ShownPlaces, choices: Choices): void {
    for (const kind of springKinds) this.thin[kind].object.visible = choices[kind] && this.springs !== null;
    this.thin.elements.object.visible = choices.elements && this.elements !== null;
    for (const lines of Object.values(this.thin)) if (lines.object.visible) lines.positions = shown.attribute;
    this.largest = null;
    const count = this.mark(shown, choices);
    this.thick.object.visible = count > 0;
    this.thick.draw(count);
  }

  // Returns the number of thick lines. An element is three of them.
  private mark({ places, frame }: ShownPlaces, choices: Choices): number {
    let line = 0;
    const draw = (a: number, b: number, strain: number): void => {
      this.thick.from.set(places.subarray(3 * a, 3 * a + 3), 3 * line);
      this.thick.to.set(places.subarray(3 * b, 3 * b + 3), 3 * line);
      this.thick.tone.set(strain < 0 ? compressed : stretched, 3 * line++);
    };
    const tell = (strain: number, length: number, what: string, corners: Uint32Array): void => {
      if (this.largest && Math.abs(this.largest.strain) >= Math.abs(strain)) return;
      const middle = new Vector3();
      for (const vertex of corners) middle.add(new Vector3(...places.subarray(3 * vertex, 3 * vertex + 3)));
      middle.divideScalar(corners.length);
      const rounding = strainRounding(frame?.header.boxExtent ?? [0], length);
      this.largest = { strain, rounding, what: `${what} ${[...corners].join("–")}`, middle };
    };
    const { springs, elements } = this;
    if (springs && springKinds.some((kind) => choices[kind])) {
      strainSprings(springs, places);
      const chosen = springKinds.map((kind) => choices[kind]);
      const found = worst(springs, Math.max(choices.worst, 1), (i) => chosen[springs.kind[i] as number] === true);
      found.forEach((i, rank) => {
        const strain = springs.strain[i] as number,
          ends = springs.vertices.subarray(2 * i, 2 * i + 2);
        if (rank < choices.worst) draw(ends[0] as number, ends[1] as number, strain);
        if (rank > 0) return;
        const kind = springKinds[springs.kind[i] as number] as string;
        tell(strain, springs.restLength[i] as number, `${kind} spring`, ends);
      });
    }
    if (elements && choices.elements) {
      strainElements(elements, places);
      worst(elements, Math.max(choices.worst, 1), () => true).forEach((i, rank) => {
        const strain = elements.strain[i] as number;
        const corners = elements.vertices.subarray(3 * i, 3 * i + 3);
        const [a, b, c] = corners as unknown as [number, number, number];
        if (rank < choices.worst) [draw(a, b, strain), draw(b, c, strain), draw(c, a, strain)];
        const share = Math.max(...elements.shares.subarray(4 * i, 4 * i + 4).map(Math.abs));
        if (rank === 0) tell(strain, 1 / share, "element", corners);
      });
    }
    return line;
  }

  resize(width: number, height: number): void {
    this.thick.resize(width, height);
  }

  /// Where the largest is in the picture [CSS pixels], with its text; null if there is none, or it is behind the eye.
  label(camera: PerspectiveCamera, width: number, height: number): { x: number; y: number; text: string } | null {
    if (!this.largest) return null;
    const at = this.largest.middle.clone().project(camera);
    if (at.z > 1) return null;
    return {
      x: (0.5 + 0.5 * at.x) * width,
      y: (0.5 - 0.5 * at.y) * height,
      text: strainText(this.largest.strain),
    };
  }
}
