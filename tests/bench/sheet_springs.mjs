// The sheet of sheet-fem.json with the springs that the lab puts in place of its finite elements, for charts.mjs and
// comparison.mjs.
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

export const sheet = join(dirname(fileURLToPath(import.meta.url)), "sheet-fem.json");

/** Writes the scene to `path`. */
export function writeSheetOfSprings(program, path) {
  const answer = execFileSync(program, ["simplify", sheet, "--time", "0.1", "--json"], { encoding: "utf8" });
  const { patch } = JSON.parse(answer).variants.find(({ name }) => name.includes("springs instead"));
  const scene = JSON.parse(readFileSync(sheet, "utf8"));
  scene.name = "sheet-springs";
  scene.cloths[0].material = patch.cloths[0].material; // an array of a merge patch is whole
  scene.solver.dt = patch.solver?.dt ?? scene.solver.dt;
  writeFileSync(path, JSON.stringify(scene));
}
