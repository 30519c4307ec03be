// `clothlab selftest`: passes on a device that does it right, and names what is wrong on one that does not. Wrong
// devices are played by shaders with one number changed, in a folder that the program looks into first.
import assert from "node:assert/strict";
import { cpSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { clothlab, folder } from "./program.mjs";

const root = fileURLToPath(new URL("../../", import.meta.url));

function selftest(name, environment = {}) {
  const { status, stdout, stderr } = clothlab(["selftest", "--quick", "--json", `${name}.json`], environment);
  return { status, stdout, stderr, result: JSON.parse(readFileSync(join(folder, `${name}.json`), "utf8")) };
}

/// A folder of data whose shaders have `to` in place of `from` in one file, each time.
function changed(name, changes) {
  const data = join(folder, name);
  mkdirSync(data);
  cpSync(join(root, "shaders"), join(data, "shaders"), { recursive: true });
  for (const [file, from, to] of changes) {
    const path = join(data, "shaders", file);
    const text = readFileSync(path, "utf8");
    assert.ok(text.includes(from), `${file} has ${from}`);
    writeFileSync(path, text.replace(from, to));
  }
  return { CLOTHLAB_DATA: data };
}

const wrong = ({ result }) => result.checks.filter((check) => !check.passed).map((check) => check.name);

test("software OpenGL does it right: a line for each check, the same checks as JSON, exit code 0", () => {
  const { status, stdout, stderr, result } = selftest("right");
  assert.equal(status, 0, stdout + stderr);
  assert.equal(stderr, "");
  assert.equal(result.passed, true);
  assert.match(result.device, /OpenGL 4\.\d/);
  const names = result.checks.map((check) => check.name);
  assert.equal(new Set(names).size, names.length, "each name once");
  for (const part of ["programs", "limit", "scene", "repeats", "frames", "picture", "speed"])
    assert.ok(
      names.some((name) => name.startsWith(part)),
      part,
    );
  const lines = stdout.split("\n");
  for (const { name, passed, found, allowed } of result.checks) {
    assert.ok(
      lines.some((line) => line.startsWith(`ok    ${name}: `)),
      name,
    );
    assert.equal(passed, true);
    if (typeof found === "number" && allowed !== null) assert.ok(found <= allowed, name);
  }
  assert.match(stdout, /checks, all passed: this device does it right/);
});

test("what is allowed of a scene is so little that a wrong law is seen: a thousandth of it at most", () => {
  const { checks } = JSON.parse(readFileSync(join(folder, "right.json"), "utf8")); // by the test before
  const scenes = checks.filter((check) => check.name.startsWith("scene: "));
  assert.ok(scenes.length >= 15);
  // The scenes are 0.16 to 0.4 m wide.
  for (const { name, allowed } of scenes) assert.ok(allowed > 0 && allowed < 4e-4, `${name}: ${allowed} m`);
});

test("a spring that is 1 % too stiff, a pack that scales wrongly and a program that does not link are named", () => {
  const run = selftest(
    "wrong",
    changed("wrong", [
      ["elements/spring.glsl", "real tension = s.stiffness", "real tension = real(1.01) * s.stiffness"],
      ["stream/pack.comp", "share * 65535.0", "share * 65534.0"],
      ["collide/insert_cells.comp", "void main() {", "void main() { no_such_function();"],
    ]),
  );
  assert.equal(run.status, 1);
  assert.equal(run.result.passed, false);
  const names = wrong(run);
  for (const name of ["scene: swing, symplectic_euler", "scene: wind, symplectic_euler", "programs: seed"])
    assert.ok(names.includes(name), `${name} among ${names}`);
  assert.deepEqual(
    names.filter((name) => name.startsWith("frames: ")),
    ["frames: q16", "frames: c16"],
  );
  assert.ok(!names.some((name) => /^(?:limit|picture|speed)/.test(name)), `${names}`);
  assert.ok(!names.includes("scene: sheet, symplectic_euler"), "finite elements are as they were");
  assert.match(run.stdout, /^WRONG programs: seed: .*shaders\/collide\/insert_cells\.comp:\d+: .*no_such_function/m);
  assert.match(run.stdout, /^WRONG scene: swing, symplectic_euler: .* m allowed; update this device's driver/m);
  assert.match(run.stdout, /checks, \d+ failed: this device does not do it right/);
});

test("a device that there is none of is a usage error, and a JSON file that cannot be written is said at once", () => {
  const device = clothlab(["selftest", "--gpu", "99"]);
  assert.equal(device.status, 2);
  assert.match(device.stderr, /--gpu/);
  const file = clothlab(["selftest", "--json", "no/such/folder.json"]);
  assert.equal(file.status, 2);
  assert.match(file.stderr, /--json/);
});
