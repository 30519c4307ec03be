// The results that the server's lab sends (server/lab/result.schema.json): the parts that the page reads.
import type { RpcErrorData } from "../link/rpc";
import type { Patch } from "../link/scene_types";

export type Kind = "chart" | "stability" | "choose" | "simplify";
export const axes = ["position", "energy", "strain", "rest"] as const;
export type Axis = (typeof axes)[number];

/// A setting to step a scene with; null for a number that the method does not use.
export interface Setting {
  method: string;
  dt_s: number;
  iterations: number | null;
  tolerance: number | null;
}

export type Errors = Record<Axis, number | null>; ///< relative errors: 0.01 is one percent
/// [ms per simulated second]. The median lies between low and high; null if there are too few runs to tell.
export interface Cost {
  median: number;
  minimum: number;
  runs: number;
  low: number | null;
  high: number | null;
}

export interface Point extends Setting {
  error: Errors;
  largest_position_error: number | null;
  largest_position_error_low: number | null; ///< bounds of the largest error in a choice; null: not known
  largest_position_error_high: number | null;
  ms_a_simulated_s: Cost | null;
  blew_up_at_s: number | null;
  convergence: { residual: number; error_m: number } | null; ///< of the last step; null: not measured
  dt_over_limit: number | null;
  patch: Patch;
}

interface Measured {
  scene: string;
  renderer: string;
  complete: boolean;
  notes: string[];
}

export interface AxisFacts {
  available: boolean;
  reason: string;
  reference_error: number | null;
  float32_floor: number | null;
}
export interface LeftOut {
  method: string;
  dt_s: number | null;
  iterations: number | null;
  reason: string;
}

export interface Chart extends Measured {
  kind: "chart";
  size_m: number;
  time_s: number;
  horizon_s: number;
  horizon_reason: string;
  present: Setting;
  axes: Record<Axis, AxisFacts>;
  points: Point[];
  left_out: LeftOut[];
}

export interface MapCell {
  dt_s: number;
  growth: number;
  blew_up: boolean;
}
export interface MapColumn {
  value: number;
  theory_s: number | null;
  held_s: number | null;
  failed_s: number | null;
  disagrees: boolean;
  reason: string;
  cells: MapCell[];
}
export interface StabilityMap extends Measured {
  kind: "stability";
  field: string; ///< JSON Pointer of a number, or "stiffness": a factor on all stiffnesses
  unit: string;
  present: { value: number; dt_s: number; method: string };
  time_s: number;
  steps: number;
  methods: { method: string; columns: MapColumn[] }[];
}

export interface Choice extends Measured {
  kind: "choose";
  tolerance: number;
  time_s: number;
  asked_s: number;
  horizon_s: number;
  horizon_reason: string;
  reference_error: number;
  met: boolean;
  chosen: Point;
  runner_up: Point | null;
  present: Point;
  why: string;
  patch: Patch;
  tried: Point[];
}

export interface Variant {
  name: string;
  patch: Patch;
  measured: boolean;
  reason: string;
  error: Errors;
  change: number | null;
  ms_a_simulated_s: Cost | null;
  cost_ratio: number | null;
  cost_ratio_low: number | null; ///< the ratio lies between low and high; null: too few timings to tell
  cost_ratio_high: number | null;
  saves: "yes" | "no" | "cannot tell" | null;
  dt_limit_s: number | null;
  drop: boolean;
}
export interface Simplification extends Measured {
  kind: "simplify";
  tolerance: number;
  time_s: number;
  horizon_s: number;
  size_m: number;
  setting: Setting;
  whole: Variant;
  variants: Variant[];
  recommended: Variant;
  why: string;
}

export interface Results {
  chart: Chart;
  stability: StabilityMap;
  choose: Choice;
  simplify: Simplification;
}

/// Notification `lab.progress`.
export interface Progress {
  job: number;
  kind: Kind;
  state: "queued" | "running";
  ahead: number;
  done: number;
  total: number;
  doing: string;
  stale: boolean;
}

/// Notification `lab.result`: the result so far.
export interface Arrival {
  job: number;
  kind: Kind;
  state: "running" | "finished" | "cancelled" | "failed";
  stale: boolean;
  revision: number;
  cached: boolean;
  beside: boolean; ///< the session was playing during the measurement
  result: Results[Kind] | null;
  error?: RpcErrorData;
}
