// Finds the part of the window that is free for the picture. On a narrow window the panel is a sheet at the bottom.
import { button, element } from "./dom";
import type { FreeArea } from "../view/framing";

const narrow = matchMedia("(max-width: 760px)");
const low = matchMedia("(max-height: 560px)"); // no room for the card of figures beside a picture
const leastSide = 120; // [px]: the least useful side of a picture

/// The largest rectangle of a window that none of the `covered` rectangles overlaps.
function largestFree(covered: DOMRect[], width: number, height: number): FreeArea {
  const cuts = (ends: number[], most: number) =>
    [...new Set([0, most, ...ends.filter((end) => end > 0 && end < most)])].sort((a, b) => a - b);
  const across = cuts(
    covered.flatMap((box) => [box.left, box.right]),
    width,
  );
  const down = cuts(
    covered.flatMap((box) => [box.top, box.bottom]),
    height,
  );
  let best: FreeArea = { left: 0, top: 0, width: 0, height: 0 };
  for (const left of across)
    for (const right of across)
      for (const top of down)
        for (const bottom of down) {
          if (
            Math.min(right - left, bottom - top) < leastSide ||
            (right - left) * (bottom - top) <= best.width * best.height
          )
            continue;
          const meets = (box: DOMRect): boolean =>
            box.left < right && box.right > left && box.top < bottom && box.bottom > top;
          if (!covered.some(meets)) best = { left, top, width: right - left, height: bottom - top };
        }
  return best.width > 0 ? best : { left: 0, top: 0, width, height };
}

export class Layout {
  private readonly handle = button("sheet-handle");
  private readonly hud = element("hud", HTMLDetailsElement);
  private readonly lab = element("lab", HTMLElement);
  private readonly panel = element("panel", HTMLElement);
  private foldedForLab = false;

  constructor(private readonly changed: () => void) {
    this.foldFigures();
    this.handle.onclick = () => this.turnHandle();
    this.tellHandle();
    narrow.addEventListener("change", () => {
      this.foldFigures();
      this.showSheet(false);
    });
    low.addEventListener("change", () => this.foldFigures());
    this.hud.addEventListener("toggle", () => this.changed());
    addEventListener("resize", () => this.changed());
    // it moves with the sheet
    element("transport", HTMLElement).addEventListener("transitionend", () => this.changed());
  }

  toggleInterface(): void {
    document.body.classList.toggle("bare");
    this.changed();
  }

  /// The lab's drawer opened or closed. Beside it there is room only for the headline of the figures.
  labToggled(open: boolean): void {
    if (open) this.foldedForLab = this.hud.open;
    if (this.foldedForLab) this.hud.open = !open;
    if (open && narrow.matches) this.showSheet(false);
    this.changed();
  }

  /// A card came or went: the legend of the cloth's colours, the first steps.
  cardToggled(): void {
    this.changed();
  }

  freeArea(): FreeArea {
    if (document.body.classList.contains("bare")) return { left: 0, top: 0, width: innerWidth, height: innerHeight };
    return largestFree(this.covered(), innerWidth, innerHeight);
  }

  private covered(): DOMRect[] {
    return [...document.querySelectorAll<HTMLElement>(".card")].flatMap((card) => {
      if (card.hidden || getComputedStyle(card).visibility === "hidden") return [];
      // The lab slides in: its final place counts.
      if (card === this.lab) return [new DOMRect(card.offsetLeft, card.offsetTop, card.offsetWidth, card.offsetHeight)];
      const box = card.getBoundingClientRect();
      // The panel fills after the picture, and its sections fold: it has all of its column, or the picture would move.
      const column = card === this.panel && !narrow.matches && !this.folded;
      return [column ? new DOMRect(box.x, 0, box.width, innerHeight) : box];
    });
  }

  private foldFigures(): void {
    this.hud.open = !narrow.matches && !low.matches;
  }

  /// On a wide window the panel stands open until it is folded; on a narrow one it is a sheet that opens.
  private get folded(): boolean {
    return document.body.classList.contains("panel-folded");
  }

  private turnHandle(): void {
    if (narrow.matches) this.showSheet(!document.body.classList.contains("sheet-open"));
    else this.fold(!this.folded);
  }

  private showSheet(open: boolean): void {
    document.body.classList.toggle("sheet-open", open);
    this.tellHandle();
    this.changed();
  }

  private fold(folded: boolean): void {
    document.body.classList.toggle("panel-folded", folded);
    this.tellHandle();
    this.changed();
  }

  private tellHandle(): void {
    const open = narrow.matches ? document.body.classList.contains("sheet-open") : !this.folded;
    this.handle.setAttribute("aria-expanded", String(open));
  }
}
