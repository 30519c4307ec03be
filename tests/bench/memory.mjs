// Memory that a scene takes of the server, against what the server expects of it. Run by hand:
//   CLOTHLAB=build/release/clothlab node tests/bench/memory.mjs [SIDE]... [--only REGEX] [--out FILE]
// Each scene is a grid of SIDE x SIDE vertices in a server of its own, watched by one viewer until some frames came.
// Prints (and writes) a line for each: the most memory that the server had less what it has with the smallest scene
// [bytes], what it reserved for the scene, and their quotient.
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Client, Server } from "../protocol/harness.mjs";

const args = process.argv.slice(2);
const option = (name) => (args.includes(name) ? args.splice(args.indexOf(name), 2)[1] : null);
const out = option("--out");
const only = new RegExp(option("--only") ?? "");
const sides = args.length > 0 ? args.map(Number) : [256, 512];

const folder = mkdtempSync(join(tmpdir(), "clothlab-memory-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

const fem = { model: "fem", warp: 2365, weft: 3801, poisson: 0.311, shear: 97, bending: { warp: 8e-6, weft: 12e-6 } };
const springs = { model: "springs", structural: 100, shear: 50, bend: 10, damping: 0.01 };
const patience = 900_000; // [ms]; a million vertices take minutes to build

const dts = { explicit_euler: 1e-8, implicit_euler: 1e-4, bdf2: 1e-4, pbd: 0.005, xpbd: 0.005, vbd: 0.005 };

function scene(side, method, material, more) {
  return {
    version: 1,
    cloths: [
      {
        mesh: { grid: { columns: side, rows: side, width: side / 256, height: side / 256 } },
        mass: { area_density: 0.1 },
        material,
        pins: [{ at: "corner:0,0" }, { at: `corner:${side - 1},0` }],
      },
    ],
    solver: { method, dt: dts[method] ?? 1e-6, iterations: 2 },
    ...more,
  };
}

const methods = ["symplectic_euler", "verlet", "rk4", "implicit_euler", "pbd", "xpbd", "vbd", "bdf2"];
const contact = (kind) => ({ self_collision: { thickness: 0.001, kind } });
const cases = [];
for (const side of sides) {
  for (const method of methods.filter((method) => method !== "pbd"))
    cases.push([`fem ${method}`, side, scene(side, method, fem, {})]);
  for (const method of methods) cases.push([`springs ${method}`, side, scene(side, method, springs, {})]);
  cases.push(["threads", side, scene(side, "symplectic_euler", { ...springs, shear: 0, bend: 0 }, {})]);
  cases.push([
    "membrane",
    side,
    scene(side, "symplectic_euler", { ...fem, bending: { warp: 0, weft: 0, twist: 0 } }, {}),
  ]);
  cases.push(["springs strain_limit", side, scene(side, "symplectic_euler", { ...springs, strain_limit: 0.1 }, {})]);
  cases.push(["fem wind", side, scene(side, "symplectic_euler", fem, { wind: { velocity: [0, 0, 1] } })]);
  for (const method of ["symplectic_euler", "xpbd"])
    for (const kind of ["points", "surface"])
      cases.push([`springs ${kind} ${method}`, side, scene(side, method, springs, contact(kind))]);
}

function memory(pid) {
  const text = readFileSync(`/proc/${pid}/status`, "utf8");
  const of = (key) => Number(new RegExp(`${key}:\\s+(\\d+) kB`).exec(text)[1]) * 1024;
  return { most: of("VmHWM"), now: of("VmRSS") };
}

/// A client that reads no more of frames than whether they are of the scene: [kind, vertices] of each.
async function viewer(server) {
  const client = await Client.connect(server);
  const receive = client.receive.bind(client);
  client.receive = (data, isBinary) => {
    if (!isBinary) return receive(data, false);
    client.binary.push([data.readUInt8(0), data.readUInt32LE(12)]);
    if (data.readUInt8(0) === 2) client.notify("stream.ack", { frame: data.readUInt32LE(8) });
    for (const check of client.waiting) check();
  };
  return client;
}

async function measured(document) {
  const server = await Server.start("--scene", smallest, "--max-vertices", "1048576");
  try {
    const client = await viewer(server);
    await client.request("scene.load", { scene: document }, patience);
    await client.request("stream.subscribe", { encoding: "q16", rate: 60, in_flight: 2 }, patience);
    const { columns, rows } = document.cloths[0].mesh.grid;
    const ofScene = ([kind, vertices]) => kind === 2 && vertices === columns * rows;
    await client.until(() => client.binary, ofScene, "a frame", patience);
    const stepped = ({ step, diverged }) => step > 0 || diverged;
    const status = await client.nextNotification("sim.status", stepped, patience);
    await client.statuses(20); // some search for the longest step, some states that are kept
    const reserved = await server.metric("clothlab_memory_simulations_bytes");
    return { ...memory(server.child.pid), buffers: status.memory_bytes, reserved };
  } finally {
    await server.stop("SIGKILL");
  }
}

const smallest = join(folder, "smallest.json");
writeFileSync(smallest, JSON.stringify(scene(3, "symplectic_euler", springs, {})));
const least = await measured(scene(3, "symplectic_euler", springs, {}));
const rows = [];
for (const [name, side, document] of cases) {
  if (!only.test(name)) continue;
  try {
    const found = await measured(document);
    const taken = found.most - least.most;
    const row = { scene: name, side, taken, a_vertex: Math.round(taken / side ** 2), ...found };
    row.reserved_over_taken = Number((found.reserved / taken).toFixed(2));
    rows.push(row);
    console.log(JSON.stringify(row));
  } catch (error) {
    console.log(JSON.stringify({ scene: name, side, failed: error.message }));
  }
}
if (out) writeFileSync(out, `${JSON.stringify({ benchmark: "memory", least, rows }, null, 1)}\n`);
