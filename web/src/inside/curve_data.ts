// The curves of the last minute, from what sim.status told.
import type { Told } from "../panel/status_log";

export const seconds = 60; // on the axis
const lost = 3000; // [ms] without a status: the link was lost, and the curve has a gap

/// One value a moment; null: a gap.
export type Values = (number | null)[];

export const curveNames = ["kinetic", "elastic", "gravitational", "total", "strain", "rate"] as const;
export type CurveName = (typeof curveNames)[number];

export interface CurveData extends Record<CurveName, Values> {
  ago: number[]; ///< [s], 0 is now, rising
  resets: number[]; ///< where the session went back in time [s]
}

/// `now`: on the clock of the log [ms].
export function curveData(told: readonly Told[], now: number): CurveData {
  const data: CurveData = {
    ago: [],
    resets: [],
    kinetic: [],
    elastic: [],
    gravitational: [],
    total: [],
    strain: [],
    rate: [],
  };
  const add = (at: number, values: Partial<Record<CurveName, number | null>>): void => {
    data.ago.push((at - now) / 1000);
    for (const name of curveNames) data[name].push(values[name] ?? null);
  };
  let before: Told | null = null;
  for (const one of told) {
    if (now - one.at > 1000 * seconds) continue;
    const { energy, max_strain, real_time_factor, playing, time } = one.status;
    const back = before !== null && time !== undefined && (before.status.time ?? 0) > time;
    if (before && (back || one.at - before.at > lost)) add((before.at + one.at) / 2, {});
    if (back) data.resets.push((one.at - now) / 1000);
    add(one.at, {
      ...energy,
      total: energy ? energy.kinetic + energy.elastic + energy.gravitational : null,
      strain: max_strain === undefined ? null : 100 * max_strain,
      rate: playing === false ? null : (real_time_factor ?? null),
    });
    before = one;
  }
  return data;
}

/// The last value, the least and the most; null if there is none.
export function summary(values: Values): { last: number | null; least: number; most: number } | null {
  const known = values.filter((value): value is number => value !== null && Number.isFinite(value));
  if (known.length === 0) return null;
  return { last: values.at(-1) ?? null, least: Math.min(...known), most: Math.max(...known) };
}

const prefixes = [
  [1e9, "G"],
  [1e6, "M"],
  [1e3, "k"],
  [1, ""],
  [1e-3, "m"],
  [1e-6, "µ"],
  [1e-9, "n"],
] as const;

/// Three figures and a unit: `12.3 mJ`, `4.5 %`, `×0.98`.
export function valueText(value: number | null, unit: "J" | "%" | "×"): string {
  if (value === null) return "–";
  const size = Math.abs(value);
  const figures = (number: number): string => {
    const text = String(Number(Math.abs(number).toPrecision(3)));
    return `${number < 0 && Number(text) !== 0 ? "−" : ""}${text}`;
  };
  if (unit === "×") return `×${figures(value)}`;
  if (unit === "%") return `${size < 0.0005 ? 0 : figures(value)} %`;
  if (size < 1e-9) return "0 J";
  const [factor, prefix] = prefixes.find(([least]) => size >= 0.9995 * least) ?? ([1e-9, "n"] as const);
  return `${figures(value / factor)} ${prefix}J`;
}
