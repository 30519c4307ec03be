// What the finer mesh of the page costs: the main thread's time for a frame, and the whole time until it is drawn, with
// the mesh and with the simulated triangles alone, in a headless Chromium with software WebGL. By hand:
//   CLOTHLAB=build/release/clothlab node tests/bench/drawing.mjs [PRESET]...
import { cpus, loadavg } from "node:os";
import { launch, Viewer } from "../browser/browser.mjs";
import { Client, Server } from "../protocol/harness.mjs";

const presets = process.argv.length > 2 ? process.argv.slice(2) : ["seed", "mannequin"];
const load = loadavg()[0]; // of other processes: if it is not near 0, the times are too long
const server = await Server.start();
const browser = await launch();

/// Medians of drawing the frame on screen again, in turns [ms].
function measure() {
  const { stage } = window.clothlab;
  const gl = stage.canvas.getContext("webgl2");
  const { frame } = stage;
  const times = { finer: [], simulated: [] };
  const pixel = new Uint8Array(4);
  const drawn = () => gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // waits for the picture
  for (let round = 0; round < 42; ++round)
    for (const mode of ["finer", "simulated"]) {
      stage.showsMesh = mode === "simulated";
      drawn();
      const begun = performance.now();
      stage.show(frame);
      stage.draw();
      const left = performance.now();
      drawn();
      if (round >= 2) times[mode].push([left - begun, performance.now() - begun]); // two compile
    }
  stage.showsMesh = false;
  const median = (of) => Number([...of].sort((a, b) => a - b)[of.length >> 1].toFixed(1));
  return Object.fromEntries(
    Object.entries(times).map(([mode, all]) => [
      mode,
      { main_thread_ms: median(all.map(([thread]) => thread)), drawn_ms: median(all.map(([, whole]) => whole)) },
    ]),
  );
}

const results = {};
for (const preset of presets) {
  const client = await Client.connect(server, { session: preset });
  await client.request("scene.load", { preset });
  const viewer = await Viewer.open(browser, server, { session: preset, width: 1280, height: 800, sharp: true });
  await client.request("sim.pause");
  await viewer.still();
  results[preset] = await viewer.page.evaluate(measure);
  await viewer.page.close();
  await client.close();
}
const machine = `${cpus()[0].model.trim()}, ${cpus().length} cores`;
console.log(JSON.stringify({ machine, load_before: load, window: "1280x800", results }, null, 2));
await browser.close();
await server.stop();
