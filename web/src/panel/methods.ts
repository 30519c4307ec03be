// The methods of time stepping: their common names, a line about each, and what its iterations are good for.

/// A time step [s] and a number of iterations that suit a method.
export interface Setting {
  dt: number;
  iterations: number;
}

export interface Iterations {
  most: number; ///< number at the slider's right end
  trade: string; ///< what more iterations are good for, compared with shorter steps
  suits: Setting | null; ///< a good start
  solves: boolean; ///< true if it iterates until `tolerance` is met
}

export interface MethodText {
  name: string;
  says: string;
  iterations: Iterations | null; ///< null: the method does not iterate
}

const frame = 1 / 60;
const sweeps = (trade: string, suits: Setting | null): Iterations => ({ most: 50, trade, suits, solves: false });

const texts: Record<string, MethodText> = {
  auto: {
    name: "Auto",
    says: "The lab measures every method on this scene and takes the cheapest that keeps the tolerance.",
    iterations: null,
  },
  explicit_euler: {
    name: "Explicit Euler",
    says: "First order, one force a step. Gains energy unless damping takes it away.",
    iterations: null,
  },
  symplectic_euler: {
    name: "Symplectic Euler",
    says: "First order, one force a step. Keeps the energy bounded below its limit.",
    iterations: null,
  },
  verlet: {
    name: "Verlet",
    says: "Second order, one force a step. Keeps the energy bounded below its limit.",
    iterations: null,
  },
  rk4: {
    name: "Runge–Kutta 4",
    says: "Fourth order, four forces a step. The most accurate below its limit.",
    iterations: null,
  },
  implicit_euler: {
    name: "Implicit Euler",
    says: "First order, solves for the end of the step. Holds at any step, and damps the motion.",
    iterations: {
      most: 20,
      solves: true,
      suits: { dt: frame, iterations: 1 },
      trade:
        "Each iteration is a Newton step: one linear solve. One will do, but for a step in which the cloth turns far " +
        "or meets something.",
    },
  },
  bdf2: {
    name: "BDF2",
    says:
      "Second order, solves for the end of the step as Implicit Euler does and costs the same. " +
      "Holds at any step, and damps the motion far less.",
    iterations: {
      most: 20,
      solves: true,
      suits: { dt: frame, iterations: 2 },
      trade:
        "Each iteration is a Newton step: one linear solve. A second one makes a long step in which the cloth turns " +
        "three times as exact.",
    },
  },
  pbd: {
    name: "PBD",
    says:
      "Position-based dynamics: puts one spring after another right. Holds at any step; " +
      "how stiff the cloth is depends on step and iterations.",
    iterations: sweeps(
      "Many short steps with one iteration come nearer to the stiffness asked for than one long step with many.",
      { dt: 0.001, iterations: 1 },
    ),
  },
  xpbd: {
    name: "XPBD",
    says: "PBD that knows N/m: what each spring has pushed is remembered through the step. Holds at any step.",
    iterations: sweeps(
      "Many short steps with one iteration beat one long step with many (Macklin et al. 2019). " +
        "Too few leave the cloth softer than asked for.",
      { dt: 0.001, iterations: 1 },
    ),
  },
  vbd: {
    name: "VBD",
    says: "Vertex block descent: moves one vertex after another to where implicit Euler wants it. Holds at any step.",
    iterations: sweeps(
      "Many short steps with one or two iterations beat one long step with many. Too few for the step let the cloth stretch like rubber.",
      { dt: 0.001, iterations: 2 },
    ),
  },
};

/// The method that the lab chooses; see SolverFacts.
export const automatic = "auto";

const ids = new RegExp(
  `\\b(${Object.keys(texts)
    .filter((id) => id !== "auto")
    .join("|")})\\b`,
  "g",
);

/// A text of the server, which names methods as documents do, with their common names.
export const withNames = (text: string): string => text.replace(ids, (id) => methodText(id).name);

/// The texts of a method. One that this page does not know is shown by the server's name.
export function methodText(id: string): MethodText {
  return texts[id] ?? { name: id.replaceAll("_", " "), says: "", iterations: { ...sweeps("", null), solves: true } };
}
