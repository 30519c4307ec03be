// What curves drawn by uPlot have alike: the colours of the page's theme, and how their axes look.
import type uPlot from "uplot";

/// Reads the colours of the theme by their CSS names, as they are at `element` now.
export function coloursAt(element: Element): (name: string) => string {
  const style = getComputedStyle(element);
  return (name) => style.getPropertyValue(name).trim();
}

/// An axis with a label, of a plot in `element`.
export function axisStyle(element: Element): uPlot.Axis {
  const colour = coloursAt(element);
  const line = { stroke: colour("--card-line"), width: 1 };
  const font = "12px system-ui, sans-serif";
  return { stroke: colour("--muted"), grid: line, ticks: line, font, labelFont: font, labelSize: 16 };
}
