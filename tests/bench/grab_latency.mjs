// Latency of a pull: from the mouse's event to the first picture that shows the held vertex moved, on the seed with its
// pins still, in a headless Chromium with software WebGL beside the server. By hand, on a quiet machine:
//   CLOTHLAB=build/release/clothlab node tests/bench/grab_latency.mjs [--out FILE]
import { writeFile } from "node:fs/promises";
import { cpus, loadavg } from "node:os";
import { launch, Viewer } from "../browser/browser.mjs";
import { Client, Server } from "../protocol/harness.mjs";

const args = process.argv.slice(2);
const out = args[0] === "--out" ? args[1] : null;
const load = loadavg()[0]; // of other processes: if it is not near 0, every time below is wrong
const pulls = 30;
const moved = 0.005; // [m]: the cloth at rest moves less between two pictures

const server = await Server.start();
const client = await Client.connect(server);
await client.request("scene.patch", {
  patch: [0, 1].map((pin) => ({ op: "replace", path: `/cloths/0/pins/${pin}/motion`, value: null })),
});
const browser = await launch();
const viewer = await Viewer.open(browser, server, { width: 1280, height: 800 });
const { page } = viewer;
await page.waitForTimeout(10_000); // the swing dies down, the resolution settles

const middle = await page.evaluate(() => {
  const { stage, lastFrame } = window.clothlab;
  const { boxMinimum: low, boxExtent: extent } = lastFrame.header;
  const at = stage.controls.target.clone();
  at.set(low[0] + extent[0] / 2, low[1] + extent[1] * 0.3, low[2] + extent[2] / 2).project(stage.camera);
  return { x: ((at.x + 1) / 2) * innerWidth, y: ((1 - at.y) / 2) * innerHeight };
});
await page.mouse.move(middle.x, middle.y);
await page.mouse.down();
const { hands } = await client.nextNotification("sim.status", (status) => status.hands.length === 1);
const { vertex } = hands[0];

/// Resolves with the time from the next pointermove to the first picture with the vertex moved [ms].
const watch = () =>
  page.evaluate(
    ([index, least]) =>
      new Promise((resolve) => {
        const place = () => {
          const { header, buffer } = window.clothlab.lastFrame;
          const words = new Uint16Array(buffer, 64 + 8 * index, 3);
          return [0, 1, 2].map((k) => header.boxMinimum[k] + (header.boxExtent[k] * words[k]) / 65535);
        };
        let began = 0;
        let before = null;
        addEventListener(
          "pointermove",
          (event) => {
            began = event.timeStamp;
            before = place();
          },
          { once: true, capture: true },
        );
        const look = () => {
          const now = place();
          if (before && Math.hypot(...now.map((value, k) => value - before[k])) > least)
            return resolve(performance.now() - began);
          requestAnimationFrame(look); // after the page's own, which has drawn by then
        };
        requestAnimationFrame(look);
        window.watching = true;
      }),
    [vertex, moved],
  );

const times = [];
for (let i = 0; i < pulls; ++i) {
  await page.waitForTimeout(1200); // the last pull has come to rest
  const seen = watch();
  await page.waitForFunction(() => window.watching);
  await page.mouse.move(middle.x + (i % 2 === 0 ? 120 : 0), middle.y);
  times.push(await seen);
}
const sorted = [...times].sort((a, b) => a - b);
const at = (share) => Number(sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))].toFixed(1));
const result = {
  machine: `${cpus()[0].model}, ${cpus().length} cores`,
  load_before: Number(load.toFixed(2)),
  browser: `Chromium ${browser.version()}, headless, SwiftShader`,
  frames_drawn: await viewer.read("framesDrawn"),
  pulls,
  latency_ms: { least: at(0), median: at(0.5), nine_of_ten: at(0.9), most: at(1) },
};
const text = JSON.stringify(result, null, 2);
console.log(text);
if (out) await writeFile(out, text + "\n");
await page.mouse.up();
await client.close();
await browser.close();
await server.stop();
