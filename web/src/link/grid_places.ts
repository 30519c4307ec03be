// Pins and weights of a grid keep their places when its rows or columns change: they name vertices by row and column.
// The cloth keeps its mass.
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

/// The grids that operations resize, by their cloths' places.
function resized({ cloths }: SceneDocument, operations: Operation[]): Map<number, Size> {
  const sizes = new Map<number, Size>();
  for (const { path, value } of operations) {
    const [, index, key] = grid.exec(path) ?? [];
    const mesh = cloths[Number(index)]?.mesh;
    if (key === undefined || !mesh || !("grid" in mesh) || !(Number(value) >= 2)) continue;
    sizes.set(Number(index), { ...mesh.grid, ...sizes.get(Number(index)), [key]: Number(value) });
  }
  return sizes;
}

/// The operations, and what puts the pins and weights of each grid that they resize to its new rows and columns.
export function withPlaces(document: SceneDocument, operations: Operation[]): Operation[] {
  const moves = [...resized(document, operations)].flatMap(([index, size]): Operation[] => {
    const cloth = document.cloths[index] as SceneDocument["cloths"][number];
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

/// The operations that give every grid half the rows and columns; null: all have few.
export function coarser({ cloths }: SceneDocument, least = 9): Operation[] | null {
  const half = (count: number): number => Math.max(least, Math.ceil(count / 2));
  const operations = cloths.flatMap(({ mesh }, i): Operation[] =>
    "grid" in mesh
      ? (["columns", "rows"] as const)
          .filter((key) => half(mesh.grid[key]) < mesh.grid[key])
          .map((key) => ({ op: "replace", path: `/cloths/${i}/mesh/grid/${key}`, value: half(mesh.grid[key]) }))
      : [],
  );
  return operations.length > 0 ? operations : null;
}

/// What becomes of the mass of a grid that gets other rows and columns.
export interface MassChange {
  path: string; ///< of the mass of a vertex
  vertex: number; ///< [kg], then
  whole: number; ///< of the cloth [kg], then
  kept: "vertex" | "whole";
  otherwise: number; ///< of a vertex [kg], if the other were kept
}

const count = ({ columns, rows }: Size): number => columns * rows;
const readable = (mass: number): number => Number(mass.toPrecision(6));
const apart = 1e-3; // as a share: numbers are rounded to six digits

/// A cloth whose mass is said by vertex keeps its mass as a whole: a finer mesh is not a heavier cloth. Where the user
/// has said the mass of a vertex, so that the whole differs from that of the scene as `loaded`, each vertex keeps it.
export function masses(
  document: SceneDocument,
  operations: Operation[],
  loaded: SceneDocument | null,
): { operations: Operation[]; changes: MassChange[] } {
  const changes = [...resized(document, operations)].flatMap(([index, size]): MassChange[] => {
    const { mesh, mass } = document.cloths[index] as SceneDocument["cloths"][number];
    const path = `/cloths/${index}/mass/per_vertex`;
    const said = operations.some((each) => each.path === path || path.startsWith(`${each.path}/`));
    if (!mass || !("per_vertex" in mass) || said) return [];
    const before = count((mesh as { grid: Size }).grid);
    const ratio = before / count(size);
    if (ratio === 1) return [];
    const then = loaded?.cloths[index];
    const own =
      then?.mass && "per_vertex" in then.mass && "grid" in then.mesh
        ? Math.abs((mass.per_vertex * before) / (then.mass.per_vertex * count(then.mesh.grid)) - 1) > apart
        : false;
    const [same, shared] = [mass.per_vertex, readable(mass.per_vertex * ratio)];
    const [vertex, otherwise] = own ? [same, shared] : [shared, same];
    return [{ path, vertex, otherwise, whole: readable(vertex * count(size)), kept: own ? "vertex" : "whole" }];
  });
  const put = ({ path, vertex: value }: MassChange): Operation => ({ op: "replace", path, value });
  return { operations: changes.filter(({ kept }) => kept === "whole").map(put), changes };
}
