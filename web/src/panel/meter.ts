// A gauge: a bar with a mark, and a line with a word of judgement beside it.

export type Verdict = "good" | "near" | "beyond";
export interface Reading {
  verdict: Verdict;
  word: string;
  share: string;
  spoken: string; ///< for a screen reader
  filled: number; ///< share of the bar
}

const glyphs: Record<Verdict, string> = { good: "✓", near: "!", beyond: "✕" };

/// A new element in `parent`.
export function part(tag: string, className: string, parent: HTMLElement): HTMLElement {
  const made = document.createElement(tag);
  made.className = className;
  parent.append(made);
  return made;
}

export class Meter {
  readonly element = document.createElement("div");
  private readonly track = part("div", "gauge-track", this.element);
  readonly line = part("div", "gauge-line", this.element);
  private readonly glyph = part("span", "gauge-glyph", this.line);
  private readonly word = part("b", "gauge-word", this.line);
  private readonly share = part("span", "gauge-share", this.line);
  // the word for a screen reader, written when it changes
  private readonly spoken = part("span", "visually-hidden", this.element);

  /// `what` is judged, for a screen reader; `end`: the value at the bar's right end; `mark`: that of the mark.
  constructor(
    className: string,
    label: string,
    private readonly what: string,
    private readonly end: number,
    mark: number,
  ) {
    this.element.className = className;
    this.element.hidden = true;
    part("i", "gauge-fill", this.track);
    part("i", "gauge-mark", this.track).style.left = `${(100 * mark) / end}%`;
    this.track.setAttribute("role", "meter");
    this.track.setAttribute("aria-label", label);
    this.track.setAttribute("aria-valuemin", "0");
    this.track.setAttribute("aria-valuemax", String(end));
    this.glyph.setAttribute("aria-hidden", "true");
    this.spoken.setAttribute("role", "status");
  }

  show(now: Reading, title: string): void {
    const { style, dataset } = this.element;
    this.element.hidden = false;
    if (dataset.verdict !== now.verdict) this.spoken.textContent = `${this.what}: ${now.word.toLowerCase()}`;
    dataset.verdict = now.verdict;
    style.setProperty("--filled", `${100 * now.filled}%`);
    this.glyph.textContent = glyphs[now.verdict];
    this.word.textContent = now.word;
    this.share.textContent = now.share;
    this.track.setAttribute("aria-valuenow", (this.end * now.filled).toFixed(3));
    this.track.setAttribute("aria-valuetext", now.spoken);
    this.element.title = title;
  }
}
