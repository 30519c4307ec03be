// What a comparison found, in words and as a table.
import { make } from "../lab/dom";
import { iterationsText, stepText } from "../lab/text";
import type { Setting } from "../lab/types";
import { methodText } from "../panel/methods";

/// What the lab answers (server/lab/result.schema.json).
export interface CompareResult {
  time_s: number;
  complete: boolean;
  notes: string[];
  renderer: string;
  rate: number;
  vertices: number;
  truth: boolean;
  horizon_s: number | null;
  reference_error_m: number | null;
  a: Setting & { blew_up_at_s: number | null };
  b: Setting & { blew_up_at_s: number | null };
  times_s: number[];
  rms_m: number[];
  most_m: number[];
}

const digits = (value: number): string => String(Number(value.toPrecision(3)));

/// A length in millimetres; where that would be a small fraction, in micrometres.
export function lengthText(metres: number): string {
  if (metres === 0) return "0\u00a0mm";
  return metres < 1e-5 ? `${digits(1e6 * metres)}\u00a0µm` : `${digits(1e3 * metres)}\u00a0mm`;
}

/// What one side is: "A: the truth, in double precision", "B: XPBD, dt 1 ms, 4 iterations".
export function sideText(side: "A" | "B", result: CompareResult): string {
  if (side === "A" && result.truth) return "A: the truth, in double precision";
  const { method, dt_s, iterations } = side === "A" ? result.a : result.b;
  const parts = [methodText(method).name, `dt ${stepText(dt_s)}`, iterationsText(iterations)];
  return `${side}: ${parts.filter((part) => part !== "").join(", ")}`;
}

/// The present figures as a sentence.
export function presentText({ times_s, rms_m, most_m, horizon_s }: CompareResult, index: number): string {
  const [time, rms, most] = [times_s[index], rms_m[index], most_m[index]];
  if (time === undefined || rms === undefined || most === undefined) return "";
  const chaotic =
    horizon_s !== null && time > horizon_s + 1e-9 ? " Beyond the horizon: chaos decides where it is." : "";
  const apart =
    most === 0
      ? "A and B are the same, to the last bit."
      : `A and B are ${lengthText(rms)} apart (RMS), at most ${lengthText(most)}.`;
  return `At ${time.toFixed(2)} s: ${apart}${chaotic}`;
}

/// The whole run as a sentence.
export function runText({ times_s, most_m, rms_m }: CompareResult): string {
  const most = Math.max(0, ...most_m);
  const end = times_s.at(-1) ?? 0;
  if (most === 0) return `Up to ${end.toFixed(2)} s A and B never differ.`;
  const at = times_s[most_m.indexOf(most)] ?? 0;
  return (
    `Up to ${end.toFixed(2)} s they are at most ${lengthText(most)} apart, at ${at.toFixed(2)} s; ` +
    `at the end ${lengthText(rms_m.at(-1) ?? 0)} (RMS).`
  );
}

const mostRows = 26;

/// The moments for a table: not more than `mostRows`, evenly, the first and the last among them.
export function rowsOf(count: number): number[] {
  const stride = Math.max(1, Math.ceil((count - 1) / (mostRows - 1)));
  const rows = Array.from({ length: count }, (_, i) => i).filter((i) => i % stride === 0);
  if (count > 0 && rows.at(-1) !== count - 1) rows.push(count - 1);
  return rows;
}

export function tableOf({ times_s, rms_m, most_m }: CompareResult): HTMLTableElement {
  const table = make("table", "compare-table");
  const head = table.createTHead().insertRow();
  for (const title of ["Time", "RMS", "Largest"]) {
    const cell = make("th", "", title);
    cell.scope = "col";
    head.append(cell);
  }
  const body = table.createTBody();
  for (const i of rowsOf(times_s.length)) {
    const row = body.insertRow();
    for (const text of [`${(times_s[i] ?? 0).toFixed(2)} s`, lengthText(rms_m[i] ?? 0), lengthText(most_m[i] ?? 0)])
      row.insertCell().textContent = text;
  }
  return table;
}
