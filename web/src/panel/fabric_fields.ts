// The menu of fabrics in a cloth's section: the fabric that the cloth names, or the numbers of its own.
import type { Field, Note, SolverFacts, Values } from "./field";
import type { Fabric } from "../link/fabrics";
import { valueAt } from "../link/json_patch";
import type { Cloth, Fem, Material, Operation, SceneDocument } from "../link/scene_types";

const custom = "custom";
/// Numbers of a material that a fabric gives.
const given = ["structural", "shear", "bend", "warp", "weft", "poisson", "bending", "damping"];

/// True once every number of the material is known: those of a fabric come after the document.
export const isKnown = (material: Material): boolean =>
  (material.model === "fem" ? material.warp : material.structural) !== undefined;

/// The cloth with all numbers of a fabric.
function named(base: string, { material }: Cloth, fabric: string, model: string): Operation[] {
  const grain = "grain" in material && material.grain && model === "fem" ? { grain: material.grain } : {};
  return [
    { op: "replace", path: `${base}/material`, value: { model, fabric, ...grain } },
    { op: "remove", path: `${base}/mass` },
  ];
}

/// The cloth as it is, with its numbers written out.
function ownNumbers(base: string, { material, mass }: Cloth): Operation[] {
  const { fabric: _, ...numbers } = material;
  return [
    { op: "replace", path: `${base}/material`, value: numbers },
    { op: "replace", path: `${base}/mass`, value: mass },
  ];
}

/// The square of Poisson's ratio is below warp over weft, or the sheet would gain energy by being stretched (an
/// orthotropic sheet's stiffness is positive definite): a number goes as far as the two others let it.
const room = 1.001;
const nearest: Record<"warp" | "weft" | "poisson", (asked: number, sheet: Fem) => number> = {
  warp: (asked, { weft, poisson }) => Math.max(asked, room * weft * poisson ** 2),
  weft: (asked, { warp, poisson }) => (poisson > 0 ? Math.min(asked, warp / (room * poisson ** 2)) : asked),
  poisson: (asked, { warp, weft }) => Math.min(asked, Math.sqrt(warp / (room * weft))),
};
export const untilUnstable =
  (key: keyof typeof nearest, base: string) =>
  (value: unknown, document: SceneDocument): Operation[] => {
    const sheet = valueAt(document, `${base}/material`) as Fem;
    const reached = Number(nearest[key](Number(value), sheet).toPrecision(6));
    return [{ op: "replace", path: `${base}/material/${key}`, value: reached }];
  };

/// What the fabric is like; and, if the cloth has numbers of its own, an offer to give them up.
function fabricNote(index: number, base: string, fabrics: Fabric[], values: Values, facts: SolverFacts): Note {
  const name = String(values[`${base}/material/fabric`]);
  const fabric = fabrics.find((each) => each.name === name);
  if (!fabric) return { text: "" };
  const left = facts.from_fabrics?.[index];
  const model = values[`${base}/material/model`] === "springs" ? "springs" : "fem";
  const here = given.filter((key) =>
    [`${base}/material/${key}`, `${base}/material/${key}/warp`].some((at) => at in values),
  );
  const own = left ? here.filter((key) => !(key in left.material)) : [];
  if (left && !("mass" in left)) own.push("mass");
  const feel = `${fabric.feel.charAt(0).toUpperCase()}${fabric.feel.slice(1)}.`;
  if (own.length === 0) return { text: feel };
  const grain = Number(values[`${base}/material/grain`] ?? 0);
  const material = { model, fabric: name, ...(grain && model === "fem" ? { grain } : {}) };
  return {
    text: `${feel} Here with its own ${own.join(", ")}.`,
    offer: {
      text: `All of ${name}`,
      operations: [
        { op: "replace", path: `${base}/material`, value: material },
        { op: "remove", path: `${base}/mass` },
      ],
    },
  };
}

/// The menu of fabrics and, for a cloth that names one, of the model that acts as it.
export function fabricFields(document: SceneDocument, index: number, fabrics: Fabric[]): Field[] {
  const base = `/cloths/${index}`;
  const cloth = (of: SceneDocument): Cloth => of.cloths[index] as Cloth;
  if (fabrics.length === 0) return [];
  const menu: Field = {
    key: `${base}/material/fabric`,
    label: "fabric",
    paths: [`${base}/material`],
    about: `${base}/material/fabric`,
    along: [`${base}/mass`],
    keepStable: true,
    kind: "choice",
    choices: [custom, ...fabrics.map(({ name }) => name)],
    hint: "Measured cloth by name; custom: numbers of this scene's own",
    note: (values, facts) => fabricNote(index, base, fabrics, values, facts),
    read: (of) => cloth(of).material.fabric ?? custom,
    change: (value, of) =>
      value === custom ? ownNumbers(base, cloth(of)) : named(base, cloth(of), String(value), cloth(of).material.model),
  };
  if (!cloth(document).material.fabric) return [menu];
  const model: Field = {
    key: `${base}/material/model`,
    label: "model",
    paths: [`${base}/material`],
    about: `${base}/material/model`,
    along: [`${base}/mass`],
    keepStable: true,
    kind: "choice",
    choices: ["fem", "springs"],
    names: { fem: "finite elements", springs: "springs fitted to it" },
    read: (of) => cloth(of).material.model,
    change: (value, of) => named(base, cloth(of), String(cloth(of).material.fabric), String(value)),
  };
  return [menu, model];
}
