// The gauge of convergence: how far the last step that the server measured is from solved, against what counts as
// solved. Under methods that iterate only.
import { glyphs, part, type Verdict } from "./gauge";
import { lengthText } from "./length";

/// Part of `sim.status`; null: the method does not iterate, or no step is measured yet.
export interface Convergence {
  residual: number; ///< the share left of what there was to solve
  error_m: number;
  tolerance_m: number;
}

const decades = 4; // of the gauge, whose right end is ten times the tolerance
const mark = (decades - 1) / decades;

export interface SolvedReading {
  verdict: Verdict;
  word: string;
  share: string;
  filled: number;
}

/// The gauge's reading: solved up to the tolerance, and lost beyond ten times that.
export function solvedReading({ error_m: error, tolerance_m: tolerance, residual }: Convergence): SolvedReading {
  const ratio = error / tolerance;
  const verdict = ratio > 10 ? "beyond" : ratio > 1 ? "near" : "good";
  return {
    verdict,
    word: verdict === "good" ? "Solved" : "Unsolved",
    share: `to ${lengthText(error)}, ${Number((100 * residual).toPrecision(2))} % left`,
    filled: ratio > 0 ? Math.min(1, Math.max(0, mark + Math.log10(ratio) / decades)) : 0,
  };
}

export class ConvergenceGauge {
  readonly element = document.createElement("div");
  private readonly track = part("div", "gauge-track", this.element);
  private readonly line = part("div", "gauge-line", this.element);
  private readonly glyph = part("span", "gauge-glyph", this.line);
  private readonly word = part("b", "gauge-word", this.line);
  private readonly share = part("span", "gauge-share", this.line);
  // the word for a screen reader, written when it changes
  private readonly spoken = part("span", "visually-hidden", this.element);

  constructor() {
    this.element.className = "convergence";
    this.element.hidden = true;
    part("i", "gauge-fill", this.track);
    part("i", "gauge-mark", this.track).style.left = `${100 * mark}%`;
    this.track.setAttribute("role", "meter");
    this.track.setAttribute("aria-label", "what a step leaves unsolved, against its tolerance");
    this.track.setAttribute("aria-valuemin", "0");
    this.track.setAttribute("aria-valuemax", "1");
    this.glyph.setAttribute("aria-hidden", "true");
    this.spoken.setAttribute("role", "status");
  }

  show(convergence: Convergence | null): void {
    this.element.hidden = convergence === null;
    if (!convergence) return;
    const now = solvedReading(convergence);
    const { style, dataset } = this.element;
    if (dataset.verdict !== now.verdict) this.spoken.textContent = `steps: ${now.word.toLowerCase()}`;
    dataset.verdict = now.verdict;
    style.setProperty("--filled", `${100 * now.filled}%`);
    this.glyph.textContent = glyphs[now.verdict];
    this.word.textContent = now.word;
    this.share.textContent = now.share;
    this.track.setAttribute("aria-valuenow", now.filled.toFixed(3));
    this.track.setAttribute("aria-valuetext", `${now.word} ${now.share}`);
    this.element.title = explain(convergence);
  }
}

function explain({ error_m: error, tolerance_m: tolerance }: Convergence): string {
  const allowed = `A step counts as solved up to ${lengthText(tolerance)}, the mark.`;
  if (error <= tolerance)
    return `The last step that was measured ends ${lengthText(error)} from where it would if it were solved. ${allowed}`;
  return (
    `The iterations of a step leave ${lengthText(error)} unsolved: the cloth stretches and lags more than its ` +
    `material would. A shorter time step, more iterations or another method helps. ${allowed}`
  );
}
