// Patches that are valid but need more than a small machine has. Each is for a session of its own: other sessions go on
// beside it, and it can be steered and ended like any other. Used by heavy.test.mjs and tests/bench/abuse.mjs.
const grid = (side, more = {}) => ({
  mesh: { grid: { columns: side, rows: side, width: 1, height: 1 } },
  transform: { translate: [0, 1, 0] },
  mass: { per_vertex: 0.1 },
  pins: [{ at: "corner:0,0" }, { at: `corner:${side - 1},0` }],
  material: { model: "springs", structural: 20000, shear: 10000, bend: 2000, damping: 2 },
  ...more,
});
const solver = (method, iterations, dt = 0.001, tolerance = 1e-4) => ({
  solver: { method, iterations, dt, tolerance },
});

export const heavyPatches = {
  "512x512 with self-collision": { cloths: [grid(512)] },
  "256x256 with self-collision": { cloths: [grid(256)] },
  "100x100 with a thickness of 10 m": { cloths: [grid(100)], self_collision: { thickness: 10, friction: 0.2 } },
  "1024x1024 without self-collision": { cloths: [grid(1024)], self_collision: null },
  "1024x1024 with a thickness of one edge": {
    cloths: [grid(1024)],
    self_collision: { thickness: 0.001, friction: 0.2 },
  },
  "10,000 iterations of xpbd": solver("xpbd", 10000),
  "10,000 iterations of pbd": solver("pbd", 10000),
  "10,000 iterations of vbd": solver("vbd", 10000),
  "10,000 Newton steps to 1e-12": solver("implicit_euler", 10000, 0.01, 1e-12),
  "implicit Euler on 256x256": { cloths: [grid(256)], ...solver("implicit_euler", 10, 0.01) },
  "100 iterations of vbd on 300x300": { cloths: [grid(300)], ...solver("vbd", 100) },
  "a strain limit that cannot be met on 200x200": {
    cloths: [
      grid(200, {
        pins: [{ at: "edge:row:0" }, { at: "edge:row:199", motion: { linear: { velocity: [0, 0, 0.5] } } }],
      }),
    ].map((cloth) => ({ ...cloth, material: { ...cloth.material, strain_limit: 0.001 } })),
  },
  "RK4 on 400x400 at a microsecond": { cloths: [grid(400)], ...solver("rk4", 10, 1e-6) },
  "steps of a nanosecond": solver("symplectic_euler", 10, 1e-9),
  "128x128 in one point": { cloths: [grid(128, { start: { scale: [0, 0, 0] } })] },
  "eight cloths of 128x128 in a heap": {
    cloths: Array.from({ length: 8 }, (_, i) => ({ ...grid(128), name: `cloth-${i}` })),
  },
};

/// A refused scene, as no machine would end a step of it: 7.5e9 pairs of vertices per search.
export const tooHeavy = { cloths: [grid(1024)] };
