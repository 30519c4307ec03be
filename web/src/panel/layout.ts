// Finds the part of the window that is free for the picture. On a narrow window the panel is a sheet at the bottom.
import { button, element } from "./dom";
import { inBrowser } from "../link/kept";
import type { FreeArea } from "../view/framing";

const narrow = matchMedia("(max-width: 760px)");
const leastPictureSides: [number, number] = [120, 120]; // [px]: the least useful width and height of a picture
const leastWordsSides: [number, number] = [220, 60]; // [px]: of a notice
const leastPicture = 0.5; // of the window, beside the open panel
const panelKey = "clothlab-panel"; // in the browser: "open" or "folded", as somebody has chosen

/// The largest rectangle of a window that none of the `covered` rectangles overlaps, at least so wide and
/// high [px]; the whole window if there is none.
function largestFree(covered: DOMRect[], width: number, height: number, [wide, high] = leastPictureSides): FreeArea {
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
          if (right - left < wide || bottom - top < high || (right - left) * (bottom - top) <= best.width * best.height)
            continue;
          const meets = (box: DOMRect): boolean =>
            box.left < right && box.right > left && box.top < bottom && box.bottom > top;
          if (!covered.some(meets)) best = { left, top, width: right - left, height: bottom - top };
        }
  return best.width > 0 ? best : { left: 0, top: 0, width, height };
}

export class Layout {
  private readonly handle = button("sheet-handle");
  private readonly figures = element("figures", HTMLDetailsElement);
  private readonly lab = element("lab", HTMLElement);
  private readonly panel = element("panel", HTMLElement);
  private foldedForLab = false;

  constructor(private readonly changed: () => void) {
    this.handle.onclick = () => this.turnHandle();
    this.foldIfLarge();
    narrow.addEventListener("change", () => this.showSheet(false));
    new ResizeObserver(() => this.tell()).observe(element("hud", HTMLElement));
    addEventListener("resize", () => {
      this.foldIfLarge();
      this.tell();
    });
    // it moves with the sheet
    element("transport", HTMLElement).addEventListener("transitionend", () => this.tell());
    this.placeWords();
  }

  private tell(): void {
    this.placeWords();
    this.changed();
  }

  /// Tells the style sheet where notices and banners cover no card, and so no button.
  private placeWords(): void {
    const bare = document.body.classList.contains("bare");
    const free = largestFree(bare ? [] : this.covered(), innerWidth, innerHeight, leastWordsSides);
    const below = innerHeight - free.top - free.height;
    for (const [name, pixels] of Object.entries({ ...free, below }))
      document.body.style.setProperty(`--free-${name}`, `${pixels}px`);
  }

  /// Folds the panel where the picture beside it would be too small, unless somebody has chosen.
  private foldIfLarge(): void {
    const chosen = inBrowser.get(panelKey);
    document.body.classList.toggle("panel-folded", chosen === "folded");
    if (chosen === null && !narrow.matches) {
      const { width, height } = this.freeArea();
      document.body.classList.toggle("panel-folded", width * height < leastPicture * innerWidth * innerHeight);
    }
    this.tellHandle();
  }

  toggleInterface(): void {
    document.body.classList.toggle("bare");
    this.tell();
  }

  /// The lab's drawer opened or closed. Beside it there is room only for the headline of the figures.
  labToggled(open: boolean): void {
    if (open) this.foldedForLab = this.figures.open;
    if (this.foldedForLab) this.figures.open = !open;
    if (open && narrow.matches) this.showSheet(false);
    this.tell();
  }

  /// A card came or went: the legend of the cloth's colours, the first steps.
  cardToggled(): void {
    this.tell();
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
    this.tell();
  }

  private fold(folded: boolean): void {
    document.body.classList.toggle("panel-folded", folded);
    inBrowser.set(panelKey, folded ? "folded" : "open");
    this.tellHandle();
    this.tell();
  }

  private tellHandle(): void {
    const open = narrow.matches ? document.body.classList.contains("sheet-open") : !this.folded;
    this.handle.setAttribute("aria-expanded", String(open));
  }
}
