// Says what a cloth weighs with other rows and columns, and offers the other way.
import { notice } from "./notices";
import { readable } from "./slider";
import { type MassChange, masses, withPlaces } from "../link/grid_places";
import type { SceneStore } from "../link/scene_store";
import type { Operation, SceneDocument } from "../link/scene_types";

const toRead = 14_000; // [ms]

const massText = (mass: number): string =>
  mass < 0.1 ? `${readable(Number((1000 * mass).toPrecision(3)))} g` : `${readable(Number(mass.toPrecision(3)))} kg`;

/// Edits the scene. A grid that gets other rows and columns keeps its pins' places and its mass; `loaded` is the scene
/// as it was loaded, in the order of `document`.
export function editGrids(
  store: SceneStore,
  document: SceneDocument,
  loaded: SceneDocument | null,
  operations: Operation[],
  keepStable?: boolean,
): void {
  const mass = masses(document, operations, loaded);
  store.edit([...withPlaces(document, operations), ...mass.operations], keepStable);
  for (const each of mass.changes) tellMass(each, (more) => store.edit(more, true));
}

function tellMass({ path, vertex, whole, kept, otherwise }: MassChange, edit: (of: Operation[]) => void): void {
  const byVertex = kept === "vertex";
  const close = notice("info", {
    title: byVertex ? `Each vertex keeps its ${massText(vertex)}` : `The cloth keeps its ${massText(whole)}`,
    lines: [byVertex ? `The cloth weighs ${massText(whole)} now.` : `A vertex has ${massText(vertex)} now.`],
    actions: [
      {
        label: byVertex
          ? `${massText((whole * otherwise) / vertex)} in all instead`
          : `${massText(otherwise)} a vertex instead`,
        run: () => edit([{ op: "replace", path, value: otherwise }]),
      },
    ],
    stays: true, // a phone has room for one notice: that the cloth was rebuilt must not take the offer away
  });
  setTimeout(close, toRead);
}
