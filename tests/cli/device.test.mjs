// tests/device/bundle and the `run` in it, with small sizes, in an empty environment: what a machine with a driver and
// nothing else would do.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { markdown } from "../device/report.mjs";
import { thoroughTest } from "../thorough.mjs";
import { folder } from "./program.mjs";

const here = fileURLToPath(new URL("../device/", import.meta.url));

thoroughTest("the bundle measures this device by its own means, in small sizes, and leaves JSON and Markdown", () => {
  const bundle = join(folder, "bundle");
  const made = spawnSync(join(here, "bundle"), [bundle], { encoding: "utf8" });
  assert.equal(made.status, 0, made.stderr);
  mkdirSync(join(folder, "home"));
  const { status, stdout, stderr } = spawnSync(join(bundle, "run"), ["--small", "--seconds", "400"], {
    encoding: "utf8",
    env: { PATH: "/usr/bin:/bin", HOME: join(folder, "home"), LP_NUM_THREADS: "0" },
  });
  assert.equal(status, 0, stdout + stderr);
  const result = JSON.parse(readFileSync(join(bundle, "results", "device.json"), "utf8"));
  assert.equal(result.selftest_quick.wrong, 0);
  assert.ok(result.hashes.runs.every(({ same }) => same));
  for (const side of [25, 64]) assert.ok(result.methods.rows.some((row) => row.side === side && row.ns > 0));
  assert.equal(new Set(result.methods.rows.map(({ method }) => method)).size, 9, "every method");
  assert.equal(result.surface.rows.length, 3);
  assert.deepEqual([...new Set(result.reads.rows.map(({ choice }) => choice))], ["textures", "storage"]);
  assert.deepEqual([...new Set(result.sweeps.rows.map(({ choice }) => choice))], ["one_group", "dispatches"]);
  assert.ok(result.served.rows[0].frames_a_second > 0 && result.served.rows[0].latency_p95_ms > 0);
  assert.equal(readFileSync(join(bundle, "results", "device.md"), "utf8"), markdown(result));
});

test("a run without a bundle says what makes one", () => {
  assert.ok(!existsSync(join(here, "bin")));
  const { status, stderr } = spawnSync(join(here, "run"), { encoding: "utf8" });
  assert.equal(status, 2);
  assert.match(stderr, /tests\/device\/bundle makes one/);
});

test("the report names each part, what failed and what no time was left for", () => {
  const text = markdown({
    commit: "c0ffee",
    date: "2026-01-02T03:04:05Z",
    processor: "a processor, 2 cores",
    seconds: 7,
    device: { name: "A Card", info: ["* 0: A Card"], bandwidth_gb_s: 1000 },
    hashes: { runs: [{ scene: "seed", method: "vbd", same: false, hashes: ["1", "2", "1"] }] },
    methods: { rows: [{ method: "xpbd", side: 64, iterations: 10, ns: 2, dispatches: 3, gb_s: 500, share: 0.5 }] },
    reads: { left_out: "no time was left" },
    served: { failed: "the server ended with 3" },
  });
  assert.match(text, /^# A Card$/m);
  assert.match(text, /^\| seed \| `vbd` \| DIFFER \| 1, 2 \|$/m);
  assert.match(text, /^\| `xpbd`, 10 sweeps \| 64x64 \| 2 \| 3 \| 500 \| 0\.5 \|$/m);
  assert.match(text, /^left out: no time was left$/m);
  assert.match(text, /^failed: the server ended with 3$/m);
});
