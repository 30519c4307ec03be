// The explanation of a parameter: a small box beside its row, on hover, on keyboard focus, and on a tap on its name.

const afterHover = 450; // [ms]
const beforeClosing = 200; // [ms]: the time to move the pointer from the row into the box
const gap = 8; // [px]

export interface Explained {
  title: string;
  says: string[]; ///< sentences
  facts: [name: string, value: string][];
}

export class Explanation {
  private readonly box = document.createElement("div");
  private row: HTMLElement | null = null; // whose box is open
  private timer = 0;
  private hovered = false; // the mouse opened it
  private byKey = false; // the last input came from the keyboard

  constructor(private readonly around: HTMLElement) {
    this.box.id = "explanation";
    this.box.className = "explanation";
    this.box.setAttribute("role", "tooltip");
    this.box.hidden = true;
    (document.querySelector("main") ?? document.body).append(this.box); // inside a landmark
    this.box.addEventListener("pointerenter", () => clearTimeout(this.timer));
    this.box.addEventListener("pointerleave", () => this.left());
    addEventListener("keydown", (event) => this.key(event), { capture: true });
    addEventListener("pointerdown", (event) => this.pressed(event), { capture: true });
    around.addEventListener("scroll", () => this.follow(), { passive: true });
    addEventListener("resize", () => this.follow());
  }

  /// Explains `row` by what `tell` says at that time.
  attach(row: HTMLElement, name: HTMLElement, tell: () => Explained | null): void {
    const open = (): void => this.open(row, tell());
    const openByHover = (): void => {
      open();
      this.hovered = true;
    };
    row.addEventListener("pointerenter", (event) => {
      if (event.pointerType === "mouse" && event.buttons === 0) this.later(this.row ? 80 : afterHover, openByHover);
    });
    row.addEventListener("pointerleave", (event) => {
      if (event.pointerType === "mouse") this.left();
    });
    row.addEventListener("focusin", (event) => {
      (event.target as HTMLElement).setAttribute("aria-describedby", this.box.id);
      if (this.byKey) open();
    });
    row.addEventListener("focusout", () => {
      if (this.row === row) this.close();
    });
    name.addEventListener("click", (event) => {
      if ((event as PointerEvent).pointerType === "mouse") return;
      event.preventDefault(); // the name of a checkbox would switch it
      if (this.row === row) this.close();
      else open();
    });
  }

  close(): void {
    clearTimeout(this.timer);
    this.box.hidden = true;
    this.row = null;
  }

  // The mouse has left the row or the box. What a key or a finger opened stays.
  private left(): void {
    if (this.hovered || !this.row) this.later(beforeClosing, () => this.close());
  }

  private later(milliseconds: number, run: () => void): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(run, milliseconds);
  }

  private key(event: KeyboardEvent): void {
    this.byKey = true;
    if (event.key !== "Escape" || !this.row) return;
    event.stopImmediatePropagation(); // it closes this alone
    this.close();
  }

  private pressed(event: PointerEvent): void {
    this.byKey = false;
    const target = event.target as Node;
    if (!this.box.contains(target) && !this.row?.contains(target)) this.close();
  }

  private open(row: HTMLElement, explained: Explained | null): void {
    clearTimeout(this.timer);
    if (!explained || !row.isConnected) return;
    const title = document.createElement("b");
    title.textContent = explained.title;
    const sentences = explained.says.map((text) => {
      const line = document.createElement("p");
      line.textContent = text;
      return line;
    });
    const facts = document.createElement("dl");
    for (const [name, value] of explained.facts) {
      const pair = document.createElement("div");
      pair.append(document.createElement("dt"), document.createElement("dd"));
      (pair.firstChild as HTMLElement).textContent = name;
      (pair.lastChild as HTMLElement).textContent = value;
      facts.append(pair);
    }
    this.box.replaceChildren(title, ...sentences, facts);
    this.box.hidden = false;
    this.hovered = false;
    this.row = row;
    this.place(row);
  }

  // The row moved: the box goes with it as far as it is seen.
  private follow(): void {
    if (!this.row) return;
    const at = this.row.getBoundingClientRect();
    const seen = this.around.getBoundingClientRect();
    if (at.top >= seen.top - 2 && at.bottom <= seen.bottom + 2) this.place(this.row);
    else this.close();
  }

  // Left of the panel if there is room, else above the row or below it.
  private place(row: HTMLElement): void {
    const at = row.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = this.box;
    const panel = this.around.getBoundingClientRect();
    const inside = (place: number, most: number): number => Math.max(gap, Math.min(place, most - gap));
    const beside = panel.left - width - gap;
    const [left, top] =
      beside >= gap
        ? [beside, at.top - 4]
        : [at.left + 12, at.top - height - 4 >= gap ? at.top - height - 4 : at.bottom + 4];
    this.box.style.left = `${inside(left, innerWidth - width)}px`;
    this.box.style.top = `${inside(top, innerHeight - height)}px`;
  }
}
