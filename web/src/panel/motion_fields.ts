// The fields of a motion, of pins and of colliders.
import { at, type Field, meter, number, vector } from "./field";
import { valueAt } from "../link/json_patch";
import type { Motion, Vec3 } from "../link/scene_types";

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

/// Fields of the motions at `bases`. These are all equal and are edited together.
export function motionFields(bases: string[], motion: Motion, center: Vec3): Field[] {
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
