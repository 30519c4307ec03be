// Says that the server has changed the solver with a change of the cloth, which would have blown up.
import { methodText } from "./methods";
import { notice } from "./notices";
import { secondsText } from "./solver_section";
import type { SceneDocument } from "../link/scene_types";

const toUndo = 14_000; // [ms]
type Solver = SceneDocument["solver"];

const by = ({ method, dt }: Solver): string => `Stepped by ${methodText(method).name}, ${secondsText(dt)}`;

export const keptText = (solver: Solver): string => `${by(solver)} now: it would have blown up as it was.`;

export function tellKept(solver: Solver, undo: () => void): void {
  const close = notice("info", {
    title: by(solver),
    lines: ["This cloth would have blown up with the method and the time step before."],
    actions: [{ label: "Undo", run: undo }],
    stays: true, // a phone has room for one notice: one that comes meanwhile must not take the way back
  });
  setTimeout(close, toUndo);
}
