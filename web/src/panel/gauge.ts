// The stability gauge: the time step as a share of the longest stable one. The server computes that for the present
// scene.
import { Meter, part, type Reading, type Verdict } from "./meter";
import { readable } from "./slider";

/// Part of `sim.status`. null: no limit; 0: no time step is stable.
export interface Stability {
  dt_limit: number | null;
}

const near = 0.9; // share of the limit: above it the server warns too
const end = 1.5; // share of the limit at the gauge's right end
const safer = 0.8; // share of the limit that the button sets

/// A time step [s] well below the limit, rounded to be easy to read.
export const saferStep = (limit: number): number => Math.max(1e-9, Number((safer * limit).toPrecision(3)));

/// A time step [s] beyond a limit: at 1.1 times that of symplectic Euler the fastest vibration grows 2.4 times in a
/// step, from float32's rounding to the cloth's size in some 20, which is slow enough to be looked at.
export const beyond = (limit: number): number => Number((1.1 * limit).toPrecision(3));

/// The gauge's reading for a time step [s].
export function reading(dt: number, limit: number | null): Reading {
  const always = (verdict: Verdict, word: string): Reading => ({
    verdict,
    word,
    share: "at any time step",
    spoken: `${word} at any time step`,
    filled: 1,
  });
  if (limit === null) return always("good", "Stable");
  if (limit <= 0) return always("beyond", "Unstable");
  const ratio = dt / limit;
  const verdict = ratio > 1 ? "beyond" : ratio > near ? "near" : "good";
  const word = { good: "Stable", near: "Marginal", beyond: "Unstable" }[verdict];
  const share =
    ratio < 9.995 ? `${(100 * ratio).toFixed(ratio < 0.0995 ? 1 : 0)} %` : `${Number(ratio.toPrecision(3))} ×`;
  return {
    verdict,
    word,
    share,
    spoken: `${word}: ${share}${ratio < 9.995 ? " of" : ""} the limit`,
    filled: Math.min(1, ratio / end),
  };
}

export class Gauge {
  private readonly meter = new Meter("gauge", "time step against its stability limit", "time step", end, 1);
  readonly element = this.meter.element;
  private readonly limit = part("button", "gauge-limit", this.meter.line) as HTMLButtonElement;
  private saferStep = 0; // [s]: what the button sets

  constructor(setTimeStep: (dt: number) => void) {
    this.limit.type = "button";
    this.limit.onclick = () => setTimeStep(this.saferStep);
  }

  show(dt: number, { dt_limit }: Stability): void {
    this.meter.show(reading(dt, dt_limit), explain(dt, dt_limit));
    this.element.dataset.limited = String(dt_limit !== null && dt_limit > 0);
    this.showLimit(dt_limit);
  }

  private showLimit(limit: number | null): void {
    this.limit.hidden = !limit;
    if (!limit) return;
    this.saferStep = saferStep(limit);
    const text = `limit ${readable(Number(limit.toPrecision(3)))} s`;
    if (this.limit.textContent !== text) this.limit.textContent = text;
    this.limit.title = `Set the time step to ${safer} of the limit: ${readable(this.saferStep)} s`;
    this.limit.setAttribute("aria-label", `${text}: set the time step to ${safer} of it`);
  }
}

function explain(dt: number, limit: number | null): string {
  if (limit === null)
    return "This method is stable at any time step; a long one damps the motion and asks for more iterations.";
  if (limit <= 0)
    return "Without damping this method gains energy at any time step: add damping, or choose another method.";
  return (
    `time step ${readable(dt)} s, largest stable one ${readable(Number(limit.toPrecision(3)))} s.\n` +
    "It shrinks with stiffer springs, lighter vertices and more damping. Beyond it the cloth blows up."
  );
}
