// The gauge of convergence: how far the last step that the server measured is from solved, against what counts as
// solved. Under methods that iterate only.
import { lengthText } from "./length";
import { Meter, type Reading } from "./meter";

/// Part of `sim.status`; null: the method does not iterate, or no step is measured yet.
export interface Convergence {
  residual: number; ///< the share left of what there was to solve
  error_m: number;
  tolerance_m: number;
}

const decades = 4; // of the gauge, whose right end is ten times the tolerance
const mark = (decades - 1) / decades;

/// The gauge's reading: solved up to the tolerance, and lost beyond ten times that.
export function solvedReading({ error_m: error, tolerance_m: tolerance, residual }: Convergence): Reading {
  const ratio = error / tolerance;
  const verdict = ratio > 10 ? "beyond" : ratio > 1 ? "near" : "good";
  const word = verdict === "good" ? "Solved" : "Unsolved";
  const share = `to ${lengthText(error)}, ${Number((100 * residual).toPrecision(2))} % left`;
  const filled = ratio > 0 ? Math.min(1, Math.max(0, mark + Math.log10(ratio) / decades)) : 0;
  return { verdict, word, share, spoken: `${word} ${share}`, filled };
}

export class ConvergenceGauge {
  private readonly meter = new Meter(
    "convergence",
    "what a step leaves unsolved, against its tolerance",
    "steps",
    1,
    mark,
  );
  readonly element = this.meter.element;

  show(convergence: Convergence | null): void {
    if (convergence) this.meter.show(solvedReading(convergence), explain(convergence));
    else this.element.hidden = true;
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
