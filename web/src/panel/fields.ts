// Lists the panel's sections and fields for a scene, each tied to JSON Pointers of the document.
import { fabricFields, isKnown, untilUnstable } from "./fabric_fields";
import { type Field, kinds, meter, type Note, number, type Section, type SolverFacts, vector } from "./field";
import { motionFields } from "./motion_fields";
import { additions, bodyDeeds, clothDeeds, pinDeeds } from "./parts";
import { readable } from "./slider";
import { solverSection } from "./solver_section";
import type { Fabric } from "../link/fabrics";
import { valueAt } from "../link/json_patch";
import {
  type At,
  byKind,
  type Cloth,
  type Fem,
  type Motion,
  type SceneDocument,
  type Shape,
  type Vec3,
} from "../link/scene_types";

const pinTitle = (at: At | undefined): string => (typeof at === "string" ? `Pin ${at}` : "Pin in a box");

function pinSections(document: SceneDocument, cloth: number): Section[] {
  const groups = new Map<string, number[]>();
  document.cloths[cloth]?.pins.forEach((pin, i) => {
    const same = JSON.stringify(pin.motion);
    groups.set(same, [...(groups.get(same) ?? []), i]);
  });
  return [...groups.entries()].map(([motion, pins]) => {
    const one = pinTitle(document.cloths[cloth]?.pins[pins[0] as number]?.at);
    return {
      key: `/cloths/${cloth}/pins/${pins.join("+")}`,
      title: pins.length === 1 ? one : `${pins.length} pins`,
      open: false,
      sections: [],
      fields: motionFields(
        pins.map((pin) => `/cloths/${cloth}/pins/${pin}/motion`),
        JSON.parse(motion) as Motion,
        [0, 0, 0],
      ),
      deeds: pinDeeds(cloth, pins, one),
    };
  });
}

/// The strain limit in percent. The slider's left end is null: no limit.
function strainLimit(paths: string[], hint: string): Field {
  return number(
    "strain limit",
    paths,
    { min: 0.1, max: 100, log: true, zero: true, zeroText: "off", unit: "%" },
    {
      hint,
      read: (document) => 100 * ((valueAt(document, paths[0] as string) as number | null) ?? 0),
      write: (percent) => (Number(percent) > 0 ? Number((Number(percent) / 100).toPrecision(6)) : null),
    },
  );
}

const percent = (share: number): string => `${readable(Number((100 * share).toPrecision(2)))}\u00a0%`;

/// PBD has no stiffness in N/m: says what share of a stretch it removes instead, for one cloth. "" for other methods.
function pbdStiffness(index: number, { pbd_stiffness }: SolverFacts): Note {
  const cloth = pbd_stiffness?.[index];
  const shares = kinds.flatMap((kind) => (cloth?.[kind] == null ? [] : [`${kind}\u00a0${percent(cloth[kind])}`]));
  if (shares.length === 0) return { text: "" };
  return {
    text: `PBD knows no N/m. For this step and these iterations it takes away of a spring's stretch at each visit: ${shares.join(", ")}.`,
  };
}

function springFields(index: number, base: string): Field[] {
  const stiffness = { min: 10, max: 200000, log: true, zero: true, unit: "N/m" };
  return [
    number("structural", [`${base}/material/structural`], stiffness),
    number("shear", [`${base}/material/shear`], stiffness),
    number("bend", [`${base}/material/bend`], stiffness, { note: (_, facts) => pbdStiffness(index, facts) }),
    number("damping", [`${base}/material/damping`], { min: 0.01, max: 100, log: true, zero: true, unit: "N s/m" }),
    strainLimit([`${base}/material/strain_limit`], "The most a spring may stretch, after Provot 1995"),
  ];
}

/// The fields of a sheet of finite elements.
function sheetFields(material: Fem, base: string): Field[] {
  const at = (key: string): string[] => [`${base}/material/${key}`];
  const modulus = { min: 10, max: 20000, log: true, unit: "N/m" };
  const moment = { min: 1e-7, max: 1e-2, log: true, zero: true, unit: "N m" };
  const bending =
    typeof material.bending === "number"
      ? [number("bending", at("bending"), moment)]
      : [number("bending, warp", at("bending/warp"), moment), number("bending, weft", at("bending/weft"), moment)];
  const limits =
    typeof material.strain_limit === "number" || material.strain_limit === null
      ? [strainLimit(at("strain_limit"), "The most that warp and weft may stretch")]
      : ["warp", "weft"].map((direction) =>
          number(`strain limit, ${direction}`, at(`strain_limit/${direction}`), { min: 0.001, max: 1, log: true }),
        );
  return [
    number("warp", at("warp"), modulus, {
      hint: "Tension a metre of width over strain along the warp",
      change: untilUnstable("warp", base),
    }),
    number("weft", at("weft"), modulus, {
      hint: "Tension a metre of width over strain along the weft",
      change: untilUnstable("weft", base),
    }),
    number("shear", at("shear"), { ...modulus, min: 1, zero: true }, { hint: "Resistance to slanting the threads" }),
    number(
      "poisson",
      at("poisson"),
      { min: 0, max: 1, step: 0.01 },
      { hint: "How much it narrows when pulled", change: untilUnstable("poisson", base) },
    ),
    ...bending,
    number("damping", at("damping"), { min: 1e-5, max: 0.1, log: true, zero: true, unit: "s" }),
    number("grain", at("grain"), { min: -90, max: 90, step: 1, unit: "°" }, { hint: "From the columns to the warp" }),
    ...limits,
  ];
}

function materialFields({ material, mass }: Cloth, index: number, base: string): Field[] {
  if (!isKnown(material)) return [];
  const weight =
    "per_vertex" in mass
      ? number("mass", [`${base}/mass/per_vertex`], { min: 1e-5, max: 1, log: true, unit: "kg/vertex" })
      : number("mass", [`${base}/mass/area_density`], { min: 0.02, max: 20, log: true, unit: "kg/m²" });
  return [...(material.model === "fem" ? sheetFields(material, base) : springFields(index, base)), weight];
}

function clothSection(document: SceneDocument, index: number, fabrics: Fabric[]): Section {
  const cloth = document.cloths[index] as SceneDocument["cloths"][number];
  const base = `/cloths/${index}`;
  const count = { min: 3, max: 150, step: 1, whole: true };
  const resize = { onRelease: true, keepStable: true };
  const grid: Field[] =
    "grid" in cloth.mesh
      ? [
          number("columns", [`${base}/mesh/grid/columns`], count, resize),
          number("rows", [`${base}/mesh/grid/rows`], count, resize),
        ]
      : [];
  return {
    key: base,
    title: document.cloths.length === 1 && cloth.name === "cloth" ? "Cloth" : `Cloth: ${cloth.name}`,
    open: true,
    fields: [
      ...fabricFields(document, index, fabrics),
      ...materialFields(cloth, index, base),
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
    sections: [
      {
        key: `${base}/transform`,
        title: "Place",
        open: false,
        fields: transformFields(base, true),
        sections: [],
      },
      ...pinSections(document, index),
    ],
    deeds: clothDeeds(document, index),
    handles: index,
  };
}

const place = { min: -2, max: 2, step: 0.005, ...meter };

/// Where a mesh is put. A `cloth` starts anew there.
function transformFields(base: string, cloth = false): Field[] {
  const at = `${base}/transform`;
  const turn = { min: -180, max: 180, step: 1, unit: "°" };
  const fields = [
    ...vector("place", [`${at}/translate`], place),
    ...vector("turned about", [`${at}/rotate`], turn),
    number("scale", [`${at}/scale`], { min: 0.001, max: 10, log: true }),
  ];
  return cloth ? fields.map((field) => ({ ...field, onRelease: true, keepStable: true })) : fields;
}

/// The fields of a shape, and the center around which it spins by default.
function shapeFields(shape: Shape, base: string): { fields: Field[]; center: Vec3 } {
  const radius = { min: 0.02, max: 1, step: 0.005, ...meter };
  const made = byKind<{ fields: Field[]; center: Vec3 }>(shape, {
    sphere: ({ center }) => ({
      fields: [
        ...vector("center", [`${base}/sphere/center`], place),
        number("radius", [`${base}/sphere/radius`], radius),
      ],
      center,
    }),
    plane: () => ({ fields: [number("height", [`${base}/plane/point/1`], place)], center: [0, 0, 0] }),
    capsule: ({ a, b }) => ({
      fields: [
        ...vector("from", [`${base}/capsule/a`], place),
        ...vector("to", [`${base}/capsule/b`], place),
        number("radius", [`${base}/capsule/radius`], radius),
      ],
      center: a.map((value, axis) => (value + (b[axis] as number)) / 2) as Vec3,
    }),
    box: ({ center }) => ({
      fields: [
        ...vector("center", [`${base}/box/center`], place),
        ...vector("half", [`${base}/box/half`], { min: 0.005, max: 1, step: 0.005, ...meter }),
        ...vector("turned about", [`${base}/box/rotate`], { min: -180, max: 180, step: 1, unit: "°" }),
      ],
      center,
    }),
    mesh: ({ transform }) => ({ fields: transformFields(base), center: transform.translate }),
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
    deeds: bodyDeeds(document, index),
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

/// Warns of a thin self-collision: layers pass through each other if it is thinner than the gaps between vertices.
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

/// Puts a part of the scene in, as `start`, or takes it out.
const onOff = (key: "self_collision" | "wind", start: unknown): Field => ({
  key: `/${key}`,
  label: "on",
  paths: [`/${key}`],
  kind: "toggle",
  read: (current) => current[key] !== null,
  write: (value) => (value ? start : null),
});

function selfCollisionSection(document: SceneDocument): Section {
  const base = "/self_collision";
  const toggle = onOff("self_collision", { thickness: 0.01, friction: 0.2, kind: "points" });
  const more: Field[] = document.self_collision
    ? [
        number("thickness", [`${base}/thickness`], { min: 0.001, max: 0.1, log: true, ...meter }, { note: thinNote }),
        number("friction", [`${base}/friction`], { min: 0, max: 2, step: 0.01 }),
        {
          key: `${base}/kind`,
          label: "between",
          paths: [`${base}/kind`],
          kind: "choice",
          choices: ["points", "surface"],
        },
      ]
    : [];
  return { key: base, title: "Self-collision", open: true, fields: [toggle, ...more], sections: [] };
}

function windSection(document: SceneDocument): Section {
  const base = "/wind";
  const toggle = onOff("wind", { velocity: [3, 0, 0], gust: 0.3, gust_frequency: 0.7, drag: 1, lift: 0.2 });
  const coefficient = { min: 0, max: 3, step: 0.01 };
  const more: Field[] = document.wind
    ? [
        ...vector("velocity", [`${base}/velocity`], { min: -15, max: 15, step: 0.1, unit: "m/s" }),
        number("gust", [`${base}/gust`], { min: 0, max: 2, step: 0.01 }, { hint: "How much it swells and dies down" }),
        number("gust frequency", [`${base}/gust_frequency`], { min: 0, max: 5, step: 0.01, unit: "Hz" }),
        number("drag", [`${base}/drag`], coefficient, { hint: "Of each triangle, along the wind" }),
        number("lift", [`${base}/lift`], coefficient, { hint: "Of each triangle, across the wind" }),
      ]
    : [];
  return { key: base, title: "Wind", open: true, fields: [toggle, ...more], sections: [] };
}

export function sectionsOf(document: SceneDocument, methods: string[], fabrics: Fabric[]): Section[] {
  return [
    solverSection(document, methods),
    ...document.cloths.map((_, i) => clothSection(document, i, fabrics)),
    worldSection(),
    windSection(document),
    selfCollisionSection(document),
    ...document.colliders.map((_, i) => colliderSection(document, i)),
    additions,
  ];
}
