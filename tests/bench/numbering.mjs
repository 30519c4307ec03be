// What the order of a mesh's vertices costs a step: a grid's triangles with its rows in order, and the same shuffled,
// as it lies and as the program renumbers it. The three alternate; ratios of the medians are printed.
//   node tests/bench/numbering.mjs [SIDE [ROUNDS]]      CLOTHLAB: the program
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { median } from "../median.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const program = process.env.CLOTHLAB ?? join(here, "../../build/release/clothlab");
const side = Number(process.argv[2] ?? 316);
const rounds = Number(process.argv[3] ?? 7);
const folder = mkdtempSync(join(tmpdir(), "clothlab-numbering-"));

let seed = 1; // Park & Miller 1988
const below = (n) => (seed = (seed * 48271) % 2147483647) % n;
function shuffle(list) {
  for (let i = list.length - 1; i > 0; i--) {
    const j = below(i + 1);
    [list[i], list[j]] = [list[j], list[i]];
  }
}

function write(name, shuffled) {
  const order = Array.from({ length: side * side }, (_, i) => i);
  const faces = [];
  for (let row = 0; row + 1 < side; row++)
    for (let column = 0; column + 1 < side; column++) {
      const a = row * side + column;
      faces.push([a, a + side, a + side + 1], [a, a + side + 1, a + 1]);
    }
  if (shuffled) for (const list of [order, faces]) shuffle(list);
  const place = [];
  order.forEach((old, at) => {
    place[old] = at + 1;
  });
  const lines = order.map(
    (i) => `v ${((i % side) / (side - 1)).toFixed(6)} 0 ${(Math.floor(i / side) / (side - 1)).toFixed(6)}`,
  );
  for (const face of faces) lines.push(`f ${face.map((i) => place[i]).join(" ")}`);
  writeFileSync(join(folder, `${name}.obj`), lines.join("\n"));
  const cloth = {
    mesh: { obj: `${name}.obj` },
    mass: { area_density: 0.2 },
    material: { structural: 200, shear: 100, bend: 20, damping: 0.001 },
    pins: [
      {
        at: {
          box: [
            [-1, -1, -1e-3],
            [2, 1, 1e-3],
          ],
        },
      },
    ],
  };
  writeFileSync(join(folder, `${name}.json`), JSON.stringify({ version: 1, cloths: [cloth], solver: { dt: 2e-5 } }));
}

write("ordered", false);
write("shuffled", true);
const trials = [
  { name: "in order", scene: "ordered", numbering: "near" },
  { name: "shuffled, as it lies", scene: "shuffled", numbering: "scene" },
  { name: "shuffled, renumbered", scene: "shuffled", numbering: "near" },
].map((trial) => ({ ...trial, samples: [] }));
for (let round = 0; round < rounds; round++)
  for (const trial of trials) {
    const report = join(folder, "report.json");
    const env = { ...process.env, CLOTHLAB_NUMBERING: trial.numbering };
    execFileSync(program, ["run", join(folder, `${trial.scene}.json`), "--time", "0.002", "--report", report], {
      env,
      stdio: "ignore",
    });
    trial.samples.push(JSON.parse(readFileSync(report, "utf8")).ns_per_vertex_step);
  }
rmSync(folder, { recursive: true });
for (const { name, samples } of trials)
  console.log(
    name.padEnd(22),
    `${(median(samples) / median(trials[0].samples)).toFixed(2)}  (${samples.map((x) => x.toFixed(0)).join(", ")} ns per vertex and step)`,
  );
