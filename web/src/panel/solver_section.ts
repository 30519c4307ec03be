// The panel's section of the solver: method, time step, iterations, tolerance, and the notes below them.
import { type Field, type Note, number, type Section, type SolverFacts } from "./field";
import { automatic, type MethodText, methodText, type Setting } from "./methods";
import { readable } from "./slider";
import type { Operation, SceneDocument } from "../link/scene_types";

/// The field that carries the gauge.
export const timeStep = "/solver/dt";
const methodChoice = "/solver/method";
const iterationCount = "/solver/iterations";

export const secondsText = (seconds: number): string => (seconds === 1 / 60 ? "1/60 s" : `${readable(seconds)} s`);

const methodOf = (values: Record<string, unknown>): MethodText => methodText(String(values[methodChoice]));

/// Says what iterations are good for under the chosen method.
function tradeOff(values: Record<string, unknown>): Note {
  const { iterations } = methodOf(values);
  return iterations ? { text: iterations.trade, offer: suggestion(iterations.suits, values) } : { text: "" };
}

function suggestion(suits: Setting | null, values: Record<string, unknown>): Note["offer"] {
  if (
    !suits ||
    (readable(Number(values[timeStep])) === readable(suits.dt) && values[iterationCount] === suits.iterations)
  )
    return undefined;
  return {
    text: `Use ${secondsText(suits.dt)}, ${suits.iterations} iteration${suits.iterations === 1 ? "" : "s"}`,
    operations: [
      { op: "replace", path: timeStep, value: suits.dt },
      { op: "replace", path: iterationCount, value: suits.iterations },
    ],
  };
}

/// Says what the lab has chosen for the method `auto`, and offers to keep it.
function choiceNote({ auto }: SolverFacts): Note {
  const says = methodText(automatic).says;
  if (!auto) return { text: says };
  if (auto.state === "measuring")
    return {
      text: `Measuring. Until then ${methodText(auto.method).name}, ${secondsText(auto.dt_s)}, which is stable.`,
    };
  const kept: [string, unknown][] = [
    ["method", auto.method],
    ["dt", auto.dt_s],
    ["iterations", auto.iterations],
    ["tolerance", auto.tolerance],
  ];
  const operations: Operation[] = kept.flatMap(([key, value]) =>
    value == null ? [] : [{ op: "replace" as const, path: `/solver/${key}`, value }],
  );
  return { text: auto.why, offer: { text: "Keep these settings", operations } };
}

function automaticSection(method: Field): Section {
  const tolerance = number(
    "tolerance",
    ["/solver/tolerance"],
    { min: 1e-5, max: 0.1, log: true },
    { hint: "How far the vertices may be from the truth (RMS), as a share of the cloth's size" },
  );
  return {
    key: "solver",
    title: "Solver",
    open: true,
    sections: [],
    fields: [{ ...method, note: (_, facts) => choiceNote(facts) }, tolerance],
  };
}

export function solverSection(document: SceneDocument, methods: string[]): Section {
  const { method } = document.solver;
  const choices = methods.includes(method) ? methods : [method, ...methods];
  const names = Object.fromEntries(choices.map((id) => [id, methodText(id).name]));
  const choice: Field = {
    key: methodChoice,
    label: "method",
    paths: [methodChoice],
    kind: "choice",
    choices,
    names,
    keepStable: true,
    note: (values) => ({ text: methodOf(values).says }),
  };
  if (method === automatic) return automaticSection(choice);
  const { iterations } = methodText(method);
  const iterating: Field[] = iterations
    ? [
        number(
          "iterations",
          [iterationCount],
          { min: 1, max: iterations.most, step: 1, whole: true },
          {
            note: tradeOff,
          },
        ),
      ]
    : [];
  if (iterations?.solves)
    iterating.push(
      number(
        "tolerance",
        ["/solver/tolerance"],
        { min: 1e-8, max: 0.1, log: true },
        {
          hint:
            "Where the conjugate gradients stop: the residual left, as a share of the first. " +
            "Very short steps ask for a smaller one: what is left adds up.",
        },
      ),
    );
  return {
    key: "solver",
    title: "Solver",
    open: true,
    sections: [],
    fields: [choice, number("time step", [timeStep], { min: 1e-5, max: 0.05, log: true, unit: "s" }), ...iterating],
  };
}
