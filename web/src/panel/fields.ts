// What the panel offers for a scene: a list of sections and fields, each tied to JSON Pointers of the document.
import { automatic, methodText, type MethodText, type Setting } from "./methods";
import { readable, type Scale } from "./slider";
import { valueAt } from "../link/json_patch";
import {
  type At,
  byKind,
  type Motion,
  type Operation,
  type SceneDocument,
  type Shape,
  type Vec3,
} from "../link/scene_types";

/// What `sim.status` says of the solver.
export interface SolverFacts {
  /// Under the method `auto`: what steps the scene, and why.
  auto?: {
    state: "measuring" | "chosen" | "failed";
    method: string;
    dt_s: number;
    iterations: number | null;
    tolerance: number | null;
    why: string;
  } | null;
  /// Of a spring's stretch the share that a visit takes away, for each cloth; only under PBD.
  pbd_stiffness?: Record<(typeof kinds)[number], number | null>[] | null;
  /// The least thickness of self-collision at which no vertex slips between those of a triangle [m].
  thickness_that_holds?: number | null;
}

/// A line below a control, and what a click in it would change.
export interface Note {
  text: string;
  offer?: { text: string; operations: Operation[] };
}

interface FieldBase {
  key: string; ///< unique in the panel
  label: string;
  paths: string[]; ///< the places it writes; the first is the one it reads
  onRelease?: boolean; ///< sent when let go: each value rebuilds the cloth
  hint?: string; ///< a tooltip
  note?(values: Record<string, unknown>, facts: SolverFacts): Note; ///< `values` by the keys of all fields
  read?(document: SceneDocument): unknown;
  write?(value: unknown): unknown;
}
export type Field =
  | (FieldBase & { kind: "number"; scale: Scale })
  | (FieldBase & { kind: "toggle" | "color" })
  | (FieldBase & { kind: "choice"; choices: string[]; names?: Record<string, string> });

export interface Section {
  key: string;
  title: string;
  open: boolean;
  fields: Field[];
  sections: Section[];
}

const meter = { unit: "m" };
const number = (label: string, paths: string[], scale: Scale, more: Partial<FieldBase> = {}): Field => ({
  key: paths[0] as string,
  label,
  paths,
  kind: "number",
  scale,
  ...more,
});

const at = (bases: string[], rest: string): string[] => bases.map((base) => base + rest);

function vector(label: string, bases: string[], scale: Scale): Field[] {
  return ["x", "y", "z"].map((axis, i) => number(`${label} ${axis}`, at(bases, `/${i}`), scale));
}

const motionKinds = ["still", "oscillate", "linear", "spin"];
const motionKind = (motion: Motion): string => (motion ? (Object.keys(motion)[0] as string) : "still");
const axes: Record<string, Vec3> = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };

function freshMotion(kind: string, center: Vec3): Motion {
  switch (kind) {
    case "oscillate":
      return { oscillate: { axis: [0, 0, 1], amplitude: 0.2, frequency: 0.5 } };
    case "linear":
      return { linear: { velocity: [0, 0, 0.1] } };
    case "spin":
      return { spin: { axis: [0, 1, 0], center, degrees_per_second: 30 } };
    default:
      return null;
  }
}

function axisField(bases: string[], current: Vec3): Field {
  const name = (axis: Vec3) =>
    Object.keys(axes).find((key) => (axes[key] as Vec3).every((v, i) => v === axis[i])) ?? "other";
  const choices = name(current) === "other" ? ["x", "y", "z", "other"] : ["x", "y", "z"];
  return {
    key: `${bases[0]}/axis`,
    label: "axis",
    paths: at(bases, "/axis"),
    kind: "choice",
    choices,
    read: (document) => name(valueAt(document, `${bases[0]}/axis`) as Vec3),
    write: (value) => axes[String(value)] ?? current,
  };
}

/// Fields of the motions at `bases`, which are all equal and edited together.
function motionFields(bases: string[], motion: Motion, center: Vec3): Field[] {
  const kind: Field = {
    key: `${bases[0]}#kind`,
    label: "motion",
    paths: bases,
    kind: "choice",
    choices: motionKinds,
    read: (document) => motionKind(valueAt(document, bases[0] as string) as Motion),
    write: (value) => freshMotion(String(value), center),
  };
  if (!motion) return [kind];
  if ("oscillate" in motion) {
    const inside = at(bases, "/oscillate");
    return [
      kind,
      axisField(inside, motion.oscillate.axis),
      number("amplitude", at(inside, "/amplitude"), { min: 0, max: 0.5, step: 0.005, ...meter }),
      number("frequency", at(inside, "/frequency"), { min: 0, max: 3, step: 0.01, unit: "Hz" }),
    ];
  }
  if ("linear" in motion)
    return [kind, ...vector("velocity", at(bases, "/linear/velocity"), { min: -2, max: 2, step: 0.01, unit: "m/s" })];
  const inside = at(bases, "/spin");
  return [
    kind,
    axisField(inside, motion.spin.axis),
    number("speed", at(inside, "/degrees_per_second"), { min: -360, max: 360, step: 1, unit: "°/s" }),
  ];
}

const pinTitle = (at: At | undefined): string => (typeof at === "string" ? `Pin ${at}` : "Pin in a box");

function pinSections(document: SceneDocument, cloth: number): Section[] {
  const groups = new Map<string, number[]>();
  document.cloths[cloth]?.pins.forEach((pin, i) => {
    const same = JSON.stringify(pin.motion);
    groups.set(same, [...(groups.get(same) ?? []), i]);
  });
  return [...groups.entries()].map(([motion, pins]) => ({
    key: `/cloths/${cloth}/pins/${pins.join("+")}`,
    title: pins.length === 1 ? pinTitle(document.cloths[cloth]?.pins[pins[0] as number]?.at) : `${pins.length} pins`,
    open: false,
    sections: [],
    fields: motionFields(
      pins.map((pin) => `/cloths/${cloth}/pins/${pin}/motion`),
      JSON.parse(motion) as Motion,
      [0, 0, 0],
    ),
  }));
}

/// In percent; null, no limit, is the slider's left end.
function strainLimit(paths: string[]): Field {
  return number(
    "strain limit",
    paths,
    { min: 0.1, max: 100, log: true, zero: true, zeroText: "off", unit: "%" },
    {
      hint: "The most a spring may stretch, after Provot 1995",
      read: (document) => 100 * ((valueAt(document, paths[0] as string) as number | null) ?? 0),
      write: (percent) => (Number(percent) > 0 ? Number((Number(percent) / 100).toPrecision(6)) : null),
    },
  );
}

const kinds = ["structural", "shear", "bend"] as const;
const percent = (share: number): string => `${readable(Number((100 * share).toPrecision(2)))}\u00a0%`;

/// PBD knows no N/m: what the server makes of them for a cloth. Nothing under the other methods.
function pbdStiffness(index: number, { pbd_stiffness }: SolverFacts): Note {
  const cloth = pbd_stiffness?.[index];
  const shares = kinds.flatMap((kind) => (cloth?.[kind] == null ? [] : [`${kind}\u00a0${percent(cloth[kind])}`]));
  if (shares.length === 0) return { text: "" };
  return {
    text: `PBD knows no N/m. For this step and these iterations it takes away of a spring's stretch at each visit: ${shares.join(", ")}.`,
  };
}

function clothSection(document: SceneDocument, index: number): Section {
  const cloth = document.cloths[index] as SceneDocument["cloths"][number];
  const base = `/cloths/${index}`;
  const stiffness = { min: 10, max: 200000, log: true, zero: true, unit: "N/m" };
  const mass: Field =
    "per_vertex" in cloth.mass
      ? number("mass", [`${base}/mass/per_vertex`], { min: 1e-5, max: 1, log: true, unit: "kg/vertex" })
      : number("mass", [`${base}/mass/area_density`], { min: 0.02, max: 20, log: true, unit: "kg/m²" });
  const count = { min: 3, max: 150, step: 1, whole: true };
  const grid: Field[] =
    "grid" in cloth.mesh
      ? [
          number("columns", [`${base}/mesh/grid/columns`], count, { onRelease: true }),
          number("rows", [`${base}/mesh/grid/rows`], count, { onRelease: true }),
        ]
      : [];
  return {
    key: base,
    title: document.cloths.length === 1 && cloth.name === "cloth" ? "Cloth" : `Cloth: ${cloth.name}`,
    open: true,
    fields: [
      number("structural", [`${base}/material/structural`], stiffness),
      number("shear", [`${base}/material/shear`], stiffness),
      number("bend", [`${base}/material/bend`], stiffness, { note: (_, facts) => pbdStiffness(index, facts) }),
      number("damping", [`${base}/material/damping`], { min: 0.01, max: 100, log: true, zero: true, unit: "N s/m" }),
      strainLimit([`${base}/material/strain_limit`]),
      mass,
      ...grid,
      { key: `${base}/color`, label: "colour", paths: [`${base}/color`], kind: "color" },
      {
        key: `${base}/texture`,
        label: "texture",
        paths: [`${base}/texture`],
        kind: "choice",
        choices: ["weave", "checker", "stripes", "plain"],
      },
    ],
    sections: pinSections(document, index),
  };
}

/// Of a shape, and where a turn of it starts around.
function shapeFields(shape: Shape, base: string): { fields: Field[]; center: Vec3 } {
  const place = { min: -2, max: 2, step: 0.005, ...meter };
  const made = byKind<{ fields: Field[]; center: Vec3 }>(shape, {
    sphere: ({ center }) => ({
      fields: [
        ...vector("center", [`${base}/sphere/center`], place),
        number("radius", [`${base}/sphere/radius`], { min: 0.02, max: 1, step: 0.005, ...meter }),
      ],
      center,
    }),
    plane: () => ({ fields: [number("height", [`${base}/plane/point/1`], place)], center: [0, 0, 0] }),
  });
  return made ?? { fields: [], center: [0, 0, 0] };
}

function colliderSection(document: SceneDocument, index: number): Section {
  const collider = document.colliders[index] as SceneDocument["colliders"][number];
  const base = `/colliders/${index}`;
  const shape = shapeFields(collider, base);
  return {
    key: base,
    title: collider.name ? `Collider: ${collider.name}` : `Collider ${index + 1}`,
    open: false,
    sections: [],
    fields: [
      ...shape.fields,
      number("friction", [`${base}/friction`], { min: 0, max: 2, step: 0.01 }),
      number("restitution", [`${base}/restitution`], { min: 0, max: 1, step: 0.01 }),
      ...motionFields([`${base}/motion`], collider.motion, shape.center),
    ],
  };
}

function worldSection(): Section {
  return {
    key: "world",
    title: "World",
    open: true,
    sections: [],
    fields: [
      number("gravity y", ["/gravity/1"], { min: -20, max: 5, step: 0.1, unit: "m/s²" }),
      number("air drag", ["/air_drag"], { min: 0, max: 5, step: 0.01, unit: "1/s" }),
    ],
  };
}

/// Where the gauge belongs.
export const timeStep = "/solver/dt";
const methodChoice = "/solver/method";
const iterationCount = "/solver/iterations";

const secondsText = (seconds: number): string => (seconds === 1 / 60 ? "1/60 s" : `${readable(seconds)} s`);

const methodOf = (values: Record<string, unknown>): MethodText => methodText(String(values[methodChoice]));

/// What iterations are good for under the method that is chosen.
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

/// What the lab has chosen for the method `auto`, and a way to keep it.
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

function solverSection(document: SceneDocument, methods: string[]): Section {
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
          hint: "Where the conjugate gradients stop: the residual left, as a share of the first. Very short steps ask for a smaller one: what is left adds up.",
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

/// Self-collision keeps vertices apart; thinner than the gaps between them, layers pass through each other.
function thinNote(values: Record<string, unknown>, { thickness_that_holds: holds }: SolverFacts): Note {
  if (holds == null || Number(values["/self_collision/thickness"]) >= holds) return { text: "" };
  const enough = Number((Math.ceil(holds * 1e4) / 1e4).toPrecision(6));
  return {
    text: `Thinner than the gaps between this mesh's vertices: layers can pass through each other below ${readable(enough)}\u00a0m.`,
    offer: {
      text: `Set ${readable(enough)}\u00a0m`,
      operations: [{ op: "replace", path: "/self_collision/thickness", value: enough }],
    },
  };
}

function selfCollisionSection(document: SceneDocument): Section {
  const base = "/self_collision";
  const toggle: Field = {
    key: base,
    label: "on",
    paths: [base],
    kind: "toggle",
    read: (current) => current.self_collision !== null,
    write: (value) => (value ? { thickness: 0.01, friction: 0.2 } : null),
  };
  const more: Field[] = document.self_collision
    ? [
        number("thickness", [`${base}/thickness`], { min: 0.001, max: 0.1, log: true, ...meter }, { note: thinNote }),
        number("friction", [`${base}/friction`], { min: 0, max: 2, step: 0.01 }),
      ]
    : [];
  return { key: base, title: "Self-collision", open: true, fields: [toggle, ...more], sections: [] };
}

export function sectionsOf(document: SceneDocument, methods: string[]): Section[] {
  return [
    solverSection(document, methods),
    ...document.cloths.map((_, i) => clothSection(document, i)),
    worldSection(),
    selfCollisionSection(document),
    ...document.colliders.map((_, i) => colliderSection(document, i)),
  ];
}

export function readField(field: Field, document: SceneDocument): unknown {
  return field.read ? field.read(document) : valueAt(document, field.paths[0] as string);
}

export function operationsFor(field: Field, value: unknown): Operation[] {
  const written = field.write ? field.write(value) : value;
  return field.paths.map((path) => ({ op: "replace", path, value: written }));
}
