// Cloths, pins and bodies that come and go: what the panel's buttons for that change in the document.
import type { Section } from "./field";
import type { Collider, Operation, Pin, SceneDocument, Vec3 } from "../link/scene_types";

/// A button of a section: one change, with what it says when it is done.
export interface Deed {
  label: string;
  says: string;
  keepStable?: boolean; ///< the solver changes with it where the cloth would not hold
  change(stored: SceneDocument): Operation[]; ///< of the document as the server keeps it
}

const removal = (label: string, says: string, paths: string[]): Deed => ({
  label,
  says,
  change: () => paths.map((path) => ({ op: "remove", path })),
});

const pinned = (label: string, cloth: number, places: string[]): Deed => ({
  label,
  says: "Pinned",
  change: ({ cloths }) => {
    const pins = cloths[cloth]?.pins ?? [];
    const missing = places.filter((place) => !pins.some(({ at }) => at === place));
    return missing.map((at, i) => ({ op: "add", path: `/cloths/${cloth}/pins/${pins.length + i}`, value: { at } }));
  },
});

/// What can be done to a cloth: pinned by its top, if that is known, and taken out, unless it is the last one.
export function clothDeeds({ cloths }: SceneDocument, cloth: number): Deed[] {
  const { mesh, name, pins } = cloths[cloth] as SceneDocument["cloths"][number];
  const lacks = (places: string[]): boolean => places.some((place) => !pins.some(({ at }) => at === place));
  const deeds: Deed[] = [];
  if ("grid" in mesh) {
    const corners = ["corner:0,0", `corner:${mesh.grid.columns - 1},0`];
    if (lacks(corners)) deeds.push(pinned("Pin the top corners", cloth, corners));
    if (lacks(["edge:row:0"])) deeds.push(pinned("Pin the top edge", cloth, ["edge:row:0"]));
  }
  if (cloths.length > 1) deeds.push(removal(`Remove ${name}`, `${name} is removed`, [`/cloths/${cloth}`]));
  return deeds;
}

/// Takes pins off, by their places in the list.
export function pinDeeds(cloth: number, pins: number[], title: string): Deed[] {
  const label = pins.length === 1 ? `Remove ${title.replace("Pin", "pin")}` : `Remove these ${pins.length} pins`;
  const last = [...pins].sort((one, other) => other - one); // removing one moves those behind it
  return [
    removal(
      label,
      "Unpinned",
      last.map((pin) => `/cloths/${cloth}/pins/${pin}`),
    ),
  ];
}

export function bodyDeeds({ colliders }: SceneDocument, body: number): Deed[] {
  const name = colliders[body]?.name || `collider ${body + 1}`;
  return [removal(`Remove ${name}`, `${name} is removed`, [`/colliders/${body}`])];
}

type Shape = Record<string, unknown>;

/// A body in a row of five places, so that one after another can be seen.
const body = (label: string, shape: (center: Vec3) => Shape): Deed => ({
  label,
  says: `${label} is there`,
  change: ({ colliders }) => {
    const along = ((colliders.length % 5) - 2) * 0.35;
    const value = { ...shape([along, 0.3, 0.3]), friction: 0.3 } as unknown as Collider;
    return [{ op: "add", path: `/colliders/${colliders.length}`, value }];
  },
});

const bodies: Deed[] = [
  body("Sphere", (center) => ({ sphere: { center, radius: 0.12 } })),
  body("Box", (center) => ({ box: { center, half: [0.12, 0.12, 0.12] } })),
  body("Capsule", ([x, y, z]) => ({ capsule: { a: [x - 0.15, y, z], b: [x + 0.15, y, z], radius: 0.06 } })),
  body("Floor", () => ({ plane: { point: [0, 0, 0], normal: [0, 1, 0] } })),
];

const columns = 25;
const held: Partial<Pin>[] = [{ at: "corner:0,0" }, { at: `corner:${columns - 1},0` }];

/// A grid of the first cloth's material, held by two corners in front of what is there.
const cloth: Deed = {
  label: "Cloth",
  says: "A cloth is there",
  keepStable: true,
  change: ({ cloths }) => {
    const { material, mass } = cloths[0] as SceneDocument["cloths"][number];
    const value = {
      mesh: { grid: { columns, rows: columns, width: 0.6, height: 0.6 } },
      transform: { translate: [0, 1.2, 0.5 * cloths.length] },
      material,
      ...(mass ? { mass } : {}), // left to the fabric
      pins: held,
    };
    return [{ op: "add", path: `/cloths/${cloths.length}`, value }];
  },
};

/// Below all: what can be added to the scene.
export const additions: Section = {
  key: "add",
  title: "Add",
  open: true,
  fields: [],
  sections: [],
  deeds: [cloth, ...bodies],
};
