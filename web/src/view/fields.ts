// The fields that the cloth can be coloured by, and the colours of their values.
import type { FieldName, ShownField } from "../link/protocol";

interface FieldFacts {
  title: string;
  power: number; ///< colours are even in this power of the value
  least: string; ///< what the first colour means
  most(range: number): string; ///< what the last one means
}

const short = (value: number): string => String(Number(value.toPrecision(3)));

// The largest strain is often at a pin, and many times that of the rest of the cloth.
export const fields: Record<ShownField, FieldFacts> = {
  strain: { title: "Strain", power: 0.5, least: "0", most: (range) => `${short(100 * range)} %` },
  speed: { title: "Speed", power: 1, least: "0", most: (range) => `${short(range)} m/s` },
  contact: { title: "Contact", power: 1, least: "free", most: () => "touching" },
  growth: { title: "Growing mode", power: 0.5, least: "still", most: () => "swings most" },
};

export const isField = (name: string | null): name is FieldName =>
  name !== null && name !== "growth" && Object.hasOwn(fields, name);

/// Nine colours of viridis (van der Walt and Smith 2015), equally far apart, as shares of sRGB: lightness rises evenly,
/// and also without red or green.
export const scale = ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"];

/// The colours of a field from 0 on the left to its range on the right, as the style sheet has them.
export function gradient(field: ShownField): string {
  const at = (i: number): number => 100 * (i / (scale.length - 1)) ** (1 / fields[field].power);
  return `linear-gradient(to right, ${scale.map((colour, i) => `#${colour} ${at(i).toFixed(1)}%`).join(", ")})`;
}
