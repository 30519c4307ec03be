// The ranges that the user has fixed for the colours of fields, kept in this browser; else each frame's own range.
import { inBrowser } from "../link/kept";
import type { FieldName, ShownField } from "../link/protocol";

const key = "clothlab-colour-range";

function read(): Partial<Record<FieldName, number>> {
  try {
    const kept = (JSON.parse(inBrowser.get(key) ?? "{}") ?? {}) as Record<string, unknown>;
    return Object.fromEntries(Object.entries(kept).filter(([, range]) => typeof range === "number" && range > 0));
  } catch {
    return {};
  }
}
const fixed = read();

/// The value of the last colour, if the user has fixed it.
export const fixedRange = (field: ShownField): number | undefined => (field === "growth" ? undefined : fixed[field]);

/// undefined: from now on each frame's own.
export function fixRange(field: FieldName, range: number | undefined): void {
  fixed[field] = range;
  inBrowser.set(key, JSON.stringify(fixed));
}
