// Which part of the window is free for the picture, and the bottom sheet that the panel becomes on a narrow window.
import { button, element } from "./dom";
import type { FreeArea } from "./framing";

const narrow = matchMedia("(max-width: 760px)");
const wide = 1100;  // [px]: from here on there is room for something left of the picture

export class Layout {
  private readonly panel = element("panel", HTMLElement);
  private readonly handle = button("sheet-handle");
  private readonly hud = element("hud", HTMLDetailsElement);
  private readonly lab = element("lab", HTMLElement);
  private foldedForLab = false;

  constructor(private readonly changed: () => void) {
    this.hud.open = !narrow.matches;
    this.handle.onclick = () => this.showSheet(!document.body.classList.contains("sheet-open"));
    narrow.addEventListener("change", () => {
      this.hud.open = !narrow.matches;
      this.showSheet(false);
    });
    addEventListener("resize", () => this.changed());
    element("transport", HTMLElement).addEventListener("transitionend", () => this.changed());  // it rides on the sheet
  }

  toggleInterface(): void {
    document.body.classList.toggle("bare");
    this.changed();
  }

  /// The lab's drawer came or went: beside it there is room for the figures' headline only.
  labToggled(open: boolean): void {
    if (open) this.foldedForLab = this.hud.open;
    if (this.foldedForLab) this.hud.open = !open;
    if (open && narrow.matches) this.showSheet(false);
    this.changed();
  }

  freeArea(): FreeArea {
    const width = innerWidth;
    const height = innerHeight;
    if (document.body.classList.contains("bare")) return { left: 0, top: 0, width, height };
    const { offsetLeft, offsetTop, offsetWidth } = this.lab;  // where it comes to rest: it slides in
    if (!narrow.matches) {
      const bottom = element("transport", HTMLElement).getBoundingClientRect().top;
      const right = this.panel.getBoundingClientRect().left;
      if (!this.lab.hidden && width >= wide) {
        const top = this.hud.getBoundingClientRect().bottom;
        const left = offsetLeft + offsetWidth + 16;
        return { left, top, width: right - 16 - left, height: bottom - 12 - top };
      }
      const left = width < wide ? 0 : this.hud.getBoundingClientRect().right;
      return { left, top: 12, width: right - left, height: bottom - 24 };
    }
    const top = element("headline-fps", HTMLElement).closest("summary")?.getBoundingClientRect().bottom ?? 0;
    const bottom = this.lab.hidden ? element("transport", HTMLElement).getBoundingClientRect().top : offsetTop;
    return { left: 0, top: top + 8, width, height: Math.max(120, bottom - top - 20) };
  }

  private showSheet(open: boolean): void {
    document.body.classList.toggle("sheet-open", open);
    this.handle.setAttribute("aria-expanded", String(open));
    this.changed();
  }
}
