// The programs of tests/bench/peer_accuracy.mjs on the swinging cloth: each takes { dt, iterations, seconds, air_drag }
// and gives the milliseconds of stepping for a simulated second, and the positions, or null if they are not finite.
import { existsSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { mujoco } from "./mujoco.mjs";
import { buildBullet, clothlab, readMesh, run } from "./shared.mjs";

const finite = (positions) => (positions.flat().every(Number.isFinite) ? positions : null);

/** A longer step than 1.2 ms, 0.3 s / 256, no explicit method can take: their bound, RK4's too, is a property of the
 * springs. The others start with 19 ms. */
const explicit = { least_steps: 256 };
const implicit = { least_steps: 16 };
/** PBD and XPBD are cheapest with one iteration at every error, as tests/bench/equal_error.mjs found. It found Explicit
 * Euler unstable at any step, which is why it is not here. */
const methods = {
  symplectic_euler: { ...explicit, iterations: [1] },
  verlet: { ...explicit, iterations: [1] },
  rk4: { ...explicit, iterations: [1] },
  implicit_euler: { ...implicit, iterations: [1, 4] },
  pbd: { ...implicit, iterations: [1] },
  xpbd: { ...implicit, iterations: [1] },
  vbd: { ...implicit, iterations: [1, 2, 4] },
};

function runClothlab(document, method, { dt, iterations, seconds, air_drag }, folder) {
  const [scene, report, mesh] = ["scene.json", "report.json", "end.obj"].map((file) => join(folder, file));
  // With a tolerance of 1e-4 small implicit steps would need no iteration, and their errors add up.
  writeFileSync(scene, JSON.stringify({ ...document, air_drag, solver: { method, dt, iterations, tolerance: 1e-6 } }));
  rmSync(report, { force: true });
  try {
    run(clothlab, ["run", scene, "--time", String(seconds), "--report", report, "--out", mesh], "pipe");
  } catch (wrong) {
    if (!existsSync(report) || !JSON.parse(readFileSync(report, "utf8")).diverged) throw wrong;
    return { ms: 0, positions: null };
  }
  const { step_s, sim_time, renderer } = JSON.parse(readFileSync(report, "utf8"));
  return { ms: (1000 * step_s) / sim_time, renderer, positions: readMesh(mesh).vertices };
}

/** The file that peer_bullet reads. It has one stiffness for springs that bend and another for the rest; here both are
 * the same, so none needs to be told apart. */
function runBullet(program, document, cloth, { dt, iterations, seconds, air_drag }, more, folder) {
  const steps = Math.round(seconds / dt);
  const scene = {
    document: { ...document, air_drag, solver: { dt } },
    vertices: cloth.start,
    triangles: cloth.triangles,
    springs: cloth.springs.map(({ ends }) => [...ends, false]),
    held: cloth.pinned,
    turned: [],
    steps,
    steps_a_sample: steps,
    sweeps: iterations,
    implicit: more.implicit ?? false,
  };
  const file = join(folder, "scene.json");
  writeFileSync(file, JSON.stringify(scene));
  const { step_s } = JSON.parse(run(program, [more.body, file, folder]));
  return { ms: (1000 * step_s) / (steps * dt), positions: finite(readMesh(join(folder, "frame-0001.obj")).vertices) };
}

/** All programs, each { name, least_steps, iterations, run }; `cloth` is what bench_truth printed. */
export async function programs(document, cloth, folder) {
  const bullet = join(buildBullet(), "peer_bullet");
  const step = await mujoco(cloth, document.gravity);
  const of_bullet = (name, kind, more) => ({
    name,
    ...kind,
    run: (setting) => runBullet(bullet, document, cloth, setting, more, folder),
  });
  const of_mujoco = (integrator) => ({
    name: `MuJoCo ${integrator} (WebAssembly)`,
    ...explicit,
    iterations: [1],
    run: (setting) => step(integrator, setting),
  });
  return [
    ...Object.entries(methods).map(([method, kind]) => ({
      name: `\`${method}\``,
      ...kind,
      run: (setting) => runClothlab(document, method, setting, folder),
    })),
    of_bullet("Bullet classic", { ...implicit, iterations: [1, 4, 10] }, { body: "classic" }),
    of_bullet("Bullet deformable, explicit", { ...explicit, iterations: [1] }, { body: "deformable" }),
    of_bullet("Bullet deformable, implicit", { ...implicit, iterations: [1] }, { body: "deformable", implicit: true }),
    of_mujoco("Euler"),
    of_mujoco("RK4"),
  ];
}
