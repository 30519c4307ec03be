// The scenes of tests/bench/peers.mjs: half a metre of light cloth whose springs along and across have one stiffness,
// as Bullet's deformable cloth has one for all that do not bend.

/** Kept apart by surface contact, and by Bullet, 5 mm; vertices alone, so that none slips between three others, 0.86 of
 * the mesh's spacing. */
export const thickness = { surface: 0.005, points: (side) => (0.86 * width) / (side - 1) };
const width = 0.5;
const friction = 0.3;
/** Time between two looks at the state [s]. */
export const every = 0.1;
/** [s], of all programs: an explicit method's, Bullet's too, is below 2 / sqrt(12 k / m). */
const dt = (side) => every / Math.ceil((every * (side - 1)) / 0.024 - 1e-9);

const cloth = (side, translate, rotate, pins = []) => ({
  mesh: { grid: { columns: side, rows: side, width, height: width } },
  transform: { translate, rotate },
  mass: { per_vertex: (0.3 * width ** 2) / side ** 2 },
  material: { model: "springs", structural: 25, shear: 25, bend: 0.5, damping: 0.005 * (24 / (side - 1)) ** 2 },
  pins,
});
const floor = { plane: { point: [0, 0, 0], normal: [0, 1, 0] }, friction };

/** Of each scene: what happens, for how long [s], and of `side` vertices squared its cloth and what it falls on. */
export const scenes = {
  fall: {
    about: "a sheet that hung upright falls on a floor, into a heap",
    seconds: 2,
    cloth: (side) => cloth(side, [0, 0.55, 0], [85, 10, 0]),
    colliders: [floor],
  },
  fold: {
    about: "an edge is carried over onto the opposite one, on a floor",
    seconds: 2,
    cloth: (side) =>
      cloth(
        side,
        [0, 0.01, -width / 2],
        [0, 0, 0],
        [
          { at: "edge:row:0" },
          {
            at: `edge:row:${side - 1}`,
            motion: { spin: { axis: [-1, 0, 0], center: [0, 0.02, 0], degrees_per_second: 90 } },
          },
        ],
      ),
    colliders: [floor],
  },
  drape: {
    about: "a sheet falls over a ball on a floor",
    seconds: 2,
    cloth: (side) => cloth(side, [0.01, 0.36, -width / 2], [0, 10, 0]),
    colliders: [{ sphere: { center: [0, 0.2, 0], radius: 0.15 }, friction }, floor],
  },
};

/** The document that `clothlab run` reads. */
export const document = (name, side, kind, method, iterations) => ({
  version: 1,
  name,
  gravity: [0, -9.8, 0],
  cloths: [scenes[name].cloth(side)],
  colliders: scenes[name].colliders,
  self_collision: { kind, thickness: kind === "points" ? thickness.points(side) : thickness.surface, friction },
  air_drag: 0.3,
  solver: { method, dt: dt(side), iterations, tolerance: 1e-4 },
});

/** What Bullet is told beside the document: `mesh` as clothlab wrote it, the grid's springs, the pins' vertices. */
export function peer(document, mesh) {
  const { columns: side } = document.cloths[0].mesh.grid;
  const springs = [];
  const join = (column, row, right, down, bends) => {
    const [c, r] = [column + right, row + down];
    if (c >= 0 && c < side && r < side) springs.push([row * side + column, r * side + c, bends]);
  };
  for (let row = 0; row < side; ++row)
    for (let column = 0; column < side; ++column) {
      for (const [right, down] of [
        [1, 0],
        [0, 1],
        [1, 1],
        [-1, 1],
      ])
        join(column, row, right, down, false);
      for (const [right, down] of [
        [2, 0],
        [0, 2],
      ])
        join(column, row, right, down, true);
    }
  const row = (pin) => {
    const at = Number(pin?.at.split(":")[2]);
    return pin ? Array.from({ length: side }, (_, column) => at * side + column) : [];
  };
  const [held, turned] = document.cloths[0].pins.map(row);
  const steps_a_sample = Math.round(every / document.solver.dt);
  const steps = Math.round(scenes[document.name].seconds / every) * steps_a_sample;
  return { document, ...mesh, springs, held: held ?? [], turned: turned ?? [], steps, steps_a_sample };
}
