// What the benches beside other programs share: clothlab and Bullet's programs, and how a mesh is read.
import { execFileSync, spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const builds = join(here, "../../../build");

export const clothlab = process.env.CLOTHLAB ?? join(builds, "release/clothlab");
/** Of software OpenGL, beside the first: the other programs use one core. */
export const threads = process.env.LP_NUM_THREADS ?? "0";

/** Ends the bench and says what to install. */
export function demand(what, how) {
  console.error(`${what} is not installed: ${how}`);
  process.exit(1);
}

/** The folder of peer_bullet and peer_judge, which are built. */
export function buildBullet() {
  if (spawnSync("pkg-config", ["--exists", "bullet"]).status !== 0) demand("Bullet", "apt-get install libbullet-dev");
  const folder = join(builds, "peers");
  execFileSync("cmake", ["-S", here, "-B", folder, "-DCMAKE_BUILD_TYPE=Release"], { stdio: "ignore" });
  execFileSync("cmake", ["--build", folder], { stdio: "ignore" });
  return folder;
}
export const bulletVersion = () => execFileSync("pkg-config", ["--modversion", "bullet"], { encoding: "utf8" }).trim();

/** A program of tests/bench, built beside clothlab's release. */
export function buildBench(name) {
  execFileSync("cmake", ["--build", join(builds, "release"), "--target", `bench_${name}`], { stdio: "ignore" });
  return join(builds, `release/tests/bench_${name}`);
}

/** What a program prints; what it warns of is shown, or not. */
export const run = (command, words, warnings = "inherit") =>
  execFileSync(command, words, {
    encoding: "utf8",
    maxBuffer: 1 << 28,
    stdio: ["ignore", "pipe", warnings],
    env: { ...process.env, LP_NUM_THREADS: threads },
  });

/** Vertices and triangles, counted from 0, of an .obj file. */
export function readMesh(path) {
  const text = readFileSync(path, "utf8");
  const rows = (pattern) => [...text.matchAll(pattern)].map((found) => found.slice(1).map(Number));
  return {
    vertices: rows(/^v (\S+) (\S+) (\S+)/gm),
    triangles: rows(/^f (\d+)\S* (\d+)\S* (\d+)/gm).map((corners) => corners.map((corner) => corner - 1)),
  };
}

export { median } from "../../median.mjs";
