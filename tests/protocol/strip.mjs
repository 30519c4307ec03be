// A small cloth that every method steps quickly: for tests and the soak, where the kind of cloth does not matter.

/// A cloth of `rows` rows of three vertices, 5 cm apart, hung by the first row.
export const strip = (rows = 9) => ({
  version: 1,
  name: "strip",
  solver: { dt: 0.0002 },
  cloths: [
    {
      mesh: { grid: { columns: 3, rows, width: 0.1, height: 0.05 * (rows - 1) } },
      mass: { area_density: 0.2 },
      material: { structural: 200, shear: 50, bend: 1, damping: 0.01 },
      pins: [{ at: "edge:row:0" }],
    },
  ],
});
