// Crossings in the scenes that are hard on contact (tests/contact_scenes.h), with `surface` and beside it with
// `points`.
// By hand:
//   node tests/bench/contact.mjs [MACHINE] [--time 10] [--most 30] [--methods a,b] [--sizes 16] [--thickness 0.005]
//                                [--speeds 1] [--scenes a,b] [--kinds surface,points]
//       ->   tests/bench/results/contact-MACHINE.json, a table
// A cell ends early after --most seconds of wall time; the table then says how far it came. Two cells run at a time.
import { execFile, execFileSync } from "node:child_process";
import { mkdirSync, writeFileSync } from "node:fs";
import { cpus, loadavg } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs, promisify } from "node:util";

const here = dirname(fileURLToPath(import.meta.url));
const build = join(here, "../../build/release");
const list = (text) => text.split(",");
const { values, positionals } = parseArgs({
  options: {
    time: { type: "string", default: "10" },
    most: { type: "string", default: "30" },
    methods: { type: "string", default: "symplectic_euler,implicit_euler,xpbd" },
    sizes: { type: "string", default: "16" },
    thickness: { type: "string", default: "0.005" },
    speeds: { type: "string", default: "1" },
    kinds: { type: "string", default: "surface,points" },
    scenes: {
      type: "string",
      default: "twist,fold,collide,resolutions,ribbon,shot,dropped_box,dragged_pin,layers,slot,roll,crush",
    },
  },
  allowPositionals: true,
});
const machine = positionals[0] ?? `${cpus().length}-cores`;
execFileSync("cmake", ["--build", build, "--target", "bench_contact"], { stdio: "ignore" });

const cells = [];
for (const scene of list(values.scenes))
  for (const method of list(values.methods))
    for (const size of list(values.sizes))
      for (const thickness of list(values.thickness))
        for (const speed of list(values.speeds))
          for (const kind of list(values.kinds)) cells.push([scene, kind, method, size, thickness, speed]);

const run = promisify(execFile);
const results = Array.from(cells, () => null);
let next = 0;
async function work() {
  while (next < cells.length) {
    const index = next++;
    const words = [...cells[index], values.time, values.most];
    const env = { ...process.env, LP_NUM_THREADS: "0" };
    try {
      results[index] = JSON.parse((await run(join(build, "tests/bench_contact"), words, { env })).stdout);
    } catch (error) {
      results[index] = { scene: words[0], kind: words[1], method: words[2], error: String(error.stderr ?? error) };
    }
    console.error(JSON.stringify(results[index]));
  }
}
const load = loadavg()[0];
await Promise.all([work(), work()]);

const out = join(here, "results", `contact-${machine}.json`);
mkdirSync(dirname(out), { recursive: true });
writeFileSync(out, `${JSON.stringify({ machine, load, options: values, results }, null, 1)}\n`);
const rows = results.map((r) =>
  r.error
    ? `| ${r.scene} | ${r.method} | ${r.kind} | ${r.error.trim()} |`
    : `| ${r.scene} | ${r.method} | ${r.kind} | ${r.size}, ${1000 * r.thickness} mm, ${r.speed} m/s | ${r.time} s | ` +
      `${r.most_crossings} | ${r.crossed_frames} of ${r.frames} | ${r.diverged ? "diverged" : r.max_strain} |`,
);
console.log("| scene | method | kind | size, thickness, speed | reached | most crossings | frames | largest strain |");
console.log(["|---|---|---|---|---|---|---|---|", ...rows].join("\n"));
