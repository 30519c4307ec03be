// A square sheet that hangs at rest in the plane z = 0, its upper edge at the height of 1 m: to be pulled at.
export const hanging = (columns, side, pins) => ({
  version: 1,
  name: "hanging",
  cloths: [
    {
      mesh: { grid: { columns, rows: columns, width: side, height: side } },
      transform: { translate: [0, 1, 0], rotate: [90, 0, 0] },
      mass: { per_vertex: 0.002 },
      material: { structural: 200, shear: 50, bend: 5, damping: 0.05 },
      pins: pins.map((at) => ({ at })),
    },
  ],
  air_drag: 2,
  solver: { method: "symplectic_euler", dt: 0.001 },
});
