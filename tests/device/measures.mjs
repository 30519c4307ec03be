// The parts of tests/device/run. Each prints its lines and returns what it measured; `failed` if nothing came of it,
// `wrong` if the device does something wrong.
import { readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { median } from "./median.mjs";
import { brief, clothlab, execute, folder, report } from "./programs.mjs";
import { heap } from "./scenes.mjs";
import { served } from "./served.mjs";

/** What is known of cards, to tell the share of their memory's bandwidth [GB/s]. */
const bandwidths = [
  [/B200/, 8000],
  [/H200/, 4800],
  [/H100.*PCIe/, 2000],
  [/H100/, 3350],
  [/A100.*80GB/, 2039],
  [/A100/, 1555],
  [/L40S/, 864],
  [/L4\b/, 300],
  [/T4\b/, 320],
  [/A10\b/, 600],
  [/RTX 5090/, 1792],
  [/RTX 4090/, 1008],
  [/RTX 3090/, 936],
];

async function device({ here, left, bandwidth }) {
  const info = await clothlab(here, ["info"], { limit: left(), loud: true });
  const name = /^\* \d+: (.*?), OpenGL/m.exec(info.out)?.[1];
  if (!name) return { failed: `clothlab info: ${info.why}`, info: info.out };
  const card = await execute("nvidia-smi", ["-L"], { limit: 10 });
  const known = bandwidth ?? bandwidths.find(([pattern]) => pattern.test(name))?.[1] ?? null;
  return {
    name,
    bandwidth_gb_s: known,
    info: info.out.trim().split("\n"),
    nvidia_smi: card.done ? card.out.trim() : null,
  };
}

async function selftest({ here, left }, words) {
  const file = join(folder, "selftest.json");
  rmSync(file, { force: true });
  const ran = await clothlab(here, ["selftest", ...words, "--json", file], { limit: left(), loud: true });
  if (ran.status !== 0 && ran.status !== 1) {
    const lines = ran.out.split("\n").filter((line) => /^(?:ok|WRONG) /.test(line));
    const wrong = lines.filter((line) => line.startsWith("WRONG"));
    const why = `${ran.why}; ${lines.length} checks came, ${wrong.length} wrong`;
    return { [left() < 1 ? "left_out" : "failed"]: why, wrong: wrong.length, lines };
  }
  const { passed, checks } = JSON.parse(readFileSync(file, "utf8"));
  return { wrong: checks.filter((check) => !check.passed).length, passed, checks };
}

/** Three runs of a scene end in the same bits. */
async function hashes({ here, left, small }) {
  const runs = [
    ["seed", 0.5, "symplectic_euler"],
    ["seed", 0.2, "implicit_euler"],
    ["twist", 0.1, "vbd"],
    ["skirt", 0.1, "xpbd"],
  ].slice(0, small ? 2 : 4);
  const told = [];
  for (const [scene, time, method] of runs) {
    const found = [];
    for (let i = 0; i < 3 && left() > 1; ++i) {
      const ran = await report(here, scene, ["--time", time, "--set", `/solver/method="${method}"`], { limit: left() });
      found.push(ran.state_hash ?? ran.failed);
    }
    const same = found.length === 3 && new Set(found).size === 1 && /^[0-9a-f]{16}$/.test(found[0]);
    console.log(`${same ? "ok   " : "WRONG"} ${scene}, ${method}: ${[...new Set(found)].join(", ")}`);
    told.push({ scene, method, same, hashes: found });
  }
  return { wrong: told.filter(({ same }) => !same).length, runs: told };
}

const all = ["explicit_euler", "symplectic_euler", "verlet", "rk4", "implicit_euler", "pbd", "xpbd", "vbd", "bdf2"];

/** ns a vertex and step of one method, by bench_methods, with another way to read or sweep in the environment. */
async function cost(here, side, method, limit, environment) {
  const ran = await execute(join(here, "with"), ["bench_methods", side, side > 256 ? 3 : 5, method], {
    limit,
    environment,
  });
  const rows = ran.out
    .trim()
    .split("\n")
    .filter((line) => line.startsWith("{"))
    .map((line) => JSON.parse(line));
  if (rows.length === 0) return [{ side, method, failed: ran.why }];
  return rows.map(({ iterations, dispatches, bytes_a_vertex, cg_iterations, ns }) => {
    const row = { side, method, iterations, ns: brief(median(ns)), dispatches, bytes_a_vertex };
    return cg_iterations > 0 ? { ...row, cg_iterations } : row;
  });
}

const cells = ({ side, method, iterations, ns, failed }) =>
  `${method}${iterations > 1 ? `, ${iterations} sweeps` : ""}, ${side}x${side}: ${failed ?? `${ns} ns a vertex and step`}`;

/** Every method at every size. The share is that of what kernels ask of memory, without caches: it may be above 1. */
async function methods({ here, left, small, result }) {
  const rows = [];
  const bandwidth = result.device?.bandwidth_gb_s ?? null;
  for (const side of small ? [25, 64] : [25, 64, 128, 256, 512, 1024])
    for (const method of all) {
      if (left() < 1) return { rows, wrong: 1, left_out: `from ${method}, ${side}x${side} on: no time was left` };
      for (const row of await cost(here, side, method, Math.min(left(), 40), {})) {
        const asked = row.ns ? row.bytes_a_vertex / row.ns : null; // bytes a nanosecond are GB/s
        rows.push({ ...row, gb_s: brief(asked), share: bandwidth && asked ? brief(asked / bandwidth) : null });
        console.log(`${cells(row)}${asked ? `, ${brief(asked)} GB/s` : ""}`);
      }
    }
  return { rows, wrong: rows.filter(({ failed }) => failed).length };
}

async function variants({ here, left }, variable, choices, methodsOf, sides) {
  const rows = [];
  for (const side of sides)
    for (const method of methodsOf)
      for (const choice of choices) {
        if (left() < 1) return { rows, left_out: "the rest: no time was left" };
        for (const row of await cost(here, side, method, Math.min(left(), 20), { [variable]: choice })) {
          rows.push({ ...row, choice });
          console.log(`${cells(row)}, ${choice}`);
        }
      }
  return { rows };
}

/** A method whose programs read more than a device binds as storage buffers reads textures there all the same. */
const reads = (given) =>
  variants(
    given,
    "CLOTHLAB_READS",
    ["textures", "storage"],
    ["symplectic_euler", "implicit_euler", "xpbd", "vbd"],
    given.small ? [25] : [64, 512],
  );

const sweeps = (given) =>
  variants(given, "CLOTHLAB_SWEEPS", ["one_group", "dispatches"], ["xpbd", "vbd"], given.small ? [12] : [12, 25, 40]);

async function surface({ here, left, small }) {
  const scene = small ? heap(4, 12, 16) : heap(50, 60, 82);
  const file = join(folder, "layers.json");
  writeFileSync(file, JSON.stringify(scene));
  const rows = [];
  for (const method of ["vbd", "xpbd", "symplectic_euler"]) {
    if (left() < 2) break;
    const steps = small ? 10 : 60;
    const words = ["--time", steps * 0.0002, "--set", "/solver/dt=0.0002", "--set", `/solver/method="${method}"`];
    const ran = await report(here, file, words, { limit: left() / 1.5 });
    const row = ran.failed
      ? { method, failed: ran.failed }
      : {
          method,
          vertices: ran.vertices,
          layers: scene.cloths.length,
          ms_a_step: brief((1000 * ran.step_s) / ran.steps),
          pairs: ran.self_collision.pairs,
        };
    rows.push(row);
    console.log(
      `${method}: ${row.failed ?? `${row.ms_a_step} ms a step of ${row.vertices} vertices, ${row.pairs} pairs`}`,
    );
  }
  return { rows, wrong: rows.filter(({ failed }) => failed).length };
}

/** In this order; `share` is the most of the time that a part may take [s], the last has what is left. */
export const parts = [
  { name: "device", share: 30, measure: device },
  { name: "selftest_quick", share: 100, measure: (given) => selftest(given, ["--quick"]) },
  { name: "hashes", share: 40, measure: hashes },
  { name: "methods", share: 130, measure: methods },
  { name: "surface", share: 60, measure: surface },
  { name: "reads", share: 40, measure: reads },
  { name: "sweeps", share: 25, measure: sweeps },
  { name: "served", share: 30, measure: served },
  {
    name: "selftest",
    measure: (given) => (given.small ? Promise.resolve({ left_out: "--small" }) : selftest(given, [])),
  },
];
