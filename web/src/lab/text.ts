// Writes the lab's settings, errors and costs in words.
import { methodText } from "../panel/methods";
import { lengthText } from "../panel/length";
import type { Axis, Cost, Setting } from "./types";

const digits = (value: number, count: number): string => String(Number(value.toPrecision(count)));

/// The text with a capital letter and a full stop.
export function sentence(text: string): string {
  return text === "" ? "" : `${text.charAt(0).toUpperCase()}${text.slice(1)}`.replace(/[.!?]?$/, (end) => end || ".");
}

/// A time step as text: 0.76 ms, 16.7 ms, 40 µs.
export function stepText(seconds: number): string {
  return seconds < 1e-4 ? `${digits(1e6 * seconds, 3)}\u00a0µs` : `${digits(1e3 * seconds, 3)}\u00a0ms`;
}

export function iterationsText(iterations: number | null): string {
  return iterations === null ? "" : `${iterations} iteration${iterations === 1 ? "" : "s"}`;
}

/// A setting as text: "XPBD, dt 1.1 ms, 4 iterations".
export function settingText({ method, dt_s, iterations }: Pick<Setting, "method" | "dt_s" | "iterations">): string {
  return [methodText(method).name, `dt ${stepText(dt_s)}`, iterationsText(iterations)]
    .filter((part) => part !== "")
    .join(", ");
}

/// An error as text, written like a tolerance: 1.2e-3.
export function errorText(error: number | null): string {
  if (error === null) return "–";
  if (error === 0) return "0";
  return error >= 0.1 ? digits(error, 2) : error.toExponential(1).replace(".0e", "e");
}

/// A cost per simulated second as text: 57 ms.
export function costText(cost: Cost | null): string {
  if (!cost) return "–";
  return cost.median >= 1000
    ? `${digits(cost.median / 1000, 3)}\u00a0s`
    : `${digits(cost.median, cost.median < 10 ? 2 : 3)}\u00a0ms`;
}

/// The range of a cost as text: " (55 … 60 ms)"; "" if it is unknown.
export function costRange(cost: Cost | null): string {
  if (!cost || cost.low === null || cost.high === null) return "";
  const [low, high] = [cost.low, cost.high].map((end) => costText({ ...cost, median: end }));
  return low === high ? "" : ` (${low} … ${high})`;
}

export function limitText(share: number | null): string {
  if (share === null) return "–";
  return share < 10 ? `${digits(100 * share, 2)}\u00a0%` : `${digits(share, 2)}\u00a0×`;
}

/// How far a step is from solved, as a length.
export const solvedText = ({ error_m: error }: { error_m: number }): string => lengthText(error);

export const axisNames: Record<Axis, string> = {
  position: "Position",
  energy: "Energy",
  strain: "Strain",
  rest: "Rest shape",
};
export const axisMeanings: Record<Axis, string> = {
  position: "RMS distance of the vertices to the exact motion, over the cloth's size",
  energy: "error of the total energy, over the largest kinetic + elastic energy",
  strain: "error of the largest strain, over that strain",
  rest: "RMS distance to the shape of rest, over the cloth's size",
};

/// A cost against the present one: "17 times as fast as the present setting", "costs 1.3 times as much as ...".
export function comparedText(cost: Cost | null, present: Cost | null): string {
  if (!cost || !present || cost.median <= 0 || present.median <= 0) return "";
  const ratio = present.median / cost.median;
  if (ratio > 0.95 && ratio < 1.05) return "as fast as the present setting";
  return ratio > 1
    ? `${digits(ratio, 2)} times as fast as the present setting`
    : `takes ${digits(1 / ratio, 2)} times as long as the present setting`;
}
