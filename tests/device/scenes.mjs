// The scenes of tests/device/run that are no presets.

export const sheet = (columns, rows, width, height) => ({ grid: { columns, rows, width, height } });

/** Layers of cloth that fall onto each other and a floor, with contact between surfaces. */
export function heap(layers, columns, rows) {
  const thickness = 0.002;
  return {
    version: 1,
    name: "layers",
    cloths: Array.from({ length: layers }, (_, i) => ({
      name: `layer ${i}`,
      mesh: sheet(columns, rows, 0.01 * (columns - 1), 0.01 * (rows - 1)),
      mass: { area_density: 0.2 },
      material: { model: "springs", structural: 40, shear: 20, bend: 0.5, damping: 0.001 },
      transform: { translate: [0.002 * (i % 3), 0.01 + 0.005 * i, 0.002 * (i % 2)] },
    })),
    self_collision: { kind: "surface", thickness, friction: 0.2 },
    colliders: [{ plane: { point: [0, 0, 0], normal: [0, 1, 0] }, friction: 0.3, restitution: 0 }],
    solver: { method: "vbd", dt: 0.001, iterations: 5, tolerance: 1e-4 },
  };
}
