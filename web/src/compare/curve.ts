// The difference over time as a curve: RMS over the vertices, and the largest.
import uPlot from "uplot";
import type { CompareResult } from "./words";
import { axisStyle, coloursAt } from "../lab/axis_style";
import { make } from "../lab/dom";

const height = 190; // [px]

export class Curve {
  readonly element = make("div", "compare-curve");
  private plot: uPlot | null = null;
  private time = 0;
  private horizon: number | null = null;
  private data: uPlot.AlignedData = [[], [], []];

  constructor(private readonly seek: (time: number) => void) {
    this.element.setAttribute("role", "img");
    new ResizeObserver(() => this.fit()).observe(this.element);
    new MutationObserver(() => this.rebuild()).observe(document.documentElement, { attributeFilter: ["data-theme"] });
  }

  show(result: CompareResult, says: string): void {
    const millimetres = (of: number[]): number[] => of.map((metres) => 1000 * metres);
    this.horizon = result.horizon_s;
    this.data = [result.times_s, millimetres(result.rms_m), millimetres(result.most_m)];
    this.element.setAttribute("aria-label", `Curve of the difference over time. ${says}`);
    if (this.plot) this.plot.setData(this.data);
    else this.rebuild();
  }

  /// Marks the present time [s].
  mark(time: number): void {
    if (time === this.time) return;
    this.time = time;
    this.plot?.redraw(false, false);
  }

  private fit(): void {
    const width = this.element.clientWidth;
    if (!this.plot) this.rebuild();
    else if (width > 0 && width !== this.plot.width) this.plot.setSize({ width, height });
  }

  // uPlot reads colours once: another theme needs another plot.
  private rebuild(): void {
    const width = this.element.clientWidth;
    if (width === 0 || this.data[0].length === 0) return;
    this.plot?.destroy();
    const colour = coloursAt(this.element);
    const axis = axisStyle(this.element);
    this.plot = new uPlot(
      {
        width,
        height,
        scales: {
          x: { time: false },
          y: { range: (_, __, most) => [0, most > 0 ? 1.08 * most : 1] },
        },
        axes: [
          { ...axis, label: "simulated time [s]", size: 30 },
          { ...axis, label: "difference [mm]", size: 52 },
        ],
        series: [
          {},
          { label: "RMS", stroke: colour("--compare-rms"), width: 2, points: { show: false } },
          { label: "largest", stroke: colour("--compare-most"), width: 2, points: { show: false }, dash: [6, 3] },
        ],
        legend: { show: false },
        cursor: { drag: { x: false, y: false }, y: false, points: { show: false } },
        hooks: { draw: [(plot) => this.drawMarks(plot, colour("--text"), colour("--warn"))] },
      },
      this.data,
      this.element,
    );
    const over = this.plot.over;
    const jump = (event: PointerEvent): void => {
      const { left } = over.getBoundingClientRect();
      this.seek((this.plot as uPlot).posToVal(event.clientX - left, "x"));
    };
    over.addEventListener("pointerdown", (event) => {
      over.setPointerCapture(event.pointerId);
      jump(event);
    });
    over.addEventListener("pointermove", (event) => {
      if (event.buttons > 0) jump(event);
    });
  }

  private drawMarks(plot: uPlot, now: string, horizon: string): void {
    this.line(plot, this.time, now, []);
    if (this.horizon !== null) this.line(plot, this.horizon, horizon, [4, 4]);
  }

  private line(plot: uPlot, at: number, color: string, dash: number[]): void {
    const { ctx, bbox } = plot;
    const x = plot.valToPos(at, "x", true);
    if (!(x >= bbox.left && x <= bbox.left + bbox.width)) return;
    ctx.save();
    ctx.strokeStyle = color;
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.setLineDash(dash.map((length) => length * devicePixelRatio));
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
  }
}
