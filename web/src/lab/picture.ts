// The server's drawing in the page. Its marks can be pointed at, walked with the arrow keys and chosen.
import { make, makeButton } from "./dom";
import { withNames } from "../panel/methods";

/// A tooltip. `action` says what a click on the mark does, `compare` what the key C does.
export interface Tip {
  title: string;
  lines: string[];
  action: string | null;
  compare?: string | null;
}

/// Events of the marks. A mark's key is its data-index, its place in the result's list; for a cell of a map it is
/// "METHOD/COLUMN/CELL".
export interface PictureEvents {
  /// The tooltip of a mark; null if it has none.
  tip(key: string): Tip | null;
  choose(key: string): void;
  compare?(key: string): void;
  /// The curve of a mark and its place along the curve, above 0: the arrow keys go in this order.
  order(key: string): { curve: string; along: number };
}

const markSelector = "[data-index], [data-cell]";

function keyOf(mark: SVGElement): string {
  const { index, column, cell } = mark.dataset;
  return index ?? `${mark.closest<SVGElement>("[data-method]")?.dataset.method}/${column}/${cell}`;
}

const reach = 18; // [px]: farthest distance from the pointer to a mark that it points at
const drawingNamespace = "http://www.w3.org/2000/svg";

/// A place in values; `panel` is the method whose panel it lies in, if the drawing has one for each method.
export interface Place {
  x: number;
  y: number;
  panel?: string;
}

export class Picture {
  readonly element = make("div", "lab-picture");
  private readonly scroller = make("div", "lab-scroller"); // scrolls where the window is too narrow for the drawing
  private readonly slide = make("p", "lab-slide", "The drawing is wider than this window: slide it sideways.");
  private readonly tooltip = make("div", "lab-tip");
  private drawing: SVGSVGElement | null = null;
  private marks = new Map<string, SVGElement>(); // marks that have a tooltip
  private shown = ""; // key of the mark whose tooltip is up
  private pinned = false; // true after a tap: the tooltip stays until a touch elsewhere
  private focused = "";
  private redrawing = false;
  private place: Place | null = null; // place of the present setting

  /// `moves`: mark the present setting here as it changes, and remove the mark that the drawing came with.
  constructor(
    private readonly events: PictureEvents,
    private readonly moves = false,
  ) {
    this.tooltip.hidden = true;
    this.tooltip.setAttribute("role", "tooltip");
    this.slide.hidden = true;
    this.element.append(this.slide, this.scroller, this.tooltip);
    new ResizeObserver(() => this.tellSlide()).observe(this.scroller);
    this.scroller.addEventListener("scroll", () => this.point(this.shown, this.pinned), { passive: true });
    this.element.addEventListener("pointermove", (event) => {
      if (event.pointerType !== "touch") this.point(this.nearest(event), false);
    });
    this.element.addEventListener("pointerleave", (event) => {
      if (event.pointerType !== "touch") this.point(this.focused, false);
    });
    this.element.addEventListener("click", (event) => this.click(event as PointerEvent));
    this.element.addEventListener("keydown", (event) => this.key(event));
  }

  get empty(): boolean {
    return this.drawing === null;
  }

  /// Replaces the drawing and keeps the mark that is pointed at.
  show(text: string, title: string): void {
    const root = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
    if (root.namespaceURI !== drawingNamespace || root.localName !== "svg")
      throw new Error("the server's drawing is not SVG");
    const drawing = document.importNode(root, true) as unknown as SVGSVGElement;
    this.prepare(drawing, title);
    const hadFocus = this.drawing?.contains(document.activeElement) ?? false;
    this.redrawing = true; // a removed mark loses the focus while it is still in the document
    if (this.drawing) this.drawing.replaceWith(drawing);
    else this.scroller.append(drawing);
    this.redrawing = false;
    this.drawing = drawing;
    this.tellSlide();
    this.marks = new Map([...drawing.querySelectorAll<SVGElement>(markSelector)].map((mark) => [keyOf(mark), mark]));
    this.makeReachable(hadFocus);
    this.drawPresent();
    this.point(this.shown, this.pinned);
  }

  private tellSlide(): void {
    this.slide.hidden = this.scroller.scrollWidth <= this.scroller.clientWidth + 1;
  }

  // Removes what the page says beside the drawing, and the titles that its tooltips replace.
  private prepare(drawing: SVGSVGElement, title: string): void {
    const scripts = "script, foreignObject, style"; // removed for safety; none are expected
    for (const node of drawing.querySelectorAll(`${scripts}, .heading, .notes, [data-index] title, [data-cell] title`))
      node.remove();
    if (this.moves) for (const node of drawing.querySelectorAll(".present:not(.legend *)")) node.remove();
    for (const node of drawing.querySelectorAll("text, title, tspan"))
      for (const words of node.childNodes) if (words instanceof Text) words.data = withNames(words.data);
    const { bodyTop, bodyBottom } = drawing.dataset;
    const [left = 0, , width = 0] = (drawing.getAttribute("viewBox") ?? "").split(/[ ,]+/).map(Number);
    if (bodyTop && bodyBottom)
      drawing.setAttribute("viewBox", `${left} ${bodyTop} ${width} ${Number(bodyBottom) - Number(bodyTop)}`);
    drawing.removeAttribute("width");
    drawing.removeAttribute("height");
    drawing.setAttribute("role", "group");
    drawing.setAttribute("aria-label", title);
  }

  clear(): void {
    this.drawing?.remove();
    this.drawing = null;
    this.marks.clear();
    this.focused = "";
    this.point("", false);
  }

  /// Marks the present setting at these values; null removes the mark.
  showPresent(place: Place | null): void {
    this.place = place;
    this.drawPresent();
  }

  private makeReachable(hadFocus: boolean): void {
    for (const [key, mark] of this.marks) {
      const tip = this.events.tip(key);
      if (!tip) {
        this.marks.delete(key);
        continue;
      }
      mark.setAttribute("role", "button");
      mark.setAttribute("aria-label", [tip.title, ...tip.lines].join(", "));
      mark.setAttribute("tabindex", "-1");
      mark.addEventListener("focus", () => {
        this.focused = key;
        this.point(key, false);
      });
      mark.addEventListener("blur", () => {
        if (this.redrawing) return;
        this.focused = "";
        this.point("", false);
      });
    }
    const first = this.marks.get(this.focused) ?? [...this.marks.values()][0];
    first?.setAttribute("tabindex", "0");
    if (hadFocus && this.focused !== "") first?.focus({ preventScroll: true });
  }

  /// The key of the mark under the pointer, else of the nearest one within `reach`; "" if there is none.
  private nearest(event: MouseEvent): string {
    const under = (event.target as Element).closest<SVGElement>(markSelector);
    if (under && this.marks.has(keyOf(under))) return keyOf(under);
    let best = { key: "", distance: reach };
    for (const [key, mark] of this.marks) {
      const { left, right, top, bottom } = mark.getBoundingClientRect();
      const distance = Math.hypot((left + right) / 2 - event.clientX, (top + bottom) / 2 - event.clientY);
      if (distance < best.distance) best = { key, distance };
    }
    return best.key;
  }

  private click(event: PointerEvent): void {
    if ((event.target as Element).closest(".lab-tip")) return;
    const key = this.nearest(event);
    if (event.pointerType === "touch")
      this.point(key, true); // a finger hides the mark it points at: the first tap shows the tooltip
    else if (key !== "") this.events.choose(key);
  }

  private key(event: KeyboardEvent): void {
    const mark = (event.target as Element).closest<SVGElement>(markSelector);
    if (!mark || event.ctrlKey || event.metaKey || event.altKey) return;
    const key = keyOf(mark);
    if (event.key === "Enter" || event.key === " ") this.events.choose(key);
    else if (event.key.toLowerCase() === "c" && this.events.tip(key)?.compare) this.events.compare?.(key);
    else if (event.key === "ArrowLeft" || event.key === "ArrowRight")
      this.walk(key, event.key === "ArrowRight" ? 1 : -1);
    else if (event.key === "ArrowUp" || event.key === "ArrowDown") this.change(key, event.key === "ArrowDown" ? 1 : -1);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /// Moves the focus to the next mark on the same curve.
  private walk(from: string, direction: number): void {
    const { curve } = this.events.order(from);
    const same = [...this.marks.keys()].filter((key) => this.events.order(key).curve === curve);
    same.sort((a, b) => this.events.order(a).along - this.events.order(b).along);
    this.focus(same[same.indexOf(from) + direction]);
  }

  /// Moves the focus to the nearest mark on the next curve.
  private change(from: string, direction: number): void {
    const here = this.events.order(from);
    const keys = [...this.marks.keys()];
    const curves = [...new Set(keys.map((key) => this.events.order(key).curve))];
    const next = curves[(curves.indexOf(here.curve) + direction + curves.length) % curves.length];
    const away = (key: string): number => Math.abs(Math.log(this.events.order(key).along / here.along));
    this.focus(keys.filter((key) => this.events.order(key).curve === next).sort((a, b) => away(a) - away(b))[0]);
  }

  private focus(key: string | undefined): void {
    const mark = key === undefined ? undefined : this.marks.get(key);
    if (!mark) return;
    for (const other of this.marks.values()) other.setAttribute("tabindex", "-1");
    mark.setAttribute("tabindex", "0");
    mark.focus({ preventScroll: true });
  }

  private point(key: string, pinned: boolean): void {
    const mark = this.marks.get(key);
    const tip = mark ? this.events.tip(key) : null;
    for (const other of this.marks.values()) other.classList.toggle("pointed", other === mark);
    this.shown = tip ? key : "";
    this.pinned = pinned;
    this.element.classList.toggle("pointing", tip !== null);
    this.tooltip.hidden = !tip;
    if (!mark || !tip) return;
    const lines: HTMLElement[] = tip.lines.map((line) => make("span", "", line));
    const doing = [
      { text: tip.action, by: "Click", run: () => this.events.choose(key) },
      { text: tip.compare, by: "C", run: () => this.events.compare?.(key) },
    ];
    for (const { text, by, run } of doing) {
      if (!text) continue;
      lines.push(pinned ? this.tipButton(text, run) : make("span", "lab-tip-hint", `${by}: ${text.toLowerCase()}`));
    }
    this.tooltip.replaceChildren(make("b", "", tip.title), ...lines);
    this.tooltip.classList.toggle("pinned", pinned);
    this.putBeside(mark);
  }

  private tipButton(text: string, run: () => void): HTMLButtonElement {
    return makeButton(text, "lab-small", () => {
      this.point("", false);
      run();
    });
  }

  // Places the tooltip above the mark, or below it if there is no room above, and inside the picture.
  private putBeside(mark: SVGElement): void {
    const frame = this.element.getBoundingClientRect();
    const at = mark.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = this.tooltip;
    const left = Math.max(2, Math.min((at.left + at.right) / 2 - frame.left - width / 2, frame.width - width - 2));
    const above = at.top - frame.top - height - 8;
    this.tooltip.style.left = `${left}px`;
    this.tooltip.style.top = `${above >= 0 ? above : at.bottom - frame.top + 8}px`;
  }

  private drawPresent(): void {
    this.drawing?.querySelector(".lab-present")?.remove();
    if (!this.drawing || !this.place) return;
    const { panel, x: valueX, y: valueY } = this.place;
    const holder =
      panel === undefined
        ? this.drawing
        : this.drawing.querySelector<SVGElement>(`.panel[data-method="${CSS.escape(panel)}"]`);
    const x = holder && along(holder, "x", "left", "right", valueX);
    const y = holder && along(holder, "y", "bottom", "top", valueY);
    if (!holder || x === null || y === null) return;
    const marker = document.createElementNS(drawingNamespace, "g");
    marker.setAttribute("class", "lab-present");
    for (const radius of [11, 11, 4]) {
      const circle = document.createElementNS(drawingNamespace, "circle");
      circle.setAttribute("cx", String(x));
      circle.setAttribute("cy", String(y));
      circle.setAttribute("r", String(radius));
      marker.append(circle);
    }
    holder.append(marker);
  }
}

/// Where a value lies along an axis, in units of the view box. The element's data attributes give the scale; a value
/// beyond its range lies on the edge. null if the attributes or the value are no numbers.
function along({ dataset }: SVGElement, axis: "x" | "y", start: string, end: string, value: number): number | null {
  const [low, high, from, to] = [`${axis}0`, `${axis}1`, start, end].map((name) => Number(dataset[name] ?? NaN)) as [
    number,
    number,
    number,
    number,
  ];
  const scaled = dataset[`${axis}Scale`] === "linear" ? (one: number): number => one : Math.log;
  const share = (scaled(value) - scaled(low)) / (scaled(high) - scaled(low));
  return Number.isFinite(share + from + to) ? from + Math.min(1, Math.max(0, share)) * (to - from) : null;
}
