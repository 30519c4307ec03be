// Clothlab beside Bullet 3.24, its classic and its deformable soft body, on the same falls, folds and drapes: cost of a
// step, crossings and stretch. By hand, on a quiet machine, after `apt-get install libbullet-dev`:
//   node tests/bench/peers.mjs [MACHINE] [--sides 25,64] [--scenes fall,fold,drape] [--rounds N] [--method M]
//                              [--iterations N] [--out FILE]   ->   tests/bench/results/peers-MACHINE.json, a table
// All four get the same mesh, masses, springs, pins, bodies and time step (peers/scenes.mjs); what Bullet's settings
// are, and why, is at the top of peers/classic.cpp and peers/deformable.cpp. The four run one after the other in every
// round, so that a noisy machine disturbs all alike; ratios are those of a round. Bullet uses one core, and so may
// clothlab: LP_NUM_THREADS=0, unless the environment sets it. Time is that of stepping alone. With 64x64 vertices a
// round of a scene takes a quarter of an hour and more, most of it Bullet's.
// Crossings are counted in the state at every tenth of a second, exactly, in double precision, by the search that
// `clothlab run --verify` uses; of clothlab's own runs twice, by `--verify` and from the meshes it wrote.
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { cpus, loadavg, tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { document, every, peer, scenes } from "./peers/scenes.mjs";
import { buildBullet, bulletVersion, clothlab, median, readMesh, run, threads } from "./peers/shared.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const { values, positionals } = parseArgs({
  options: {
    sides: { type: "string", default: "25" },
    scenes: { type: "string", default: Object.keys(scenes).join(",") },
    rounds: { type: "string", default: "3" },
    method: { type: "string", default: "symplectic_euler" },
    iterations: { type: "string", default: "10" },
    out: { type: "string" },
  },
  allowPositionals: true,
});
const machine = positionals[0] ?? `${cpus().length}-cores`;
const peers = buildBullet();

const load = loadavg()[0];
const folder = mkdtempSync(join(tmpdir(), "clothlab-peers-"));
const readJson = (path) => JSON.parse(readFileSync(path, "utf8"));
const lines = (text) => text.trim().split("\n").map(JSON.parse);

/** The worst of all samples in `frames`, and the last one's crossings. A frame that is not finite is null. */
function judge(scene, frames) {
  const files = readdirSync(frames).filter((file) => file.endsWith(".obj"));
  const paths = files.sort().map((file) => join(frames, file));
  const found = lines(run(join(peers, "peer_judge"), [scene, ...paths]));
  const most = (key) => (found.includes(null) ? null : Math.max(...found.map((frame) => frame[key])));
  return {
    crossings_most: most("crossings"),
    crossings_at_end: found.at(-1)?.crossings ?? null,
    largest_stretch: most("stretch"),
    stretch_at_end: found.at(-1)?.stretch ?? null,
    deepest_in_body_m: most("depth_m"),
  };
}

/** The file that Bullet and the judge read, with the mesh that clothlab makes of the scene. */
function describe(name, side, place) {
  const scene = document(name, side, "surface", values.method, Number(values.iterations));
  const [written, start] = ["scene.json", "start.obj"].map((file) => join(place, file));
  writeFileSync(written, JSON.stringify({ ...scene, name: "start" }));
  run(clothlab, ["run", written, "--time", String(scene.solver.dt), "--every", "1", "--out", start]);
  const mesh = readMesh(start.replace(".obj", "-0000.obj"));
  writeFileSync(written, JSON.stringify(peer(scene, mesh)));
  return written;
}

function runClothlab(kind, name, side, scene, frames) {
  const [file, report] = ["scene.json", "report.json"].map((each) => join(frames, each));
  writeFileSync(file, JSON.stringify(document(name, side, kind, values.method, Number(values.iterations))));
  const words = ["--time", String(scenes[name].seconds), "--every", String(every), "--verify"];
  run(clothlab, ["run", file, ...words, "--report", report, "--out", join(frames, "frame.obj")]);
  const { step_s, steps, vertices, renderer, crossings } = readJson(report);
  const found = judge(scene, frames);
  if (found.crossings_most !== crossings)
    throw new Error(`${name}: --verify counts ${crossings} crossings, the meshes have ${found.crossings_most}`);
  return { ...found, ns: (1e9 * step_s) / steps / vertices, renderer };
}

function runBullet(body, scene, frames) {
  const [{ step_s, steps, vertices }] = lines(run(join(peers, "peer_bullet"), [body, scene, frames]));
  return { ...judge(scene, frames), ns: (1e9 * step_s) / steps / vertices };
}

const programs = {
  "clothlab points": (...where) => runClothlab("points", ...where),
  "clothlab surface": (...where) => runClothlab("surface", ...where),
  "Bullet classic": (_name, _side, ...where) => runBullet("classic", ...where),
  "Bullet deformable": (_name, _side, ...where) => runBullet("deformable", ...where),
};

let renderer = "";
/** All programs on one scene, in every round: what they came to is the same each time, what it cost is not. */
function measure(name, side) {
  const place = mkdtempSync(join(folder, `${name}-`));
  const scene = describe(name, side, place);
  const results = Object.keys(programs).map((of) => ({ scene: name, side, program: of, ns: [] }));
  for (let round = 0; round < Number(values.rounds); ++round)
    for (const result of results) {
      const frames = join(place, `${result.program} ${round}`);
      mkdirSync(frames);
      const { ns, renderer: drawn, ...found } = programs[result.program](name, side, scene, frames);
      renderer = drawn ?? renderer;
      result.found ??= JSON.stringify(found);
      if (result.found !== JSON.stringify(found)) throw new Error(`${result.program}: another result in each round`);
      Object.assign(result, found);
      result.ns.push(ns);
      rmSync(frames, { recursive: true });
      console.error(`${name} ${side}x${side}, round ${round}, ${result.program}: ${Math.round(ns)} ns`);
    }
  const surface = results.find(({ program: of }) => of === "clothlab surface");
  return results.map(({ ns, found: _found, ...rest }) => ({
    ...rest,
    median_ns: median(ns),
    min_ns: Math.min(...ns),
    to_surface: median(ns.map((value, i) => value / surface.ns[i])),
    runs_ns: ns,
  }));
}

const results = values.sides
  .split(",")
  .flatMap((side) => values.scenes.split(",").flatMap((name) => measure(name, Number(side))));
rmSync(folder, { recursive: true });

const summary = {
  what: "clothlab beside Bullet's soft bodies: ns a vertex and step, crossings, largest stretch of an edge",
  machine,
  renderer,
  bullet: bulletVersion(),
  cpu: cpus()[0].model,
  cores: cpus().length,
  llvmpipe_threads: Number(threads),
  load_average: load,
  rounds: Number(values.rounds),
  method: values.method,
  iterations: Number(values.iterations),
  results,
};
const out = values.out ?? join(here, `results/peers-${machine}.json`);
writeFileSync(out, `${JSON.stringify(summary, null, 1)}\n`);

const share = (value) => (value === null ? "not finite" : `${(100 * value).toFixed(1)} %`);
const rows = results.map((r) => [
  `${r.scene}, ${r.side}x${r.side}`,
  r.program,
  `${Math.round(r.median_ns)} (${r.to_surface.toFixed(2)})`,
  `${r.crossings_most ?? "not finite"} / ${r.crossings_at_end ?? "not finite"}`,
  `${share(r.largest_stretch)} / ${share(r.stretch_at_end)}`,
  r.deepest_in_body_m === null ? "not finite" : `${(1000 * r.deepest_in_body_m).toFixed(1)} mm`,
]);
const head = ["scene", "program", "ns a vertex and step (to surface)", "crossings, most / at the end"];
for (const row of [[...head, "largest stretch / at the end", "deepest in a body"], Array(6).fill("---"), ...rows])
  console.log(`| ${row.join(" | ")} |`);
console.log(`\nwritten: ${out}`);
