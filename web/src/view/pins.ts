// Finds the vertices that a scene's pins hold, by the rules of server/scene/README.md, to draw markers on them.
import { Euler, MathUtils, Vector3 } from "three";
import type { ClothRange } from "../link/protocol";
import type { At, Cloth, Motion, Vec3 } from "../link/scene_types";
import { inFrame } from "../link/vertex_numbers";

/// Rest positions of a cloth in world space [m]; none of a mesh from a file, which the page does not have.
export function restPositions(cloth: Cloth): Vector3[] {
  const { translate, rotate, scale } = cloth.transform;
  const [x, y, z] = rotate.map(MathUtils.degToRad) as Vec3;
  // About x first, then y, then z, each a fixed axis: the matrix Z * Y * X.
  const turn = new Euler(x, y, z, "ZYX");
  const place = (point: Vector3) =>
    point
      .multiplyScalar(scale)
      .applyEuler(turn)
      .add(new Vector3(...translate));
  if ("vertices" in cloth.mesh) return cloth.mesh.vertices.map((vertex) => place(new Vector3(...vertex)));
  if (!("grid" in cloth.mesh)) return [];
  const { columns, rows, width, height } = cloth.mesh.grid;
  const points: Vector3[] = [];
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      points.push(place(new Vector3(width * (column / (columns - 1) - 0.5), 0, (height * row) / (rows - 1))));
    }
  }
  return points;
}

function verticesAt(at: At, cloth: Cloth, rest: Vector3[]): number[] {
  if (typeof at !== "string") {
    const [low, high] = at.box.map((corner) => new Vector3(...corner)) as [Vector3, Vector3];
    return rest.flatMap((point, i) => (point.clone().clamp(low, high).equals(point) ? [i] : []));
  }
  const [kind, first, second] = at.split(":");
  if (kind === "vertex") return [Number(first)];
  if (!("grid" in cloth.mesh)) return [];
  const { columns, rows } = cloth.mesh.grid;
  if (kind === "corner") {
    const [column = 0, row = 0] = (first ?? "").split(",").map(Number);
    return [row * columns + column];
  }
  const line = Number(second);
  return first === "row"
    ? Array.from({ length: columns }, (_, column) => line * columns + column)
    : Array.from({ length: rows }, (_, row) => row * columns + line);
}

/// Vertices that pins of the cloth hold, as the document counts them, each with the motion of its last pin.
export function heldVertices(cloth: Cloth): Map<number, Motion> {
  const rest = cloth.pins.some((pin) => typeof pin.at !== "string") ? restPositions(cloth) : [];
  return new Map(
    cloth.pins.flatMap((pin) => verticesAt(pin.at, cloth, rest).map((vertex) => [vertex, pin.motion] as const)),
  );
}

/// Vertices that pins of the cloth hold, as frames count them, each once; none while the numbers are not known.
export const heldInFrame = (cloth: Cloth, range: ClothRange): Set<number> =>
  new Set([...heldVertices(cloth).keys()].flatMap((number) => inFrame(number, cloth, range) ?? []));
