// MuJoCo, as its npm package has it: WebAssembly, in this process. Native code would be faster.
//
// The cloth. Each vertex is a body on three slides, along x, y and z, or a fixed one. All springs are the edges of one
// flex of dimension 1, whose force, stiffness (rest length - length) along the edge, is our law. Spatial tendons with
// the same stiffness and spring length give the same positions and take a tenth longer; a dense Jacobian takes half as
// long again. Air drag is the slides' damping. Nothing else is left on: no contacts, no constraints, no search for
// either.
//
// Integrators. `Euler` is our symplectic Euler: velocities first, positions from them. `RK4` is ours, too.
// `implicitfast` and `implicit` are implicit in damping alone: without any they give Euler's positions at more cost.
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import { demand } from "./shared.mjs";

export const version = "3.14.0";

async function load() {
  try {
    const { default: start } = await import(
      pathToFileURL(createRequire(import.meta.url).resolve("@mujoco/mujoco")).href
    );
    return await start();
  } catch (wrong) {
    if (wrong.code !== "MODULE_NOT_FOUND") throw wrong;
    demand("MuJoCo", "npm ci --prefix tests/bench/peers");
  }
}

const words = (list) => list.flat().join(" ");

function describe(cloth, integrator, air_drag, gravity) {
  const slides = (mass) =>
    ["1 0 0", "0 1 0", "0 0 1"]
      .map((axis) => `<joint type="slide" axis="${axis}" damping="${mass * air_drag}"/>`)
      .join("");
  // Bodies on slides never turn, but must have an inertia.
  const moves = (mass) => `<inertial pos="0 0 0" mass="${mass}" diaginertia="1e-6 1e-6 1e-6"/>${slides(mass)}`;
  const pinned = new Set(cloth.pinned);
  const bodies = cloth.start.map(
    (at, i) => `<body name="${i}" pos="${words(at)}">${pinned.has(i) ? "" : moves(cloth.mass_kg[i])}</body>`,
  );
  const [{ stiffness, damping }] = cloth.springs;
  if (cloth.springs.some((spring) => spring.stiffness !== stiffness || spring.damping !== damping))
    throw new Error("a flex has one stiffness for all its edges");
  return `<mujoco>
    <compiler boundmass="0" boundinertia="0"/>
    <option integrator="${integrator}" gravity="${words(gravity)}" jacobian="sparse">
      <flag constraint="disable" contact="disable" midphase="disable"/>
    </option>
    <size memory="64M"/>
    <worldbody>${bodies.join("")}</worldbody>
    <deformable>
      <flex name="cloth" dim="1" radius="0.001" body="${words([...cloth.start.keys()])}"
            element="${words(cloth.springs.map(({ ends }) => ends))}">
        <contact contype="0" conaffinity="0" selfcollide="none" internal="false"/>
        <edge stiffness="${stiffness}" damping="${damping}"/>
      </flex>
    </deformable>
  </mujoco>`;
}

/** A function (integrator, { dt, seconds, air_drag }) that steps the cloth from the start and gives its positions, or
 * null after a blow-up, and the milliseconds of a simulated second. */
export async function mujoco(cloth, gravity) {
  const engine = await load();
  const worlds = new Map();
  const worldOf = (integrator, air_drag) => {
    const key = `${integrator} ${air_drag}`;
    if (!worlds.has(key)) {
      const model = engine.MjModel.from_xml_string(describe(cloth, integrator, air_drag, gravity));
      const data = new engine.MjData(model);
      model.opt.timestep = 1e-6;
      for (let i = 0; i < 500; ++i) engine.mj_step(model, data); // until WebAssembly is compiled for good
      worlds.set(key, { model, data });
    }
    return worlds.get(key);
  };
  return (integrator, { dt, seconds, air_drag }) => {
    const { model, data } = worldOf(integrator, air_drag);
    engine.mj_resetData(model, data);
    model.opt.timestep = dt;
    const steps = Math.round(seconds / dt);
    const before = performance.now();
    for (let i = 0; i < steps; ++i) engine.mj_step(model, data);
    const ms = (performance.now() - before) / (steps * dt);
    if (Math.abs(data.time - seconds) > dt / 2) return { ms, positions: null }; // it was reset, after a blow-up
    engine.mj_kinematics(model, data); // a step leaves the bodies where they were before it
    const x = data.xpos;
    return { ms, positions: cloth.start.map((_, i) => [0, 1, 2].map((k) => x[3 * (i + 1) + k])) };
  };
}
