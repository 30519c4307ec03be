// The points of a chart or of a choice: the tooltip of one point, and the table of all.
import { make, makeButton } from "./dom";
import { Table } from "./table";
import { axisNames, costText, errorText, iterationsText, limitText, settingText, solvedText, stepText } from "./text";
import type { Axis, Point } from "./types";
import type { Tip } from "./picture";
import { methodText, withNames } from "../panel/methods";

/// The error of a point that is shown, and its name; `size`: size of the cloth [m] if the error is relative to it, else
/// null.
export interface Shown {
  name: string;
  size: number | null;
  of(point: Point): number | null;
}

export const onAxis = (axis: Axis, size: number | null): Shown => ({
  name: `${axisNames[axis].toLowerCase()} error`,
  size: axis === "position" || axis === "rest" ? size : null,
  of: ({ error }) => error[axis],
});

/// The error that decides the choice.
export const largestOnTheWay: Shown = {
  name: "largest position error",
  size: null,
  of: ({ largest_position_error }) => largest_position_error,
};

export function pointTip(point: Point, { name, size, of }: Shown, mayApply: boolean): Tip {
  const error = of(point);
  const lines: string[] = [];
  if (point.blew_up_at_s !== null) lines.push(`blew up after ${Number(point.blew_up_at_s.toPrecision(2))} s`);
  else {
    const length = size && error !== null ? ` (${Number((1000 * error * size).toPrecision(2))} mm)` : "";
    lines.push(`${name} ${errorText(error)}${length}`);
    if (point.ms_a_simulated_s) lines.push(`${costText(point.ms_a_simulated_s)} a simulated second`);
  }
  if (point.convergence) lines.push(`${solvedText(point.convergence)} from solved at the last step`);
  if (point.dt_over_limit !== null) lines.push(`${limitText(point.dt_over_limit)} of the stability limit`);
  return {
    title: settingText(point),
    lines,
    action: mayApply ? "Apply" : null,
    compare: mayApply ? "Compare with present" : null,
  };
}

export const curveOf = ({ method, iterations }: Point): string => `${method} ${iterations ?? ""}`;

export class PointTable {
  readonly element: HTMLElement;
  private readonly title = make("summary");
  private readonly table: Table<Point>;
  private shown: Shown = largestOnTheWay;

  constructor(
    apply: (point: Point) => void,
    compare: (point: Point) => void,
    private readonly what: string,
  ) {
    this.table = new Table<Point>(
      what,
      [
        {
          title: "Method",
          text: (point) => methodText(point.method).name,
          order: (point) => methodText(point.method).name,
        },
        { title: "dt", text: (point) => stepText(point.dt_s), order: (point) => point.dt_s, className: "number" },
        {
          title: "Iter.",
          hint: "iterations",
          text: (point) => String(point.iterations ?? "–"),
          order: (point) => point.iterations,
          className: "number",
        },
        {
          title: "Error",
          text: (point) => (point.blew_up_at_s === null ? errorText(this.shown.of(point)) : "blew up"),
          order: (point) => (point.blew_up_at_s === null ? this.shown.of(point) : null),
          className: "number",
        },
        {
          title: "Cost",
          hint: "of stepping, for a simulated second: the median of the runs",
          text: (point) => costText(point.ms_a_simulated_s),
          order: (point) => point.ms_a_simulated_s?.median ?? null,
          className: "number",
        },
        {
          title: "Left",
          hint: "what the last step leaves unsolved",
          text: ({ convergence }) => (convergence ? solvedText(convergence) : "–"),
          order: ({ convergence }) => convergence?.error_m ?? null,
          className: "number wide",
        },
        {
          title: "Limit",
          hint: "dt over the largest stable one",
          text: (point) => limitText(point.dt_over_limit),
          order: (point) => point.dt_over_limit,
          className: "number wide",
        },
        {
          title: "",
          text: (point) =>
            make(
              "span",
              "lab-deeds",
              applyButton(`Apply ${settingText(point)}`, () => apply(point)),
              compareButton(settingText(point), () => compare(point)),
            ),
          className: "action",
        },
      ],
      4,
      (point) => (point.blew_up_at_s === null ? "" : "blown"),
    );
    this.element = make("details", "lab-more", this.title, this.table.element);
  }

  show(points: Point[], shown: Shown): void {
    this.shown = shown;
    this.title.textContent = `${this.what} (${points.length})`;
    this.table.show(points);
  }
}

export function applyButton(name: string, apply: () => void): HTMLButtonElement {
  const button = makeButton("Apply", "lab-small lab-apply", apply);
  button.setAttribute("aria-label", name);
  return button;
}

export function compareButton(setting: string, compare: () => void): HTMLButtonElement {
  const button = makeButton("Compare", "lab-small lab-apply", compare);
  button.title = "Compare with the present settings";
  button.setAttribute("aria-label", `Compare ${setting} with present`);
  return button;
}

/// A setting that was not measured, as text: "xpbd, dt 1 ms, 4 iterations: not enough time left".
export function leftOutText(method: string, dt: number | null, iterations: number | null, reason: string): string {
  const setting = [methodText(method).name, dt === null ? "" : `dt ${stepText(dt)}`, iterationsText(iterations)];
  return `${setting.filter((part) => part !== "").join(", ")}: ${withNames(reason)}`;
}
