// Draws the curves of the last minute, each with a table that says the same in numbers.
import uPlot from "uplot";
import { make } from "../lab/dom";
import type { StatusLog } from "../panel/status_log";
import { curveData, seconds, summary, valueText, type CurveData, type CurveName } from "./curve_data";

interface Chart {
  title: string;
  unit: "J" | "%" | "×";
  curves: [name: CurveName, label: string][];
}
const charts: Chart[] = [
  {
    title: "Energy",
    unit: "J",
    curves: [
      ["kinetic", "kinetic"],
      ["elastic", "elastic"],
      ["gravitational", "gravity"],
      ["total", "total"],
    ],
  },
  { title: "Largest strain", unit: "%", curves: [["strain", "strain"]] },
  { title: "Real-time factor", unit: "×", curves: [["rate", "factor"]] },
];
const height = 92; // [CSS pixels]
const often = 250; // [ms] between two pictures
const seldom = 1000; // the same where the system wishes less motion

const colourOf = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const calm = matchMedia("(prefers-reduced-motion: reduce)");

class Plot {
  readonly element: HTMLElement;
  private readonly plot: uPlot;
  private readonly cells = new Map<CurveName, { now: HTMLElement; least: HTMLElement; most: HTMLElement }>();
  private data: CurveData | null = null;

  constructor(private readonly chart: Chart) {
    const title = make("h3", "", chart.title);
    const place = make("div", "inside-plot");
    place.setAttribute("aria-hidden", "true"); // the table says it
    this.element = make("section", "inside-chart", title, place, this.makeTable());
    this.plot = new uPlot(this.options(), [[], ...chart.curves.map(() => [])], place);
  }

  private options(): uPlot.Options {
    const { curves, unit } = this.chart;
    const axis = { stroke: () => colourOf("--muted"), font: "11px system-ui, sans-serif", ticks: { show: false } };
    const grid = { stroke: () => colourOf("--card-line"), width: 1 };
    return {
      width: 240,
      height,
      padding: [6, 14, 0, 0],
      legend: { show: false },
      cursor: { y: false, drag: { x: false, y: false }, points: { size: 5 } },
      scales: {
        x: { time: false, range: [-seconds, 0] },
        y: { range: (_, low, high) => rangeAround(low, high, unit) },
      },
      axes: [
        { ...axis, grid, size: 18, space: 40, values: (_, at) => at.map((ago) => (ago === 0 ? "now" : `${ago} s`)) },
        { ...axis, grid, size: 54, space: 22, gap: 3, values: (_, at) => at.map((value) => valueText(value, unit)) },
      ],
      series: [
        {},
        ...curves.map(([name, label]) => ({
          label,
          stroke: () => colourOf(`--curve-${name}`),
          width: name === "total" ? 2 : 1.5,
          points: { show: false },
        })),
      ],
      hooks: { draw: [(plot) => this.drawResets(plot)], setCursor: [() => this.tell()] },
    };
  }

  // A dashed line wherever the session went back in time.
  private drawResets({ ctx, bbox, valToPos }: uPlot): void {
    ctx.save();
    ctx.strokeStyle = colourOf("--muted");
    ctx.setLineDash([4, 4]);
    for (const ago of this.data?.resets ?? []) {
      const x = Math.round(valToPos.call(this.plot, ago, "x", true));
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    }
    ctx.restore();
  }

  private makeTable(): HTMLTableElement {
    const head = make("tr", "", make("td"), ...["now", "least", "most"].map((text) => make("th", "", text)));
    const rows = this.chart.curves.map(([name, label], i) => {
      const swatch = make("i");
      swatch.style.background = `var(--curve-${name})`;
      const title = make("th", "");
      title.scope = "row";
      if (this.chart.curves.length > 1) {
        const turn = make("button", "", swatch, label);
        turn.type = "button";
        turn.title = `Draw the ${label} energy, or not`;
        turn.setAttribute("aria-pressed", "true");
        turn.onclick = () => {
          const shown = turn.getAttribute("aria-pressed") !== "true";
          turn.setAttribute("aria-pressed", String(shown));
          this.plot.setSeries(i + 1, { show: shown });
        };
        title.append(turn);
      } else title.append(swatch, label);
      const cells = { now: make("td"), least: make("td"), most: make("td") };
      this.cells.set(name, cells);
      return make("tr", "", title, cells.now, cells.least, cells.most);
    });
    for (const cell of head.querySelectorAll("th")) cell.scope = "col";
    const table = make("table", "", make("thead", "", head), make("tbody", "", ...rows));
    table.setAttribute("aria-label", `${this.chart.title} in the last minute`);
    return table;
  }

  show(data: CurveData, width: number): void {
    this.data = data;
    if (width > 0 && width !== this.plot.width) this.plot.setSize({ width, height });
    this.plot.setData([data.ago, ...this.chart.curves.map(([name]) => data[name])]);
    this.tell();
  }

  // Below the pointer, else now.
  private tell(): void {
    const { data, chart } = this;
    if (!data) return;
    const at = this.plot.cursor.idx;
    for (const [name] of chart.curves) {
      const cells = this.cells.get(name);
      const all = summary(data[name]);
      if (!cells) continue;
      const value = at === null || at === undefined ? (all?.last ?? null) : (data[name][at] ?? null);
      cells.now.textContent = valueText(value, chart.unit);
      cells.least.textContent = valueText(all?.least ?? null, chart.unit);
      cells.most.textContent = valueText(all?.most ?? null, chart.unit);
    }
  }

  redraw(): void {
    this.plot.redraw(false);
  }
}

/// What the axis shows: all values with a little room; for shares and factors from 0 on.
function rangeAround(low: number | null, high: number | null, unit: Chart["unit"]): [number, number] {
  if (low === null || high === null) return [0, 1];
  const [from, to] = unit === "J" ? [low, high] : [0, Math.max(high, unit === "×" ? 1 : 0)];
  const room = 0.06 * (to - from) || 0.5 * Math.abs(to) || 1;
  return [unit === "J" ? from - room : 0, to + room];
}

export class Curves {
  readonly element = make("div", "inside-curves");
  private readonly plots = charts.map((chart) => new Plot(chart));
  private timer = 0;

  constructor(private readonly log: StatusLog) {
    this.element.append(...this.plots.map(({ element }) => element));
    new MutationObserver(() => this.plots.forEach((plot) => plot.redraw())).observe(document.documentElement, {
      attributeFilter: ["data-theme"],
    });
  }

  /// Draws from now on what comes, or no longer.
  run(running: boolean): void {
    clearTimeout(this.timer);
    if (!running) return;
    this.draw();
    this.timer = window.setTimeout(() => this.run(true), calm.matches ? seldom : often);
  }

  private draw(): void {
    if (document.hidden) return;
    const data = curveData(this.log.told, performance.now());
    for (const plot of this.plots) plot.show(data, this.element.clientWidth);
  }
}
