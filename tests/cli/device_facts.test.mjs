// What the program measures of a device once, and keeps (server/gl/device_fact.h): how it reads buffers, and when one
// work group sweeps a cloth.
import assert from "node:assert/strict";
import { mkdirSync, readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { userShaders } from "../caches.mjs";
import { some, thoroughTest } from "../thorough.mjs";
import { clothlab, folder } from "./program.mjs";

const cache = join(folder, "facts");
const env = { ...userShaders, XDG_CACHE_HOME: cache, CLOTHLAB_READS: undefined, CLOTHLAB_SWEEPS: undefined };
const kept = () => {
  const devices = join(cache, "clothlab", "devices");
  return readdirSync(devices).map((file) => join(devices, file));
};
/** The file of the fact whose name begins so. */
const fileOf = (name) => kept().find((file) => readFileSync(file, "utf8").startsWith(name));
const info = () => {
  const { status, stdout, stderr } = clothlab(["info"], env);
  assert.equal(status, 0, stderr);
  return stdout;
};
/** Puts a number in the place of the measured one. */
const pretend = (file, value) => writeFileSync(file, `${readFileSync(file, "utf8").split("\n")[0]}\n${value}\n`);

test("a device is measured once: the next run finds the numbers", () => {
  mkdirSync(cache, { recursive: true });
  const first = info();
  assert.match(first, /reads of storage buffers take [\d.e+-]+ times as long/);
  assert.match(first, /under pbd and xpbd is swept by one work group up to [\d.e+-]+ vertices a colour/);
  assert.equal(kept().length, 3);
  const written = kept().map((file) => statSync(file).mtimeMs);
  assert.equal(info(), first);
  assert.deepEqual(
    kept().map((file) => statSync(file).mtimeMs),
    written,
  );
});

test("the number decides how kernels read, and a state does not depend on it", () => {
  const scene = (method) => ({
    version: 1,
    name: "sheet",
    cloths: [{ mesh: { grid: { columns: 12, rows: 12, width: 0.5, height: 0.5 } }, pins: [{ at: "corner:0,0" }] }],
    self_collision: { kind: "surface", thickness: 0.01, friction: 0.2 },
    solver: { method, dt: 0.001, iterations: 3, tolerance: 1e-4 },
  });
  const hash = (method) => {
    const [file, report] = ["sheet.json", "sheet-report.json"].map((name) => join(folder, name));
    writeFileSync(file, JSON.stringify(scene(method)));
    const { status, stderr } = clothlab(["run", file, "--time", "0.05", "--report", report], env);
    assert.equal(status, 0, stderr);
    return JSON.parse(readFileSync(report, "utf8")).state_hash;
  };
  const methods = some(["xpbd", "implicit_euler", "symplectic_euler"]);
  const reads = fileOf("storage reads over texture reads");
  pretend(reads, 2);
  assert.match(info(), /: buffer textures$/m);
  const read = methods.map(hash);
  pretend(reads, 0.5);
  assert.match(info(), /: storage buffers$/m);
  assert.deepEqual(methods.map(hash), read);
});

test("a file that is damaged, or about another device, is measured anew", () => {
  const reads = fileOf("storage reads over texture reads");
  const [about] = readFileSync(reads, "utf8").split("\n");
  for (const text of ["", `${about}\n`, `${about}\nfast\n`, `${about}\nnan\n`, `another device\n0.1\n`]) {
    writeFileSync(reads, text);
    info();
    const [now, number] = readFileSync(reads, "utf8").split("\n");
    assert.equal(now, about);
    assert.ok(Number(number) > 0, JSON.stringify(text));
  }
});

thoroughTest("without a folder to keep them in, devices are measured in every run", () => {
  writeFileSync(join(folder, "in-the-way"), "");
  const { status, stderr } = clothlab(["info"], { ...env, XDG_CACHE_HOME: join(folder, "in-the-way") });
  assert.equal(status, 0, stderr);
});
