// Marks over the picture: each hand's held point with a line to where it pulls, and a ring around a chosen pin. They
// are lines of SVG, sharp at any resolution of the picture, and drawing them costs no frame of WebGL.
import type { Vector2 } from "three";

const svg = "http://www.w3.org/2000/svg";
const heldRadius = 5; // [CSS pixels]
const targetRadius = 9;
const ringRadius = 13;

export interface Mark {
  kind: "mine" | "other" | "pin";
  at: Vector2; ///< [CSS pixels]
  target: Vector2 | null;
  still: boolean; ///< it will be pinned when the finger leaves
}

function circle(at: Vector2, radius: number, name: string): SVGElement {
  const made = document.createElementNS(svg, "circle");
  for (const [key, value] of Object.entries({ cx: at.x, cy: at.y, r: radius }))
    made.setAttribute(key, value.toFixed(1));
  made.setAttribute("class", name);
  return made;
}

function line(from: Vector2, to: Vector2): SVGElement {
  const made = document.createElementNS(svg, "line");
  for (const [key, value] of Object.entries({ x1: from.x, y1: from.y, x2: to.x, y2: to.y }))
    made.setAttribute(key, value.toFixed(1));
  return made;
}

export class HandMarks {
  private readonly layer = document.createElementNS(svg, "svg");
  private shown = "";

  constructor(above: HTMLElement) {
    this.layer.setAttribute("class", "hands");
    this.layer.setAttribute("aria-hidden", "true"); // the hint says it in words
    above.after(this.layer);
  }

  show(marks: Mark[]): void {
    const now = JSON.stringify(marks);
    if (now === this.shown) return;
    this.shown = now;
    this.layer.replaceChildren(
      ...marks.map(({ kind, at, target, still }) => {
        const group = document.createElementNS(svg, "g");
        group.setAttribute("class", `hand ${kind}${still ? " still" : ""}`);
        if (kind === "pin") group.append(circle(at, ringRadius, "ring"));
        else group.append(circle(at, heldRadius, "held"));
        if (target) group.append(line(at, target), circle(target, targetRadius, "target"));
        return group;
      }),
    );
  }
}
