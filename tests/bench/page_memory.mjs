// Whether the page's memory stays flat: a page at work for half an hour beside the server, in a headless Chromium with
// software WebGL: its timeline runs, the cloth is pulled, coloured and looked into, and parameters change. By hand:
//   CLOTHLAB=build/release/clothlab node tests/bench/page_memory.mjs [MINUTES] [--out FILE]
// Each minute it writes the JavaScript heap after a collection and the resident memory of the page's process and of the
// browser's graphics process [MB]; at the end how much each grows an hour after the first five minutes, in which the
// timeline fills (least squares).
import { readFileSync } from "node:fs";
import { writeFile } from "node:fs/promises";
import { cpus } from "node:os";
import { launch, Viewer } from "../browser/browser.mjs";
import { Client, Server } from "../protocol/harness.mjs";

const args = process.argv.slice(2);
const minutes = /^\d+$/.test(args[0] ?? "") ? Number(args.shift()) : 30;
const out = args[0] === "--out" ? args[1] : null;
const settled = 5; // minutes

const server = await Server.start();
const browser = await launch();
const viewer = await Viewer.open(browser, server, { width: 1280, height: 800 });
const client = await Client.connect(server);
const { page } = viewer;
const ofPage = await page.context().newCDPSession(page);
await ofPage.send("Performance.enable");
const ofBrowser = await browser.newBrowserCDPSession();

/// Resident memory of a process [MB].
const resident = (pid) => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, "utf8"))[1]) / 1024;

async function sample() {
  await ofPage.send("HeapProfiler.collectGarbage");
  const { metrics } = await ofPage.send("Performance.getMetrics");
  const metric = (name) => metrics.find((one) => one.name === name).value;
  const { processInfo } = await ofBrowser.send("SystemInfo.getProcessInfo");
  const largest = (type) => Math.max(...processInfo.filter((one) => one.type === type).map(({ id }) => resident(id)));
  return {
    heap: metric("JSHeapUsedSize") / 2 ** 20,
    page: largest("renderer"),
    graphics: largest("GPU"),
    elements: metric("Nodes"),
    listeners: metric("JSEventListeners"),
  };
}

/// What a person does in about ten seconds.
async function work(round) {
  const { mouse, keyboard } = page;
  await mouse.move(640, 400);
  await mouse.down();
  await mouse.move(640 + 80 * Math.sin(round), 400 + 60 * Math.cos(round), { steps: 10 });
  await mouse.up();
  await client.request("scene.patch", {
    patch: [{ op: "replace", path: "/cloths/0/material/structural", value: 8000 + 50 * (round % 20) }],
  });
  if (round % 6 === 3) await keyboard.press("i"); // looks inside, and no longer
  if (round % 30 === 10) await client.request("scene.load", { preset: round % 60 === 10 ? "flag" : "seed" });
  await page.waitForTimeout(8000);
}

const rows = [];
const start = Date.now();
for (let round = 0; ; ++round) {
  await work(round);
  const minute = (Date.now() - start) / 60_000;
  if (minute < rows.length + 1) continue;
  rows.push({ minute, ...(await sample()) });
  const last = rows.at(-1);
  console.log(
    Object.entries(last)
      .map(([key, value]) => `${key} ${value.toFixed(1)}`)
      .join("  "),
  );
  if (minute >= minutes) break;
}

/// Growth an hour after the page has settled.
function growth(key) {
  const late = rows.filter(({ minute }) => minute > settled);
  const mean = (of) => late.reduce((sum, row) => sum + of(row), 0) / late.length;
  const [x, y] = [mean((row) => row.minute), mean((row) => row[key])];
  const slope = mean((row) => (row.minute - x) * (row[key] - y)) / mean((row) => (row.minute - x) ** 2);
  return Number((60 * slope).toFixed(1));
}
const keys = ["heap", "page", "graphics", "elements", "listeners"];
const result = {
  machine: `${cpus()[0].model}, ${cpus().length} cores`,
  minutes,
  frames: await viewer.read("framesDrawn"),
  last: Object.fromEntries(keys.map((key) => [key, Number(rows.at(-1)[key].toFixed(1))])),
  growth_per_hour: Object.fromEntries(keys.map((key) => [key, growth(key)])),
  complaints: viewer.complaints,
};
console.log(JSON.stringify(result, null, 2));
if (out) await writeFile(out, `${JSON.stringify({ ...result, rows }, null, 1)}\n`);
await client.close();
await browser.close();
await server.stop();
