// `clothlab selftest` on devices that allow fewer storage blocks than this one, played by CLOTHLAB_STORAGE_BLOCKS, and
// on softpipe, Mesa's other software OpenGL, for which each scene's shortest run is enough (tests/drivers runs more).
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { shortest, softpipe } from "../drivers/drivers.mjs";
import { some, thoroughTest } from "../thorough.mjs";
import { clothlab, folder } from "./program.mjs";

function selftest(only, environment) {
  const { status, stdout, stderr } = clothlab(
    ["selftest", "--quick", "--json", "checks.json", ...only.flatMap((name) => ["--only", name])],
    environment,
  );
  const { device, checks } = JSON.parse(readFileSync(join(folder, "checks.json"), "utf8"));
  return { status, said: stdout + stderr, device, checks };
}

for (const blocks of some([8, 16]))
  test(`a device that allows a program ${blocks} storage blocks does it right, reading storage where that fits`, () => {
    // Implicit Euler's programs read the most; surfaces and sweeps have the most programs.
    const { status, said, checks } = selftest(
      [
        "programs: seed",
        "programs: twist",
        "limit: storage blocks",
        "scene: sheet, implicit_euler",
        "scene: surface, vbd",
      ],
      { CLOTHLAB_READS: "storage", CLOTHLAB_STORAGE_BLOCKS: `${blocks}` },
    );
    assert.equal(status, 0, said);
    assert.equal(checks.length, 5);
    const { found, allowed } = checks.find(({ name }) => name.startsWith("limit: storage blocks"));
    assert.equal(allowed, blocks);
    assert.ok(found > blocks / 2, `${found}: programs that fit do read storage`);
  });

test("where no way to read fits, the selftest names the program, its blocks and how many are allowed", () => {
  const { status, said } = selftest(["programs: seed"], { CLOTHLAB_READS: "storage", CLOTHLAB_STORAGE_BLOCKS: "3" });
  assert.equal(status, 1);
  assert.match(said, /^WRONG programs: seed: .*shaders\/\S+: has \d+ storage blocks, and a program may have 3 here/m);
});

thoroughTest("softpipe does it right", () => {
  const { status, said, device, checks } = selftest(
    shortest.map((name) => `scene: ${name}`),
    { ...softpipe, CLOTHLAB_READS: "textures", LP_NUM_THREADS: "0" },
  );
  assert.equal(status, 0, said);
  assert.match(device, /^softpipe/);
  assert.equal(checks.length, shortest.length);
});

test("a name that no check begins with is a usage error", () => {
  const { status, stderr } = clothlab(["selftest", "--only", "scene: none"]);
  assert.equal(status, 2);
  assert.match(stderr, /--only/);
});
