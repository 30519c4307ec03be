// The moving pictures of the README, web/fold.webp and web/blowup.webp, made anew from a recording and from the show of
// a blow-up. By hand; needs Chromium and img2webp (Debian's package webp):
//   CLOTHLAB=build/release/clothlab node tests/browser/moving_pictures.mjs [fold|blowup]...
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { Client, runProgram, Server } from "../protocol/harness.mjs";
import { launch, Viewer } from "./browser.mjs";

const most = 1.5e6; // of a picture [bytes]
const web = fileURLToPath(new URL("../../web/", import.meta.url));
const folder = mkdtempSync(join(tmpdir(), "clothlab-pictures-"));
const browser = await launch();

/// Takes a film's pictures one by one, each for so long [ms], and joins them.
class Film {
  constructor(name, page) {
    this.name = name;
    this.page = page;
    this.parts = [];
  }

  async take(milliseconds) {
    const file = join(folder, `${this.name}-${this.parts.length}.png`);
    await this.page.waitForFunction(() => window.clothlab.stage.still, null, { timeout: 120_000 });
    await this.page.screenshot({ path: file });
    this.parts.push({ file, milliseconds });
  }

  join() {
    const out = `${web}${this.name}.webp`;
    const frames = this.parts.flatMap(({ file, milliseconds }) => ["-d", String(milliseconds), file]);
    execFileSync("img2webp", ["-loop", "0", "-lossy", "-q", "80", "-m", "6", ...frames, "-o", out]);
    const { size } = statSync(out);
    console.log(`${out}: ${this.parts.length} pictures, ${size} bytes`);
    if (size > most) throw new Error(`${out} has more than ${most} bytes`);
  }
}

/// Garments that fall on a body and fold, from a recording's page.
async function fold() {
  const rate = 20;
  const html = join(folder, "fold.html");
  const { code, stderr } = await runProgram(`record mannequin --time 2 --rate ${rate} --out ${html}`.split(" "));
  if (code !== 0) throw new Error(stderr);
  const page = await browser.newPage({ viewport: { width: 480, height: 600 }, reducedMotion: "reduce" });
  await page.goto(`file://${html}`);
  await page.addStyleTag({ content: "#bar, #about { display: none }" });
  await page.waitForFunction(() => document.body.classList.contains("drawing"));
  const film = new Film("fold", page);
  const slider = page.locator("#frame");
  const last = Number(await slider.getAttribute("max"));
  for (let frame = 0; frame <= last; ++frame) {
    await slider.evaluate((range, value) => {
      range.value = String(value);
      range.dispatchEvent(new Event("input"));
    }, frame);
    await film.take(frame === last ? 1500 : 1000 / rate);
  }
  film.join();
}

/// A step beyond the limit, as the page's first minute shows it; then its remedy, and the same scene stands.
async function blowUp() {
  const server = await Server.start();
  const client = await Client.connect(server);
  await client.request("scene.load", { preset: "drape" });
  await client.request("sim.pause");
  await client.request("sim.step", { steps: 700 });
  const asked = { newcomer: true, sharp: true, reducedMotion: "reduce" }; // who wishes less motion steps by hand
  const viewer = await Viewer.open(browser, server, { width: 960, height: 640, drawn: 1, ...asked });
  const { page } = viewer;
  const film = new Film("blowup", page);
  await page.getByRole("button", { name: "Make it blow up" }).click();
  const show = page.getByRole("region", { name: "How it blows up" });
  const moment = show.getByRole("slider", { name: "Moment of the blow-up" });
  await moment.waitFor();
  await moment.press("Home");
  const last = Number(await moment.getAttribute("max"));
  for (let at = 0; at <= last; ++at) {
    await page.evaluate(() => document.activeElement.blur());
    await film.take(at === last ? 2000 : 1000 / 12);
    await moment.press("ArrowRight");
  }
  await show.getByRole("button", { name: "Apply the remedy" }).click();
  await show.waitFor({ state: "detached" });
  await client.request("sim.pause");
  for (let picture = 0; picture < 30; ++picture) {
    const { solver } = (await client.request("scene.get", {})).document;
    const { step } = await client.request("sim.step", { steps: Math.round(1 / 20 / solver.dt) });
    await viewer.until((of) => window.clothlab.step >= of, step);
    await film.take(picture === 29 ? 1500 : 50);
  }
  film.join();
  await client.close();
  await server.stop();
}

const films = { fold, blowup: blowUp };
const chosen = process.argv.slice(2);
try {
  for (const name of chosen.length > 0 ? chosen : Object.keys(films)) await films[name]();
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
