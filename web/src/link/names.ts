// Names of a scene's parts that no other part has.

/// The least number, from 1, for which `name` (1) or `name-number` is free.
export function freeNumber(name: string, others: { name: string }[]): number {
  const names = new Set(others.map((each) => each.name));
  let number = 1;
  while (names.has(numbered(name, number))) ++number;
  return number;
}

/// "sphere", "sphere-2".
export const numbered = (name: string, number: number): string => (number === 1 ? name : `${name}-${number}`);

export const freeName = (name: string, others: { name: string }[]): string => numbered(name, freeNumber(name, others));
