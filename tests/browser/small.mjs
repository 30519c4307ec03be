// A scene that the lab measures quickly: the cloth hangs from its upper corners; there are no colliders.
export const small = {
  version: 1,
  name: "small",
  gravity: [0, -9.8, 0],
  cloths: [
    {
      name: "cloth",
      mesh: { grid: { columns: 7, rows: 7, width: 1, height: 1 } },
      mass: { per_vertex: 0.1 },
      transform: { translate: [0, 1, 0] },
      material: { model: "springs", structural: 400, shear: 200, bend: 20, damping: 0.2 },
      pins: [{ at: "corner:0,0" }, { at: "corner:6,0" }],
    },
  ],
  solver: { method: "symplectic_euler", dt: 0.004 },
};
