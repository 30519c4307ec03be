// Says what a cloth weighs with other rows and columns, and offers the other way.
import { notice } from "./notices";
import { readable } from "./slider";
import type { MassChange } from "../link/grid_places";
import type { Operation } from "../link/scene_types";

const toRead = 14_000; // [ms]

const massText = (mass: number): string =>
  mass < 0.1 ? `${readable(Number((1000 * mass).toPrecision(3)))} g` : `${readable(Number(mass.toPrecision(3)))} kg`;

export function tellMass({ path, vertex, whole, kept, otherwise }: MassChange, edit: (of: Operation[]) => void): void {
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
