// Cloths, pins and bodies that come and go: what the panel's buttons for that change in the document.
import type { Section } from "./field";
import { type Box, freePlace } from "../link/free_place";
import { freeName, freeNumber, numbered } from "../link/names";
import { shiftedCloth } from "../link/shifted_cloth";
import type { Cloth, Collider, Operation, Pin, SceneDocument, Vec3 } from "../link/scene_types";

/// What the scene takes at its start and at present.
export interface Room {
  wide(cloth: number): number; ///< along x [m]
  taken(): Box[]; ///< by cloths and bodies
}

/// A button of a section: one change, with what it says when it is done.
export interface Deed {
  label: string;
  says: string;
  keepStable?: boolean; ///< the solver changes with it where the cloth would not hold
  body?: boolean; ///< it adds a body, which is then chosen
  /// Of the document as the server keeps it.
  change(stored: SceneDocument, room: Room): Operation[];
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

const gap = 1.1; // of copies, in widths

/// Another of it beside it, as far along x as it is wide and a tenth more; behind the copies that are there.
const copied = (index: number, name: string): Deed => ({
  label: `Copy ${name}`,
  says: `${name} has a copy`,
  keepStable: true,
  change: ({ cloths }, room) => {
    const cloth = cloths[index] as Cloth;
    const number = freeNumber(cloth.name, cloths);
    const { mesh, transform } = cloth;
    const atRest = "grid" in mesh ? mesh.grid.width * transform.scale : 0;
    const by: Vec3 = [Number(((number - 1) * gap * Math.max(room.wide(index), atRest)).toFixed(4)), 0, 0];
    return [
      { op: "add", path: `/cloths/${cloths.length}`, value: shiftedCloth(cloth, numbered(cloth.name, number), by) },
    ];
  },
});

/// What can be done to a cloth: pinned by its top, if that is known, copied, and taken out, unless it is the last
/// one.
export function clothDeeds({ cloths }: SceneDocument, cloth: number): Deed[] {
  const { mesh, name, pins } = cloths[cloth] as SceneDocument["cloths"][number];
  const lacks = (places: string[]): boolean => places.some((place) => !pins.some(({ at }) => at === place));
  const deeds: Deed[] = [];
  if ("grid" in mesh) {
    const corners = ["corner:0,0", `corner:${mesh.grid.columns - 1},0`];
    if (lacks(corners)) deeds.push(pinned("Pin the top corners", cloth, corners));
    if (lacks(["edge:row:0"])) deeds.push(pinned("Pin the top edge", cloth, ["edge:row:0"]));
  }
  deeds.push(copied(cloth, name));
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

const wished: Vec3 = [0, 0.3, 0.3]; // of a new body [m]

/// A body named after its kind, where nothing is.
const body = (label: string, half: Vec3, shape: (center: Vec3) => Shape): Deed => ({
  label,
  says: `${label} is there`,
  body: true,
  change: (stored, room) => {
    const { colliders } = stored;
    const place = freePlace(wished, half, room.taken(), stored);
    const name = freeName(label.toLowerCase(), colliders);
    const value = { name, ...shape(place), friction: 0.3 } as unknown as Collider;
    return [{ op: "add", path: `/colliders/${colliders.length}`, value }];
  },
});

/// A level plane at 0, or below all that is there.
const floor: Deed = {
  label: "Floor",
  says: "Floor is there",
  change: ({ colliders }, room) => {
    const height = Math.min(0, ...room.taken().map(({ low }) => Number((low[1] - 0.01).toFixed(3))));
    const value = {
      name: freeName("floor", colliders),
      plane: { point: [0, height, 0], normal: [0, 1, 0] },
      friction: 0.3,
    } as unknown as Collider;
    return [{ op: "add", path: `/colliders/${colliders.length}`, value }];
  },
};

const bodies: Deed[] = [
  body("Sphere", [0.12, 0.12, 0.12], (center) => ({ sphere: { center, radius: 0.12 } })),
  body("Box", [0.12, 0.12, 0.12], (center) => ({ box: { center, half: [0.12, 0.12, 0.12] } })),
  body("Capsule", [0.21, 0.06, 0.06], ([x, y, z]) => ({
    capsule: { a: [Number((x - 0.15).toFixed(3)), y, z], b: [Number((x + 0.15).toFixed(3)), y, z], radius: 0.06 },
  })),
  floor,
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
