// One big patch, and many heavy ones, as others meet them. Two clients share a session: the one patches, the other asks
// for the scene every 100 ms. Measures how long the patch takes, how long `/healthz` is not ok meanwhile, and how soon
// an undo is answered that takes the patch back while it is built; then how long the other's requests wait beside 60
// heavy patches of the one, and for how long patches still arrive after the one has left. By hand, on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/big_patch.mjs [SIDE] [--out FILE]
// SIDE: vertices along a side of the big patch's cloth, 1024 unless told; its surfaces are in contact. Prints JSON.
import { writeFileSync } from "node:fs";
import { cpus } from "node:os";
import { Client, Server, sleep } from "../protocol/harness.mjs";
import { median } from "../median.mjs";

const args = process.argv.slice(2);
const out = args.includes("--out") ? args.splice(args.indexOf("--out"), 2)[1] : null;
const [side = 1024] = args.map(Number);
const longest = 900_000; // [ms]

const cloth = (vertices) => ({
  mesh: { grid: { columns: vertices, rows: vertices, width: 1, height: 1 } },
  transform: { translate: [0, 1, 0] },
  pins: [{ at: "corner:0,0" }],
});
const big = {
  cloths: [cloth(side)],
  self_collision: { kind: "surface", thickness: 0.0004 },
  solver: { method: "xpbd" },
};
const heavy = (i) => ({ cloths: [cloth(250 + (i % 2))], self_collision: null });

const seconds = (from) => (performance.now() - from) / 1000;
const rounded = (value) => Math.round(value * 1000) / 1000;

/// Asks for the scene every 100 ms until `until` is done. Returns the times of the answers [s].
async function answers(client, until) {
  const waits = [];
  let done = false;
  until.finally(() => {
    done = true;
  });
  while (!done) {
    const asked = performance.now();
    await client.request("scene.get", {}, longest);
    waits.push(seconds(asked));
    await sleep(100);
  }
  return waits;
}

/// Looks at /healthz every 100 ms until `until` is done. Returns for how long it was not ok [s].
async function unhealthy(server, until) {
  let bad = 0,
    done = false,
    last = performance.now();
  until.finally(() => {
    done = true;
  });
  while (!done) {
    const { status } = await server.get("/healthz");
    if (status !== 200) bad += seconds(last);
    last = performance.now();
    await sleep(100);
  }
  return bad;
}

const server = await Server.start("--log-level", "error");
const one = await Client.connect(server, { session: "big" }),
  other = await Client.connect(server, { session: "big" });
const result = { benchmark: "big_patch", machine: `${cpus()[0].model.trim()}, ${cpus().length} cores`, side };

let begun = performance.now();
const undone = one.refusal("scene.patch", { patch: big, name: "big" });
await sleep(2000);
begun = performance.now();
const undo = await one.request("scene.undo", {}, longest);
result.undone_while_built = { undo_s: rounded(seconds(begun)), applies: undo.applies, code: (await undone).code };

begun = performance.now();
const patched = one.request("scene.patch", { patch: big }, longest);
const bad = unhealthy(server, patched);
await patched;
result.big_patch = { built_s: rounded(seconds(begun)), healthz_not_ok_s: rounded(await bad) };
begun = performance.now();
await one.request("scene.undo", {}, longest);
result.big_patch.undo_s = rounded(seconds(begun));

begun = performance.now();
const patches = Promise.all(
  Array.from({ length: 60 }, (_, i) => one.request("scene.patch", { patch: heavy(i) }, longest)),
);
const waits = await answers(other, patches);
result.heavy_patches = {
  all_s: rounded(seconds(begun)),
  other_asked: waits.length,
  other_waited_median_s: rounded(median(waits)),
  other_waited_most_s: rounded(Math.max(...waits)),
};

for (let i = 0; i < 60; ++i) one.request("scene.patch", { patch: heavy(i) }, longest).catch(() => {});
await sleep(200);
const before = (await other.request("scene.get", {}, longest)).revision;
begun = performance.now();
one.socket.terminate();
await other.request("scene.patch", { patch: { name: "of the other" } }, longest);
result.after_leaving = {
  other_waited_s: rounded(seconds(begun)),
  patches: (await other.request("scene.get", {}, longest)).revision - before - 1,
};

await server.stop();
const text = `${JSON.stringify(result, null, 2)}\n`;
process.stdout.write(text);
if (out) writeFileSync(out, text);
