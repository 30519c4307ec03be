// `clothlab selftest` on each OpenGL driver that Mesa plays on a machine without a GPU, and one table of how far each
// is from the reference.
//   tests/drivers/run [--quick] [--write] [DRIVER]...
// --quick as of selftest. --write puts the table into tests/drivers/README.md; else it is printed. DRIVER: a part of a
// name below.
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const program = process.env.CLOTHLAB ?? join(here, "../../build/release/clothlab");

/** Scenes that take softpipe, which interprets every instruction, a few seconds each. */
export const shortest = [
  "swing, explicit_euler",
  "swing, symplectic_euler",
  "swing, verlet",
  "swing, rk4",
  "wind, symplectic_euler",
  "mesh, symplectic_euler",
  "points, symplectic_euler",
  "sheet, symplectic_euler",
  "body, symplectic_euler",
  "hand, symplectic_euler",
];
export const softpipe = {
  GALLIUM_DRIVER: "softpipe",
  MESA_GL_VERSION_OVERRIDE: "4.5",
  MESA_GLSL_VERSION_OVERRIDE: "450",
  CLOTHLAB_SWEEPS: "dispatches",
};
const llvmpipe = (reads, more = {}) => ({ GALLIUM_DRIVER: "llvmpipe", CLOTHLAB_READS: reads, ...more });
const all = [
  { name: "llvmpipe, reads as textures", environment: llvmpipe("textures") },
  { name: "as storage", environment: llvmpipe("storage") },
  { name: "as storage, 16 blocks", environment: llvmpipe("storage", { CLOTHLAB_STORAGE_BLOCKS: "16" }) },
  { name: "as storage, 8 blocks", environment: llvmpipe("storage", { CLOTHLAB_STORAGE_BLOCKS: "8" }) },
  {
    name: "softpipe",
    environment: { ...softpipe, CLOTHLAB_READS: "textures" },
    only: shortest.map((name) => `scene: ${name}`),
  },
  {
    name: "zink on lavapipe",
    environment: { GALLIUM_DRIVER: "zink", LIBGL_ALWAYS_SOFTWARE: "1", CLOTHLAB_READS: "textures" },
  },
];

/** The checks of a selftest, or why there are none. */
function selftest({ name, environment, only = [] }, options, folder) {
  const file = join(folder, "checks.json");
  rmSync(file, { force: true });
  console.error(`${name} ...`);
  const { status, signal, stdout, stderr } = spawnSync(
    program,
    ["selftest", ...options, "--json", file, ...only.flatMap((check) => ["--only", check])],
    { env: { ...process.env, LP_NUM_THREADS: "0", ...environment }, encoding: "utf8", maxBuffer: 1 << 28 },
  );
  const ended = status === 0 || status === 1;
  if (!ended) return { checks: [], failed: [`ended by ${signal ?? status}: ${(stderr || stdout).trim().slice(-300)}`] };
  const { device, checks } = JSON.parse(readFileSync(file, "utf8"));
  const failed = stdout.split("\n").filter((line) => line.startsWith("WRONG "));
  return { device, checks, failed };
}

const brief = (value) => (value === undefined ? "" : value === 0 ? "0" : value.toExponential(1));

/** A row for each scene: the largest distance of its methods; and how much of what is allowed the worst takes. */
export function table(results) {
  const scenes = [
    ...new Set(
      results
        .flatMap(({ checks }) => checks.map(({ name }) => /^scene: ([^,]+),/.exec(name)?.[1]))
        .filter((scene) => scene),
    ),
  ];
  const of = (checks, scene) => checks.filter(({ name }) => name.startsWith(`scene: ${scene},`));
  const most = (values) => (values.length > 0 ? Math.max(...values) : undefined);
  const row = (cells) => `| ${cells.join(" | ")} |`;
  const share = ({ checks }) =>
    most(checks.filter(({ name }) => name.startsWith("scene: ")).map(({ found, allowed }) => found / allowed));
  return [
    row(["scene", ...results.map(({ name }) => name)]),
    row(["---", ...results.map(() => "---")]),
    ...scenes.map((scene) =>
      row([scene, ...results.map(({ checks }) => brief(most(of(checks, scene).map(({ found }) => found))))]),
    ),
    row(["most of what is allowed", ...results.map((result) => brief(share(result)))]),
    row(["checks, of them failed", ...results.map(({ checks, failed }) => `${checks.length}, ${failed.length}`)]),
  ].join("\n");
}

function main(args) {
  const wanted = args.filter((arg) => !arg.startsWith("--"));
  const chosen = all.filter(({ name }) => wanted.length === 0 || wanted.some((part) => name.includes(part)));
  const folder = mkdtempSync(join(tmpdir(), "clothlab-drivers-"));
  const results = chosen.map((driver) => ({
    name: driver.name,
    ...selftest(driver, args.includes("--quick") ? ["--quick"] : [], folder),
  }));
  rmSync(folder, { recursive: true, force: true });
  for (const { name, device, failed } of results)
    for (const line of [`${name}: ${device ?? "no result"}`, ...failed]) console.error(line);
  const text = table(results);
  if (!args.includes("--write")) return console.log(text);
  const readme = join(here, "README.md");
  const mark = "<!-- the table of tests/drivers/run -->";
  const [before, , after] = readFileSync(readme, "utf8").split(mark);
  writeFileSync(readme, `${before}${mark}\n${text}\n${mark}${after}`);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) main(process.argv.slice(2));
