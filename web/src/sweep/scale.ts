// One axis of a plot: from values to places, and the values that are written beside it.

export interface Scale {
  place(value: number | string): number;
  ticks: { at: number; label: string }[];
}

export type Value = number | string | boolean | null;

/// A number with three significant digits.
export const brief = (value: number): string => {
  const rounded = Number(value.toPrecision(3)),
    text = String(rounded);
  return text.length <= 6 ? text : rounded.toExponential().replace("e+", "e");
};

const roundSteps = [1, 2, 5, 10];

/// Round numbers in [low, high], about six of them.
function linearTicks(low: number, high: number): number[] {
  const raw = (high - low) / 6,
    power = 10 ** Math.floor(Math.log10(raw));
  const step = power * (roundSteps.find((each) => each * power >= raw) ?? 10);
  const ticks = [];
  for (let k = Math.ceil(low / step); k * step <= high * (1 + 1e-12); ++k) ticks.push(k * step);
  return ticks;
}

/// Powers of ten in [low, high]; 2 and 5 times these where there are few.
function logTicks(low: number, high: number): number[] {
  const powers = Math.floor(Math.log10(high)) - Math.ceil(Math.log10(low)) + 1;
  const times = powers < 3 ? [1, 2, 5] : [1];
  const ticks = [];
  for (let k = Math.floor(Math.log10(low)); k <= Math.log10(high); ++k)
    for (const each of times) if (each * 10 ** k >= low && each * 10 ** k <= high) ticks.push(each * 10 ** k);
  const every = Math.ceil(ticks.length / 9);
  return ticks.filter((_, i) => i % every === 0);
}

function numbers(values: number[], from: number, to: number, log: boolean): Scale {
  let low = values.reduce((a, b) => Math.min(a, b)),
    high = values.reduce((a, b) => Math.max(a, b));
  if (low === high) [low, high] = log ? [low / 2, high * 2] : [low - 1, high + 1];
  const room = 0.04;
  if (log) [low, high] = [low * (low / high) ** room, high * (high / low) ** room];
  else [low, high] = [low - room * (high - low), high + room * (high - low)];
  const of = log ? Math.log : (x: number) => x;
  const place = (value: number | string): number =>
    from + ((of(Number(value)) - of(low)) / (of(high) - of(low))) * (to - from);
  return { place, ticks: (log ? logTicks : linearTicks)(low, high).map((at) => ({ at: place(at), label: brief(at) })) };
}

/// Evenly spaced words, in the order of their first appearance.
function words(values: string[], from: number, to: number): Scale {
  const known = [...new Set(values)];
  const place = (value: number | string): number =>
    from + ((known.indexOf(String(value)) + 0.5) / known.length) * (to - from);
  return { place, ticks: known.map((word) => ({ at: place(word), label: word })) };
}

/// A scale for the values of a column that are there. A logarithmic scale has room for values above 0 alone.
export function scaleOf(values: (number | string)[], from: number, to: number, log: boolean): Scale {
  if (values.every((value) => typeof value === "number")) return numbers(values, from, to, log);
  return words(values.map(String), from, to);
}
