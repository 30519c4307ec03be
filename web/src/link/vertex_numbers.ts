// The numbers of a cloth's vertices. A document counts those of its mesh's file; frames count those of the mesh that
// became of them, in which vertices at one place are one and those of no face are left out.
import type { ClothRange } from "./protocol";
import type { Cloth } from "./scene_types";

/// Of a mesh from a file: [vertices of the file] the number of each in frames, 0xffffffff if it is left out. "same":
/// each has its own, counted from the cloth's first.
export type FileNumbers = Uint32Array | "same";

/// Null: not known yet; of files the server alone knows it.
const numbersOf = ({ mesh }: Cloth, { numbers }: ClothRange): FileNumbers | null =>
  "file" in mesh || "obj" in mesh ? (numbers ?? null) : "same";

/// The number in frames of the vertex with this number in the document; null: there is none, or it is not known.
export function inFrame(number: number, cloth: Cloth, range: ClothRange): number | null {
  const numbers = numbersOf(cloth, range);
  const vertex = numbers === "same" ? range.firstVertex + number : numbers?.[number];
  return vertex !== undefined && vertex < range.firstVertex + range.vertexCount ? vertex : null;
}

/// The number in the document of a vertex in frames, of several that became one the first; null: it is not known.
export function inDocument(vertex: number, cloth: Cloth, range: ClothRange): number | null {
  const numbers = numbersOf(cloth, range);
  if (numbers === "same") return vertex - range.firstVertex;
  const number = numbers?.indexOf(vertex) ?? -1;
  return number < 0 ? null : number;
}
