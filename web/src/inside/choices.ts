// What See inside shows, as the user has chosen it and this browser keeps it.

/// What is drawn over the cloth, each by itself.
export const overlays = ["wireframe", "normals", "contacts", "structural", "shear", "bend", "elements"] as const;
export type Overlay = (typeof overlays)[number];

export interface Choices extends Record<Overlay, boolean> {
  worst: number; ///< so many of the most strained springs or elements are marked
  curves: boolean; ///< the curves of the last minute are unfolded
}

export const choicesKey = "clothlab-inside";
export const mostWorst = 100;

/// A whole number that the user typed or the browser kept, in [0, mostWorst]; `otherwise` if it is none.
export function worstFrom(typed: unknown, otherwise: number): number {
  const number = typeof typed === "string" && typed.trim() !== "" ? Number(typed) : typed;
  if (typeof number !== "number" || !Number.isInteger(number)) return otherwise;
  return Math.min(mostWorst, Math.max(0, number));
}

/// What was kept, or the defaults where it is nothing sensible.
export function readChoices(kept: string | null): Choices {
  let found: Record<string, unknown> = {};
  try {
    found = (JSON.parse(kept ?? "{}") ?? {}) as Record<string, unknown>;
  } catch {
    // another version of the page may have kept anything
  }
  const shown = Object.fromEntries(overlays.map((overlay) => [overlay, found[overlay] === true]));
  return { ...(shown as Record<Overlay, boolean>), worst: worstFrom(found.worst, 10), curves: found.curves !== false };
}
