// How far a sheet that falls level on a ball leans: the distance of each vertex from the mirror image of its partner,
// left for right. The diagonals of a grid run one way, so a sheet of finite elements on it is not its own mirror image.
//   node tests/bench/lean.mjs      (CLOTHLAB=build/release/clothlab)
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const program = process.env.CLOTHLAB ?? "build/release/clothlab";
const folder = mkdtempSync(join(tmpdir(), "lean-"));
const radius = 0.25;
const dt = 5e-5;

/** The vertices of a grid of 1 m x 1 m, with diagonals that run to and fro: a mesh that is its own mirror image. */
function alternating(side) {
  const vertices = [];
  const triangles = [];
  for (let row = 0; row < side; ++row)
    for (let column = 0; column < side; ++column) vertices.push([column / (side - 1) - 0.5, 0, row / (side - 1)]);
  for (let row = 0; row + 1 < side; ++row)
    for (let column = 0; column + 1 < side; ++column) {
      const a = row * side + column;
      const [b, c, d] = [a + side, a + side + 1, a + 1];
      if ((row + column) % 2) triangles.push([a, b, d], [b, c, d]);
      else triangles.push([a, b, c], [a, c, d]);
    }
  return { vertices, triangles };
}

function scene(mesh, material, side) {
  const cloth = { mesh, material, transform: { translate: [0, radius + 0.002 + 0.01 / (side - 1), -0.5] } };
  if (material.model === "springs" && !material.fabric) cloth.mass = { area_density: 0.187 };
  return {
    version: 1,
    cloths: [cloth],
    colliders: [{ sphere: { center: [0, 0, 0], radius }, friction: 0.3 }],
    solver: { method: "symplectic_euler", dt },
  };
}

/** The largest distance of a vertex from its partner's mirror image [m]. */
function lean(mesh, material, side, time) {
  const [input, output] = [join(folder, "scene.json"), join(folder, "cloth.obj")];
  writeFileSync(input, JSON.stringify(scene(mesh, material, side)));
  const steps = Math.round(time / dt);
  execFileSync(program, ["run", input, "--time", String(steps * dt), "--out", output], { stdio: "ignore" });
  const lines = readFileSync(output, "utf8").split("\n");
  const at = lines.filter((line) => line.startsWith("v ")).map((line) => line.split(" ").slice(1, 4).map(Number));
  let most = 0;
  for (let i = 0; i < at.length; ++i) {
    const other = at[i - (i % side) + side - 1 - (i % side)];
    most = Math.max(most, Math.hypot(at[i][0] + other[0], at[i][1] - other[1], at[i][2] - other[2]));
  }
  return most;
}

const grid = (side) => ({ grid: { columns: side, rows: side } });
console.log("millimetres from the mirror image after        0.1 s   0.25 s");
for (const side of [25, 49])
  for (const [name, mesh, material] of [
    ["fem on a grid", grid(side), { fabric: "interlock" }],
    ["fem, diagonals to and fro", alternating(side), { fabric: "interlock" }],
    ["springs", grid(side), { model: "springs", structural: 200, shear: 100, bend: 2, damping: 0.01 }],
  ]) {
    const [early, late] = [0.1, 0.25].map((time) => 1000 * lean(mesh, material, side, time));
    console.log(
      `${`${side}x${side}, ${name}`.padEnd(44)} ${early.toPrecision(2).padStart(7)} ${late.toPrecision(2).padStart(8)}`,
    );
  }
rmSync(folder, { recursive: true });
