// What the panel's buttons add and remove leaves a scene that the server takes.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { load } from "./module.mjs";

const { sectionsOf } = await load("panel/fields");
const { completed } = await load("explain/schema");
const { applyPatch } = await load("link/json_patch");
const server = new URL("../../server/scene/", import.meta.url);
const schema = JSON.parse(readFileSync(new URL("scene.schema.json", server), "utf8"));
const program = process.env.CLOTHLAB ?? fileURLToPath(new URL("../../build/release/clothlab", import.meta.url));

const room = { wide: () => 2, taken: () => [{ low: [-1, -1, -1], high: [1, 2, 1] }] }; // [m]: no preset takes more

const deedsIn = (sections) => sections.flatMap(({ deeds = [], sections: inner }) => [...deeds, ...deedsIn(inner)]);

test("every button of every preset", () => {
  const folder = mkdtempSync(join(tmpdir(), "clothlab-parts-"));
  const files = [];
  for (const file of readdirSync(new URL("presets/", server)).filter((name) => name.endsWith(".json"))) {
    const stored = completed(schema, JSON.parse(readFileSync(new URL(`presets/${file}`, server), "utf8")));
    // The panel shows mass beside a fabric; the server keeps it out.
    const shown = { ...stored, cloths: stored.cloths.map((cloth) => ({ mass: { area_density: 1 }, ...cloth })) };
    const deeds = deedsIn(sectionsOf(shown, ["verlet"], []));
    assert.ok(deeds.length >= 5, file);
    for (const [i, { label, change }] of deeds.entries()) {
      const patch = change(stored, room);
      assert.ok(patch.length > 0, `${file}: ${label}`);
      const after = applyPatch(stored, patch);
      files.push(join(folder, `${file}-${i}.json`));
      writeFileSync(files.at(-1), JSON.stringify(after));
    }
  }
  // Presets' own meshes lie beside them.
  const { status, stdout, stderr } = spawnSync(program, ["validate", ...files, "--asset-root", fileURLToPath(server)], {
    encoding: "utf8",
  });
  rmSync(folder, { recursive: true });
  assert.equal(status, 0, stdout + stderr);
  assert.ok(files.length > 200);
});
