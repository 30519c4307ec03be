// The methods of time stepping by the names people know them by, and in a line what to expect of each.

export interface MethodText {
  name: string;
  says: string;
  iterates: boolean;  ///< it reads `iterations` and `tolerance`
}

const texts: Record<string, MethodText> = {
  explicit_euler: { name: "Explicit Euler", says: "First order, one force a step. Gains energy unless damping takes it away.", iterates: false },
  symplectic_euler: { name: "Symplectic Euler", says: "First order, one force a step. Keeps the energy bounded below its limit.", iterates: false },
  verlet: { name: "Verlet", says: "Second order, one force a step. Keeps the energy bounded below its limit.", iterates: false },
  rk4: { name: "Runge–Kutta 4", says: "Fourth order, four forces a step. The most accurate below its limit.", iterates: false },
  implicit_euler: { name: "Implicit Euler", says: "First order, solves for the end of the step. Holds at any step, and damps the motion.", iterates: true },
};

/// One the page does not know yet is shown as the server spells it.
export function methodText(id: string): MethodText {
  return texts[id] ?? { name: id.replaceAll("_", " "), says: "", iterates: true };
}
