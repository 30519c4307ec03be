// A text with line numbers, one of which can be marked as wrong.
import { make } from "../lab/dom";

export class Editor {
  readonly area = make("textarea", "text-area");
  readonly element: HTMLElement;
  private readonly numbers = make("div", "text-numbers");
  private readonly band = make("i", "text-band");
  private lines = 0;
  private wrong = 0; // the marked line; 0: none

  constructor(changed: () => void) {
    this.area.spellcheck = false;
    this.area.wrap = "off";
    this.area.autocapitalize = "off";
    this.area.setAttribute("aria-label", "The scene as JSON");
    this.numbers.setAttribute("aria-hidden", "true");
    this.element = make("div", "text-editor", this.numbers, this.band, this.area);
    this.area.addEventListener("scroll", () => this.follow(), { passive: true });
    this.area.addEventListener("input", () => {
      this.number();
      this.mark(0);
      changed();
    });
  }

  get text(): string {
    return this.area.value;
  }

  /// Another text, at the same place of it.
  set text(text: string) {
    const { scrollTop, scrollLeft } = this.area;
    this.area.value = text;
    this.area.scrollTop = scrollTop;
    this.area.scrollLeft = scrollLeft;
    this.number();
    this.mark(0);
  }

  /// Marks a line as wrong; 0: none is.
  mark(line: number): void {
    this.wrong = line;
    this.area.setAttribute("aria-invalid", String(line > 0));
    this.band.hidden = line === 0;
    this.follow();
  }

  /// Selects a line, in the middle of what is seen.
  go(line: number): void {
    const before = this.text.split("\n").slice(0, line - 1);
    const start = before.reduce((sum, each) => sum + each.length + 1, 0);
    const end = this.text.indexOf("\n", start);
    this.area.focus();
    this.area.setSelectionRange(start, end < 0 ? this.text.length : end);
    this.area.scrollTop = (line - 1) * this.lineHeight - this.area.clientHeight / 2;
    this.area.scrollLeft = 0;
    this.follow();
  }

  private get lineHeight(): number {
    return Number.parseFloat(getComputedStyle(this.area).lineHeight);
  }

  private number(): void {
    const lines = this.text.split("\n").length;
    if (lines === this.lines) return;
    this.lines = lines;
    this.numbers.textContent = Array.from({ length: lines }, (_, i) => i + 1).join("\n");
  }

  private follow(): void {
    const up = this.area.scrollTop;
    this.numbers.style.transform = `translateY(${-up}px)`;
    this.band.style.transform = `translateY(${(this.wrong - 1) * this.lineHeight - up}px)`;
  }
}
