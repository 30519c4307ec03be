// Finds where the present setting lies on a chart: between points measured with its method, never beyond them.
import type { Axis, Point, Setting } from "./types";

export type Place = { error: number; cost: number } | { reason: string };

const sameNumber = (a: number | null, b: number | null): boolean =>
  a === b || (a !== null && b !== null && Math.abs(a - b) <= 1e-9 * Math.abs(b));

/// Interpolates from `a` (share 0) to `b` (share 1), linearly in the logarithm.
const between = (a: number, b: number, share: number): number => a * (b / a) ** share;

interface Sample {
  dt: number;
  error: number;
  cost: number;
}

/// The lab shortens a step so that whole steps reach its samples: within this share a setting is the one measured. By
/// so little the error changes less than the two digits that are shown.
const fitted = 0.03;

/// Error on `axis` and cost [ms per simulated second] of `setting`, or the reason why they are not known. Interpolated
/// in dt along the curve of its method and iterations, in logarithms.
export function placeOf(setting: Setting, points: Point[], axis: Axis): Place {
  const ofMethod = points.filter(({ method }) => method === setting.method);
  if (ofMethod.length === 0) return { reason: "the method is not on the chart" };
  const curve = ofMethod.filter(
    ({ iterations, tolerance }) =>
      sameNumber(iterations, setting.iterations) && sameNumber(tolerance, setting.tolerance),
  );
  if (curve.length === 0) return { reason: otherwise(setting, ofMethod) };
  const samples = curve
    .flatMap(({ dt_s: dt, error, ms_a_simulated_s: cost, blew_up_at_s }): Sample[] => {
      const value = error[axis];
      return blew_up_at_s === null && value !== null && value > 0 && cost
        ? [{ dt, error: value, cost: cost.median }]
        : [];
    })
    .sort((a, b) => a.dt - b.dt);
  const blown = curve.filter(({ blew_up_at_s }) => blew_up_at_s !== null).map(({ dt_s }) => dt_s);
  return along(samples, setting.dt_s, blown);
}

function along(samples: Sample[], dt: number, blown: number[]): Place {
  const slack = 1e-6; // a step is written with fewer digits than it has
  const above = samples.findIndex((sample) => sample.dt >= dt * (1 - slack));
  const upper = samples[above];
  const lower = samples[above - 1];
  if (blown.some((failed) => failed <= dt * (1 + slack) && !(upper && failed < upper.dt)))
    return { reason: "steps as long as this blew up" };
  if (samples.length === 0) return { reason: "no point of its curve has this error" };
  const last = samples.at(-1) as Sample;
  if (!upper && dt <= last.dt * (1 + fitted)) return { error: last.error, cost: last.cost };
  if (!upper) return { reason: `longer than the longest step measured, ${milliseconds(last.dt)}` };
  if (Math.abs(upper.dt - dt) <= slack * dt) return { error: upper.error, cost: upper.cost };
  if (!lower) return { reason: `shorter than the shortest step measured, ${milliseconds(upper.dt)}` };
  const share = Math.log(dt / lower.dt) / Math.log(upper.dt / lower.dt);
  return { error: between(lower.error, upper.error, share), cost: between(lower.cost, upper.cost, share) };
}

const milliseconds = (dt: number): string => `${Number((1000 * dt).toPrecision(3))} ms`;

/// The reason why no curve fits: says which iterations, or which tolerance, were measured instead.
function otherwise(setting: Setting, points: Point[]): string {
  const counts = [...new Set(points.flatMap(({ iterations }) => iterations ?? []))].sort((a, b) => a - b);
  if (setting.iterations !== null && !counts.includes(setting.iterations)) {
    return `measured with ${counts.join(", ")} iteration${counts.length === 1 && counts[0] === 1 ? "" : "s"}`;
  }
  return `measured with the tolerance ${[...new Set(points.map(({ tolerance }) => tolerance))].join(", ")}`;
}
