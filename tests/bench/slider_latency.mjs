// Latency of the panel's sliders: from the key that moves one to the first picture of a cloth that is stepped with the
// new value, and the pictures a second while a slider is moved all the time, on the seed, in a headless Chromium with
// software WebGL beside the server. By hand, on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/slider_latency.mjs [--out FILE]
import { writeFile } from "node:fs/promises";
import { cpus, loadavg } from "node:os";
import { launch, Viewer } from "../browser/browser.mjs";
import { Server } from "../protocol/harness.mjs";

const args = process.argv.slice(2);
const out = args[0] === "--out" ? args[1] : null;
const load = loadavg()[0]; // of other processes: if it is not near 0, every time below is wrong
const presses = 12; // of each slider
const sliders = [
  ["World", "gravity y"],
  ["World", "air drag"],
  ["Cloth", "structural"],
  ["Cloth", "damping"],
  ["Cloth", "mass"],
  ["Solver", "time step"],
];

const server = await Server.start();
const browser = await launch();
const viewer = await Viewer.open(browser, server, { width: 1280, height: 800, sharp: true });
const { page } = viewer;
await page.waitForTimeout(5000); // the resolution settles

/// Resolves with the time from the next key to the first picture that comes after the server has taken the value [ms].
const watch = () =>
  page.evaluate(
    () =>
      new Promise((resolve) => {
        let began = 0;
        const before = window.clothlab.document;
        addEventListener("keydown", (event) => (began = event.timeStamp), { once: true, capture: true });
        let sequence = null; // of the last frame when the value was taken
        const look = () => {
          const { document: now, lastFrame } = window.clothlab;
          if (sequence !== null && lastFrame.header.sequence > sequence) return resolve(performance.now() - began);
          if (now !== before) sequence ??= lastFrame.header.sequence;
          requestAnimationFrame(look); // after the page's own, which has drawn by then
        };
        requestAnimationFrame(look);
        window.watching = true;
      }),
  );

const spread = (times) => {
  const sorted = [...times].sort((a, b) => a - b);
  const at = (share) => Number(sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))].toFixed(1));
  return { least: at(0), median: at(0.5), nine_of_ten: at(0.9), most: at(1) };
};

const latency = {};
for (const [section, name] of sliders) {
  const slider = await viewer.slider(section, name);
  await slider.focus();
  const times = [];
  for (let i = 0; i < presses; ++i) {
    await page.evaluate(() => (window.watching = false));
    const seen = watch();
    await page.waitForFunction(() => window.watching);
    await page.keyboard.press(i % 2 === 0 ? "ArrowRight" : "ArrowLeft");
    times.push(await seen);
    await page.waitForTimeout(200);
  }
  latency[name] = spread(times);
}

const seconds = 5;
const gravity = await viewer.slider("World", "gravity y");
await gravity.focus();
const drawn = await viewer.read("framesDrawn");
const begun = performance.now();
for (let i = 0; performance.now() - begun < 1000 * seconds; ++i) {
  await page.keyboard.press(i % 40 < 20 ? "ArrowRight" : "ArrowLeft");
  await page.waitForTimeout(33);
}
const pictures = ((await viewer.read("framesDrawn")) - drawn) / ((performance.now() - begun) / 1000);

const result = {
  machine: `${cpus()[0].model}, ${cpus().length} cores`,
  load_before: Number(load.toFixed(2)),
  browser: `Chromium ${browser.version()}, headless, SwiftShader`,
  latency_ms: latency,
  pictures_a_second_while_moved: Number(pictures.toFixed(1)),
};
const text = JSON.stringify(result, null, 2);
console.log(text);
if (out) await writeFile(out, text + "\n");
await browser.close();
await server.stop();
process.exit(0);
