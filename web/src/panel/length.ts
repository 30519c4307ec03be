// Lengths in words.
/// A length [m] in two digits and the unit that makes it readable.
export function lengthText(metres: number): string {
  const [factor, unit] = metres < 1e-4 ? [1e6, "µm"] : metres < 1 ? [1e3, "mm"] : [1, "m"];
  return `${Number((metres * factor).toPrecision(2))} ${unit}`;
}
