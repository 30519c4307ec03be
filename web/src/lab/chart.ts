// The tab with speed against accuracy: the chart, the present setting on it, the points as a table, and the list of
// what was left out.
import { labelled, make, makeNumber, makeSelect, numberIn, say } from "./dom";
import { Drawing } from "./drawing";
import { Picture } from "./picture";
import { curveOf, leftOutText, onAxis, pointTip, PointTable, type Shown } from "./points";
import { placeOf } from "./present";
import { presentSetting, Tab, type TabHost } from "./tab";
import { axisMeanings, axisNames, costText, errorText, settingText } from "./text";
import { axes, type Axis, type Chart, type Point } from "./types";

export class ChartTab extends Tab<"chart"> {
  private readonly time = makeNumber("1", "1");
  private readonly budget = makeSelect(
    [
      ["20", "20 s"],
      ["45", "45 s"],
      ["120", "2 minutes"],
      ["600", "10 minutes"],
    ],
    "45",
  );
  private readonly iterations = makeNumber("1, 2, 4, 8, 16");
  private readonly axisBoxes = new Map<Axis, HTMLInputElement>();
  private readonly axisWhy = make("p", "lab-fine");
  private readonly present = make("p", "lab-now");
  private readonly horizon = make("p", "lab-fine");
  private readonly leftOutTitle = make("summary");
  private readonly leftOutList = make("ul", "lab-list");
  private readonly leftOut = make("details", "lab-more", this.leftOutTitle, this.leftOutList);
  private readonly picture = new Picture(
    {
      tip: (key) => {
        const point = this.point(key);
        return point ? pointTip(point, this.shown, this.host.mayEdit()) : null;
      },
      choose: (key) => this.applyPoint(this.point(key)),
      compare: (key) => this.comparePoint(this.point(key)),
      order: (key) => {
        const point = this.point(key) as Point;
        return { curve: curveOf(point), along: point.dt_s };
      },
    },
    true,
  );
  private readonly drawing = new Drawing(
    "chart",
    this.host.jobs,
    this.picture,
    "Speed against accuracy: arrow keys go from point to point, Enter applies one",
    (error) => this.host.problem("The chart could not be drawn", error),
  );
  private readonly table = new PointTable(
    (point) => this.applyPoint(point),
    (point) => this.comparePoint(point),
    "All points as a table",
  );
  private onAxis: Axis = "position";
  private result: Chart | null = null;

  constructor(host: TabHost) {
    super("chart", host, {
      lead:
        "What does each method cost on this scene, and how far from the truth does it end? " +
        "Every method is run with many time steps, against a reference in double precision.",
      start: "Measure the chart",
      file: "chart",
      awaits:
        "The chart: error from left to right, cost from bottom to top, a curve for each method. A click on a point applies it.",
    });
    this.iterations.classList.add("long");
    this.addMethods();
    this.addOptions(
      labelled("simulate [s]", this.time, "how much of the motion each point is judged by"),
      labelled("take at most", this.budget, "what does not fit is left out, and listed"),
      labelled("iterations", this.iterations, "for the methods that iterate"),
    );
    this.content.append(
      this.axisChoice(),
      this.axisWhy,
      this.picture.element,
      this.present,
      this.table.element,
      this.leftOut,
      this.horizon,
    );
  }

  override sceneChanged(): void {
    this.showPresent();
  }

  protected override axis(): Axis {
    return this.onAxis;
  }
  protected override drawn(): string | null {
    return this.drawing.text;
  }

  protected override params(): Record<string, unknown> {
    const iterations = this.iterations.value
      .split(/[\s,;]+/)
      .filter((part) => part !== "")
      .map(Number);
    const time = numberIn(this.time);
    return {
      budget: Number(this.budget.value),
      ...(time === undefined ? {} : { time }),
      ...(iterations.length > 0 ? { iterations } : {}),
    };
  }

  protected override show(chart: Chart): void {
    this.result = chart;
    if (!chart.axes[this.onAxis].available)
      this.onAxis = axes.find((axis) => chart.axes[axis].available) ?? this.onAxis;
    this.showAxes(chart);
    this.drawing.want(chart, this.onAxis);
    this.table.show(chart.points, this.shown);
    this.leftOut.hidden = chart.left_out.length === 0;
    this.leftOutTitle.textContent = `Left out (${chart.left_out.length})`;
    this.leftOutList.replaceChildren(
      ...chart.left_out.map(({ method, dt_s, iterations, reason }) =>
        make("li", "", leftOutText(method, dt_s, iterations, reason)),
      ),
    );
    say(this.horizon, chart.horizon_reason);
    this.showPresent();
  }

  private axisChoice(): HTMLElement {
    const group = make("div", "lab-axes");
    group.setAttribute("role", "radiogroup");
    group.setAttribute("aria-label", "Error shown");
    for (const axis of axes) {
      const input = make("input");
      input.type = "radio";
      input.name = "lab-axis";
      input.onchange = () => {
        this.onAxis = axis;
        if (this.result) this.show(this.result);
      };
      this.axisBoxes.set(axis, input);
      group.append(make("label", "", input, make("span", "", axisNames[axis])));
    }
    return group;
  }

  private showAxes(chart: Chart): void {
    const missing: string[] = [];
    for (const [axis, input] of this.axisBoxes) {
      const { available, reason } = chart.axes[axis];
      input.checked = axis === this.onAxis;
      input.disabled = !available;
      (input.parentElement as HTMLElement).title = available ? axisMeanings[axis] : reason;
      if (!available) missing.push(`${axisNames[axis]}: ${reason}`);
    }
    say(this.axisWhy, missing.map((text) => text.replace(/\.?$/, ".")).join(" "));
  }

  private showPresent(): void {
    const document = this.host.document();
    if (!this.result || !document) return;
    const setting = presentSetting(document);
    const place = placeOf(setting, this.result.points, this.onAxis);
    const known = "error" in place;
    this.picture.showPresent(known ? { x: place.error, y: place.cost } : null);
    this.present.classList.toggle("unknown", !known);
    const cost = (seconds: number) => costText({ median: seconds, minimum: seconds, runs: 0, low: null, high: null });
    const facts = known
      ? `: error ${errorText(place.error)}, ${cost(place.cost)} a simulated second.`
      : `. Not measured: ${place.reason}.`;
    say(this.present, `Now: ${settingText(setting)}${facts}`);
  }

  private get shown(): Shown {
    return onAxis(this.onAxis, this.result?.size_m ?? null);
  }

  private point(key: string): Point | undefined {
    return this.result?.points[Number(key)];
  }

  private applyPoint(point: Point | undefined): void {
    if (point) this.host.apply(point.patch, settingText(point));
  }

  private comparePoint(point: Point | undefined): void {
    if (point) this.host.compare(point.patch);
  }
}
