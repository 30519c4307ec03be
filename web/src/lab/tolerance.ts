// The field for a tolerance: in percent of the cloth's size, with the length that this is.
import { labelled, make, makeButton, makeNumber, numberIn } from "./dom";
import { lengthText } from "../panel/length";
import type { Cloth, SceneDocument } from "../link/scene_types";

const presets = ["1", "0.1", "0.01"]; // [%]
const radians = Math.PI / 180;

/// The largest extent along an axis of a grid at rest [m]; null: the document does not say how large the mesh is.
function extentOf({ mesh, transform: { rotate, scale } }: Cloth): number | null {
  if (!("grid" in mesh)) return null;
  const [x, y, z] = rotate.map((angle) => angle * radians) as [number, number, number];
  // The first and the third column of the turn about x, then y, then z: a grid lies in the plane of x and z.
  const along = [Math.cos(y) * Math.cos(z), Math.cos(y) * Math.sin(z), -Math.sin(y)];
  const across = [
    Math.cos(x) * Math.sin(y) * Math.cos(z) + Math.sin(x) * Math.sin(z),
    Math.cos(x) * Math.sin(y) * Math.sin(z) - Math.sin(x) * Math.cos(z),
    Math.cos(x) * Math.cos(y),
  ];
  const { width, height } = mesh.grid;
  return (
    scale * Math.max(...along.map((part, axis) => Math.abs(part) * width + Math.abs(across[axis] as number) * height))
  );
}

/// The size of which the lab's errors are shares [m]: the largest extent of a cloth at rest; null: not known here.
export function sizeOf({ cloths }: SceneDocument): number | null {
  const extents = cloths.map(extentOf);
  return extents.includes(null) ? null : Math.max(...(extents as number[]));
}

/// A share of the cloth's size in words: "1 % of the cloth's size = 10 mm".
export function toleranceText(share: number, size: number | null): string {
  const percent = `${Number((100 * share).toPrecision(3))} % of the cloth's size`;
  return size === null ? percent : `${percent} = ${lengthText(share * size)}`;
}

export class ToleranceField {
  readonly element: HTMLElement;
  private readonly input = makeNumber("1", "1");
  private readonly words = make("span");
  private size: number | null = null;

  constructor() {
    this.input.setAttribute("aria-label", "Tolerance");
    this.input.oninput = () => this.tell();
    const buttons = presets.map((percent) =>
      makeButton(`${percent} %`, "lab-small", () => {
        this.input.value = percent;
        this.tell();
      }),
    );
    const field = labelled("Tolerance", this.input, "RMS distance of the vertices to the exact motion");
    this.element = make("div", "lab-tolerance", field, this.words, ...buttons);
    this.tell();
  }

  /// The scene has changed.
  follow(document: SceneDocument | null): void {
    this.size = document && sizeOf(document);
    this.tell();
  }

  /// As a share, (0, 1]; throws an Error that says what is allowed.
  read(): number {
    const percent = numberIn(this.input);
    if (percent === undefined || !(percent > 0 && percent <= 100))
      throw new Error(
        `The tolerance is ${this.input.value.trim() || "empty"}; allowed is more than 0, up to 100 % of the cloth's size.`,
      );
    return percent / 100;
  }

  private tell(): void {
    const share = (numberIn(this.input) ?? Number.NaN) / 100;
    const known = share > 0 && share <= 1 && this.size !== null;
    this.words.textContent = `% of the cloth's size${known ? ` = ${lengthText(share * (this.size as number))}` : ""}`;
  }
}
