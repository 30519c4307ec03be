// All presets as somebody sees them who opens them, in one picture: on a desktop, on a phone, and dark. To be looked
// at by a person, by hand:
//   CLOTHLAB=build/release/clothlab node tests/browser/all_presets.mjs OUT.png [PRESET...]
import { mkdirSync, readdirSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { Client, Server } from "../protocol/harness.mjs";
import { launch, Viewer } from "./browser.mjs";

const [out, ...chosen] = process.argv.slice(2);
if (!out) throw new Error("which file? node tests/browser/all_presets.mjs OUT.png [PRESET...]");
const folder = new URL("../../server/scene/presets/", import.meta.url);
const known = readdirSync(folder).filter((name) => name.endsWith(".json"));
const presets = chosen.length > 0 ? chosen : known.map((name) => name.slice(0, -".json".length));
const seconds = 1.2; // simulated, the moment of most of the gallery's pictures
const diverged = -32004; // the code of the answer to a step of what has blown up
const looks = [
  { name: "desktop", width: 1440, height: 900, colorScheme: "light" },
  { name: "phone", width: 390, height: 844, colorScheme: "light", hasTouch: true },
  { name: "dark", width: 1440, height: 900, colorScheme: "dark" },
];

const server = await Server.start("--max-sessions", "32");
const browser = await launch();
mkdirSync(dirname(out), { recursive: true });

/// What a window of this look shows of the preset, as PNG. The panel is open or closed as the window's size asks.
async function look(preset, { name, ...options }) {
  const session = `${preset}-${name}`;
  const client = await Client.connect(server, { session });
  await client.request("scene.load", { preset });
  await client.request("sim.pause");
  const { document } = await client.request("scene.get", {});
  const blown = await client.request("sim.step", { steps: Math.round(seconds / document.solver.dt) }).then(
    () => false,
    ({ code }) => code === diverged,
  );
  const viewer = await Viewer.open(browser, server, { session, drawn: 1, sharp: true, newcomer: true, ...options });
  if (!blown) await viewer.until((time) => window.clothlab.simTime >= time, 0.9 * seconds);
  await viewer.still();
  const png = await viewer.page.screenshot();
  await viewer.page.close();
  await client.close();
  return png;
}

const tile = 240; // the height of a picture [pixels]
const rows = [];
for (const preset of presets) {
  const pictures = [];
  for (const each of looks) {
    const png = await look(preset, each);
    writeFileSync(out.replace(/(\.png)?$/, `-${preset}-${each.name}.png`), png);
    pictures.push(`<img height="${tile}" src="data:image/png;base64,${png.toString("base64")}">`);
  }
  rows.push(`<figure><figcaption>${preset}</figcaption>${pictures.join("")}</figure>`);
  console.log(preset);
}
const page = await browser.newPage({ viewport: { width: 2800, height: tile } });
const style = `body { margin: 8px; display: grid; grid-template-columns: repeat(3, 1fr); font: 16px sans-serif; white-space: nowrap }
  figure { margin: 4px } img { margin-right: 6px }`;
await page.setContent(`<style>${style}</style>${rows.join("")}`);
await page.screenshot({ path: out, fullPage: true });
await browser.close();
await server.stop();
