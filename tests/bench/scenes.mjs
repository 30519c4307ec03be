// Scenes that several benchmarks share.
import { readFileSync } from "node:fs";

/// The preset `drape`, a sheet that falls on a ball, with `side` vertices along each side. It weighs the same; damping
/// and the time step go with the length of its edges, so that the step stays stable.
export function fineDrape(side) {
  const scene = JSON.parse(readFileSync(new URL("../../server/scene/presets/drape.json", import.meta.url), "utf8"));
  const [{ mesh, mass, material }] = scene.cloths;
  const finer = mesh.grid.columns / side;
  mass.per_vertex *= finer ** 2;
  material.damping *= finer;
  scene.solver.dt *= finer;
  mesh.grid.columns = mesh.grid.rows = side;
  scene.self_collision.thickness = mesh.grid.width / (side - 1);
  return scene;
}
