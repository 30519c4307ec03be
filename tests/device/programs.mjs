// Runs the programs of the bundle, for the parts of tests/device/run.
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

export const folder = mkdtempSync(join(tmpdir(), "clothlab-device-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

export const brief = (value) => (Number.isFinite(value) ? Number(value.toPrecision(4)) : null);

/** Runs a program to its end, or to the limit. With `loud` its lines are shown as they come. */
export function execute(command, words, { limit, environment = {}, loud = false }) {
  return new Promise((resolve) => {
    const child = spawn(command, words.map(String), { env: { ...process.env, ...environment } });
    let [out, error] = ["", ""];
    const timer = setTimeout(() => child.kill("SIGKILL"), 1000 * Math.max(limit, 1));
    child.stdout.on("data", (data) => {
      out += data;
      if (loud) process.stdout.write(data);
    });
    child.stderr.on("data", (data) => (error += data));
    child.on("error", (why) => (error += why.message));
    child.on("close", (status, signal) => {
      clearTimeout(timer);
      const why = signal === "SIGKILL" ? `stopped after ${Math.round(limit)} s` : error.trim().split("\n").at(-1);
      resolve({ status, out, why: why || `exit code ${status ?? signal}`, done: status === 0 });
    });
  });
}

export const clothlab = (here, words, options) => execute(join(here, "with"), ["clothlab", ...words], options);

/** The report of `clothlab run`, or what went wrong. */
export async function report(here, scene, words, options) {
  const file = join(folder, "report.json");
  const ran = await clothlab(here, ["run", scene, "--report", file, ...words], options);
  return ran.done ? JSON.parse(readFileSync(file, "utf8")) : { failed: ran.why };
}
