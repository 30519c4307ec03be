// What a parameter costs in time, in a sentence: what the scene's schema does not say. The figures are those of
// tests/README.md.

const stiffness =
  "Nothing by itself. The stiffer, the shorter the longest stable step of the explicit methods, and the more " +
  "iterations the others need.";
const picture = "Nothing: only the picture changes.";
const nothing = "Nothing to speak of.";

// The first that matches the end of a place counts.
const sentences: [RegExp, string][] = [
  [
    /\/solver\/method$/,
    "A step of rk4 takes 4 times one of symplectic_euler, of pbd, xpbd and vbd 2 to 3 times for each iteration, of " +
      "implicit_euler and bdf2 100 times and more: they make up for that by longer steps. The lab's chart measures it.",
  ],
  [/\/solver\/dt$/, "Half the step is twice the work for each simulated second."],
  [
    /\/solver\/iterations$/,
    "A step's work grows in proportion. Under implicit_euler and bdf2 it is the most that a step may take.",
  ],
  [/\/solver\/tolerance$/, "A smaller one takes more work in each step."],
  [
    /\/grid\/(columns|rows)$/,
    "Work and bytes grow with the number of vertices, and a finer grid needs shorter steps. The cloth starts anew.",
  ],
  [/\/material\/(structural|shear|warp|weft|poisson|bend|bending.*)$/, stiffness],
  [/\/material\/damping$/, "Nothing by itself. Much of it shortens the longest stable step of the explicit methods."],
  [
    /\/strain_limit(\/\w+)?$/,
    "Sweeps over the whole cloth after each step: one or two for a limit of 10 %, a dozen and more for 5 % or less.",
  ],
  [/\/material(\/(fabric|model))?$/, "A sheet of finite elements takes 1.1 to 2.3 times the springs on the same grid."],
  [
    /\/mass\/\w+$/,
    "Nothing by itself. The lighter a vertex, the shorter the longest stable step of the explicit methods.",
  ],
  [/\/(color|texture)$/, picture],
  [
    /\/self_collision$/,
    "A search for neighbours: about twice the time of a step between points, far more between surfaces.",
  ],
  [/\/self_collision\/kind$/, "Between surfaces a step takes some six times as long as between points."],
  [/\/self_collision\/thickness$/, "The thicker, the more pairs are near each other, and the longer a step takes."],
  [/^\/wind/, "A force on each triangle in each step; the numbers themselves cost nothing."],
  [/\/transform\//, "Nothing to speak of. A mesh that is moved into the cloth is refused."],
];

/// What the parameter at `path` costs.
export const costOf = (path: string): string => sentences.find(([place]) => place.test(path))?.[1] ?? nothing;
