// The lab's commands on a small scene, with a cache of their own.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { cacheIn } from "../caches.mjs";
import { clothlab, folder } from "./program.mjs";

export const cache = join(folder, "cache");
export const environment = cacheIn(cache);

// Small enough to measure in seconds: 25 vertices, one corner held.
writeFileSync(
  join(folder, "small.json"),
  JSON.stringify({
    version: 1,
    name: "small",
    self_collision: null,
    cloths: [
      {
        mesh: { grid: { columns: 5, rows: 5, width: 1, height: 1 } },
        pins: [{ at: "corner:0,0" }],
        material: { model: "springs", structural: 2000, shear: 1000, bend: 200, damping: 2 },
      },
    ],
    solver: { method: "symplectic_euler", dt: 0.002 },
  }),
);

export function lab(...args) {
  const result = clothlab(args, environment);
  assert.equal(result.status, 0, result.stderr);
  return result;
}
