// A field of the panel: the value it shows, the places of the document it writes (JSON Pointers), and its note.
import type { Deed } from "./parts";
import type { Scale } from "./slider";
import type { LeftToFabric } from "../link/fabrics";
import { valueAt } from "../link/json_patch";
import type { Operation, SceneDocument } from "../link/scene_types";

/// The kinds of springs, as the document names them.
export const kinds = ["structural", "shear", "bend"] as const;

/// Facts about the solver in `sim.status`.
export interface SolverFacts {
  /// Under the method `auto`: the method that steps the scene, and why.
  auto?: {
    state: "measuring" | "chosen" | "failed";
    method: string;
    dt_s: number;
    iterations: number | null;
    tolerance: number | null;
    why: string;
  } | null;
  /// Share of a spring's stretch that one visit removes, for each cloth; under PBD only.
  pbd_stiffness?: Record<(typeof kinds)[number], number | null>[] | null;
  /// For each cloth the numbers that its document leaves to the fabric that it names.
  from_fabrics?: LeftToFabric[];
  /// Least thickness of self-collision at which no vertex slips between the vertices of a triangle [m].
  thickness_that_holds?: number | null;
}

/// The values of the panel's controls, by the keys of their fields.
export type Values = Record<string, unknown>;

/// A line below a control; `offer`: a button in it and the change it makes.
export interface Note {
  text: string;
  offer?: { text: string; operations: Operation[] };
}

export interface FieldBase {
  key: string; ///< unique in the panel
  label: string;
  paths: string[]; ///< the places it writes; it reads the first
  keepStable?: boolean; ///< the solver changes with it where the cloth would not hold
  onRelease?: boolean; ///< sent when the slider is released: each value rebuilds the cloth
  hint?: string; ///< a sentence before the schema's in its explanation
  about?: string; ///< the place that its explanation is of, if that is not the first of `paths`
  along?: string[]; ///< places that go back with it
  note?(values: Values, facts: SolverFacts): Note;
  read?(document: SceneDocument): unknown;
  write?(value: unknown): unknown;
  change?(value: unknown, document: SceneDocument): Operation[]; ///< instead of `write`: more than one value changes
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
  deeds?: Deed[]; ///< buttons below the fields
  handles?: number; ///< of this cloth: a button for its handles
}

export const meter = { unit: "m" };

/// A field for a number; its key is the first place it writes.
export const number = (label: string, paths: string[], scale: Scale, more: Partial<FieldBase> = {}): Field => ({
  key: paths[0] as string,
  label,
  paths,
  kind: "number",
  scale,
  ...more,
});

export const at = (bases: string[], rest: string): string[] => bases.map((base) => base + rest);

export function vector(label: string, bases: string[], scale: Scale): Field[] {
  return ["x", "y", "z"].map((axis, i) => number(`${label} ${axis}`, at(bases, `/${i}`), scale));
}

export function readField(field: Field, document: SceneDocument): unknown {
  return field.read ? field.read(document) : valueAt(document, field.paths[0] as string);
}

export function operationsFor(field: Field, value: unknown, document: SceneDocument): Operation[] {
  if (field.change) return field.change(value, document);
  const written = field.write ? field.write(value) : value;
  return field.paths.map((path) => ({ op: "replace", path, value: written }));
}
