// The energy over the time before a blow-up, on a logarithmic scale, with the most that a run that holds may have.
import uPlot from "uplot";
import { axisStyle, coloursAt } from "../lab/axis_style";
import { make } from "../lab/dom";

const [low, high] = [110, 170]; // [px]: on a phone, elsewhere
const decadesShown = 14; // what was less than the largest by more is not worth its room

export interface EnergyCurve {
  milliseconds: number[]; ///< since the first moment
  energy: number[]; ///< [J]
  allowed: number | null; ///< [J]
}

const power = (value: number): string => (value === 0 ? "0" : `1e${Math.round(Math.log10(value))}`);

export class EnergyChart {
  readonly element = make("div", "show-chart");
  private plot: uPlot | null = null;
  private curve: EnergyCurve = { milliseconds: [], energy: [], allowed: null };
  private at = 0; // [ms]

  constructor() {
    this.element.setAttribute("role", "img");
    new ResizeObserver(() => this.rebuild()).observe(this.element);
    new MutationObserver(() => this.rebuild()).observe(document.documentElement, { attributeFilter: ["data-theme"] });
  }

  show(curve: EnergyCurve, says: string): void {
    this.curve = curve;
    this.element.setAttribute("aria-label", says);
    this.rebuild();
  }

  mark(milliseconds: number): void {
    this.at = milliseconds;
    this.plot?.redraw(false, false);
  }

  private range(): [number, number] {
    const { energy, allowed } = this.curve;
    const all = [...energy, ...(allowed ? [allowed] : [])].filter((each) => each > 0);
    const most = Math.max(...all);
    const least = Math.max(Math.min(...all), most / 10 ** decadesShown);
    return [10 ** Math.floor(Math.log10(least) - 0.2), 10 ** Math.ceil(Math.log10(most) + 0.2)];
  }

  // uPlot reads colours once: another theme, another width or other data need another plot.
  private rebuild(): void {
    const width = this.element.clientWidth;
    const height = innerWidth <= 760 ? low : high;
    const { milliseconds, energy, allowed } = this.curve;
    if (width === 0 || energy.length === 0) return;
    this.plot?.destroy();
    const colour = coloursAt(this.element);
    const axis = axisStyle(this.element);
    const range = this.range();
    this.plot = new uPlot(
      {
        width,
        height,
        scales: { x: { time: false }, y: { distr: 3, range: () => range } },
        axes: [
          { ...axis, label: "simulated time [ms]", size: 30 },
          { ...axis, label: "energy [J]", size: 46, values: (_, ticks) => ticks.map((each) => each && power(each)) },
        ],
        series: [
          {},
          { label: "energy", stroke: colour("--accent"), width: 2, points: { size: 5 } },
          { label: "limit", stroke: colour("--text"), width: 1.5, dash: [6, 4], points: { show: false } },
        ],
        legend: { show: false },
        cursor: { show: false },
        hooks: { draw: [(plot) => this.drawMark(plot, colour("--text"))] },
      },
      [milliseconds, energy.map((each) => (each > 0 ? each : null)), energy.map(() => allowed)],
      this.element,
    );
  }

  private drawMark(plot: uPlot, color: string): void {
    const { ctx, bbox } = plot;
    const x = plot.valToPos(this.at, "x", true);
    ctx.save();
    ctx.strokeStyle = color;
    ctx.lineWidth = devicePixelRatio;
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
  }
}
