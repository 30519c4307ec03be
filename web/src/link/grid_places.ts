// Pins and weights of a grid keep their places when its rows or columns change: they name vertices by row and column.
import type { At, Operation, SceneDocument } from "./scene_types";

interface Size {
  columns: number;
  rows: number;
}

/// The line of `after` lines that lies nearest to where line `index` of `before` lies: the last one stays the last.
const line = (index: number, before: number, after: number): number => Math.round((index * (after - 1)) / (before - 1));

/// The same place in a grid of another size. Boxes are places already.
export function placeIn(at: At, before: Size, after: Size): At {
  if (typeof at !== "string") return at;
  const [kind, ...numbers] = at.split(/[:,]/);
  const column = (index: number): number => line(index, before.columns, after.columns);
  const row = (index: number): number => line(index, before.rows, after.rows);
  const [first = 0, second = 0] = numbers.map(Number);
  if (kind === "corner") return `corner:${column(first)},${row(second)}`;
  if (kind === "edge") return `edge:${numbers[0]}:${numbers[0] === "row" ? row(second) : column(second)}`;
  if (kind !== "vertex") return at;
  return `vertex:${row(Math.floor(first / before.columns)) * after.columns + column(first % before.columns)}`;
}

const grid = /^\/cloths\/(\d+)\/mesh\/grid\/(columns|rows)$/;

/// The operations, and what puts the pins and weights of each grid that they resize to its new rows and columns.
export function withPlaces({ cloths }: SceneDocument, operations: Operation[]): Operation[] {
  const sizes = new Map<number, Size>();
  for (const { path, value } of operations) {
    const [, index, key] = grid.exec(path) ?? [];
    const mesh = cloths[Number(index)]?.mesh;
    if (key === undefined || !mesh || !("grid" in mesh) || !(Number(value) >= 2)) continue;
    sizes.set(Number(index), { ...mesh.grid, ...sizes.get(Number(index)), [key]: Number(value) });
  }
  const moves = [...sizes].flatMap(([index, size]): Operation[] => {
    const cloth = cloths[index] as SceneDocument["cloths"][number];
    const now = (cloth.mesh as { grid: Size }).grid;
    return (["pins", "weights"] as const).flatMap((list) =>
      (cloth[list] ?? []).flatMap(({ at }, i): Operation[] => {
        const value = placeIn(at, now, size);
        return value === at ? [] : [{ op: "replace", path: `/cloths/${index}/${list}/${i}/at`, value }];
      }),
    );
  });
  return [...operations, ...moves];
}
