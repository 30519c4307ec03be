// Cost of the page: bytes, time to the first frame, frames/s drawn in a headless Chromium with software WebGL, and the
// main thread's time for a frame of a large cloth. By hand, on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/page.mjs [SECONDS] [--out FILE] [--trace FILE]
// --trace writes what Chromium did until the first frame, for ui.perfetto.dev or chrome://tracing.
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { writeFile } from "node:fs/promises";
import { cpus, loadavg } from "node:os";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { gzipSync } from "node:zlib";
import { launch, Viewer } from "../browser/browser.mjs";
import { Client, Server } from "../protocol/harness.mjs";
import { fineDrape } from "./scenes.mjs";
import { median } from "../median.mjs";

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: { out: { type: "string" }, trace: { type: "string" } },
});
const seconds = Number(positionals[0] ?? 10);
const load = loadavg()[0]; // of other processes: if it is not near 0, every time below is wrong

const dist = fileURLToPath(new URL("../../web/dist/", import.meta.url));
const names = readdirSync(dist).filter((name) => !name.endsWith(".br"));
const sizes = (size) => {
  const bytes = Object.fromEntries(names.map((name) => [name, size(name)]));
  return { total: Object.values(bytes).reduce((sum, each) => sum + each, 0), ...bytes };
};
const bytes = (name) => readFileSync(dist + name);

const server = await Server.start();
const browser = await launch();

// A visitor who has never been here: each page has a cache of its own. The first load also starts the browser's
// graphics process, which a person's browser runs already.
const newcomers = [];
for (let i = 0; i < 6; ++i) {
  const viewer = await Viewer.open(browser, server, { width: 1280, height: 800, drawn: 1 });
  newcomers.push(Math.round(await viewer.read("firstFrameAt")));
  await viewer.page.close();
}

// A visitor who comes back: the page and its compiled code are in the browser's cache.
const returning = [];
const again = await Viewer.open(browser, server, { width: 1280, height: 800, drawn: 1 });
for (let i = 0; i < 10; ++i) {
  const traced = values.trace && i === 9;
  if (traced) await browser.startTracing(again.page, { path: values.trace, categories: traceCategories() });
  await again.page.goto(again.page.url());
  await again.until(() => window.clothlab?.framesDrawn >= 1);
  if (traced) await browser.stopTracing();
  returning.push(Math.round(await again.read("firstFrameAt")));
}
await again.page.close();

function traceCategories() {
  return ["devtools.timeline", "disabled-by-default-devtools.timeline", "v8", "loading", "toplevel", "gpu", "viz"];
}

/// [ms] of the main thread for each frame of a cloth that is not drawn: WebGL's calls to draw do nothing.
async function mainThread(side) {
  const session = `large-${side}`;
  const client = await Client.connect(server, { session });
  await client.request("scene.load", { scene: fineDrape(side) });
  const viewer = await Viewer.open(browser, server, { session, width: 1280, height: 800 });
  await viewer.page.evaluate(() => {
    for (const name of ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"])
      WebGL2RenderingContext.prototype[name] = () => {};
  });
  const devtools = await viewer.page.context().newCDPSession(viewer.page);
  await devtools.send("Performance.enable");
  const read = async () => {
    const { metrics } = await devtools.send("Performance.getMetrics");
    const value = (wanted) => metrics.find(({ name }) => name === wanted).value;
    const layout = value("LayoutDuration") + value("RecalcStyleDuration");
    return {
      script: value("ScriptDuration"),
      layout,
      all: value("TaskDuration"),
      frames: await viewer.read("framesDrawn"),
    };
  };
  await viewer.page.waitForTimeout(4000);
  const before = await read();
  await viewer.page.waitForTimeout(seconds * 1000);
  const after = await read();
  await viewer.page.close();
  await client.close();
  const frames = after.frames - before.frames;
  const each = (key) => Number(((1000 * (after[key] - before[key])) / frames).toFixed(2));
  const drawn_per_s = Number((frames / seconds).toFixed(1));
  return {
    grid: `${side}x${side}`,
    drawn_per_s,
    script_ms: each("script"),
    layout_ms: each("layout"),
    tasks_ms: each("all"),
  };
}

async function rates(width, height) {
  const viewer = await Viewer.open(browser, server, { width, height });
  await viewer.page.waitForTimeout(4000); // the resolution settles
  const count = () =>
    viewer.page.evaluate(() => {
      const { framesDrawn: drawn, framesReceived: received } = window.clothlab;
      return { at: performance.now(), drawn, received };
    });
  const before = await count();
  await viewer.page.waitForTimeout(seconds * 1000);
  const after = await count();
  const per = (key) => Number(((1000 * (after[key] - before[key])) / (after.at - before.at)).toFixed(1));
  const scale = await viewer.page.evaluate(() => window.clothlab.stage.scale);
  const latency = await viewer.page.locator("#stats div", { hasText: "Latency" }).locator("dd").innerText();
  await viewer.page.close();
  return {
    window: `${width}x${height}`,
    drawn_per_s: per("drawn"),
    received_per_s: per("received"),
    resolution_scale: scale,
    latency,
  };
}

const frameRates = [await rates(1280, 800), await rates(360, 740)];
const result = {
  machine: `${cpus()[0].model}, ${cpus().length} cores`,
  load_before: Number(load.toFixed(2)),
  browser: `Chromium ${browser.version()}, headless, SwiftShader`,
  page_bytes_gzip: sizes((name) => gzipSync(bytes(name), { level: 9 }).length),
  page_bytes_brotli: sizes((name) => bytes(existsSync(`${dist}${name}.br`) ? `${name}.br` : name).length),
  first_frame_ms: {
    first: newcomers[0],
    newcomer_median: median(newcomers.slice(1)),
    newcomers: newcomers.slice(1),
    cached_median: median(returning),
    cached: returning,
  },
  frames: frameRates,
  main_thread_per_frame: [await mainThread(29), await mainThread(256)],
};
const text = JSON.stringify(result, null, 2);
console.log(text);
if (values.out) await writeFile(values.out, text + "\n");
await browser.close();
await server.stop();
