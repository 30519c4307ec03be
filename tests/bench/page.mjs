// Cost of the page: bytes, time to the first frame, frames/s drawn in a headless Chromium with software WebGL.
// By hand, on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/page.mjs [SECONDS] [--out FILE]
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { writeFile } from "node:fs/promises";
import { cpus, loadavg } from "node:os";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { launch, Viewer } from "../browser/browser.mjs";
import { Server } from "../protocol/harness.mjs";

const args = process.argv.slice(2);
const seconds = /^\d+$/.test(args[0] ?? "") ? Number(args.shift()) : 10;
const out = args[0] === "--out" ? args[1] : null;
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
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

// The first load also starts the browser's graphics process, which a person's browser runs already.
const firstFrames = [];
for (let i = 0; i < 6; ++i) {
  const viewer = await Viewer.open(browser, server, { width: 1280, height: 800, drawn: 1 });
  firstFrames.push(Math.round(await viewer.read("firstFrameAt")));
  await viewer.page.close();
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
  first_frame_ms: { cold: firstFrames[0], warm_median: median(firstFrames.slice(1)), warm: firstFrames.slice(1) },
  frames: frameRates,
};
const text = JSON.stringify(result, null, 2);
console.log(text);
if (out) await writeFile(out, text + "\n");
await browser.close();
await server.stop();
