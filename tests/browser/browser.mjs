// Chromium with the page, and what tests read from the page: pixels, positions, controls.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { Client, patience, Server } from "../protocol/harness.mjs";
import { browser, executablePath } from "./chromium.mjs";

// With CLOTHLAB_BROWSER_TESTS=first only the first test of each file runs, the one of its main path: as pictures are
// drawn in software, all of them take half an hour.
const onlyFirst = process.env.CLOTHLAB_BROWSER_TESTS === "first";
let declared = 0; // tests of this file so far

/// A test that needs a browser. It is skipped, with a message, if there is none or it is not asked for. `body` gets
/// the context of the test.
export function browserTest(name, body) {
  declared += 1;
  if (onlyFirst && declared > 1) return;
  const skip = executablePath ? false : "no Chromium here: install chromium, or name one in CLOTHLAB_BROWSER";
  test(name, { skip, timeout: 600_000 }, async (t) => {
    try {
      await body(t);
    } catch (error) {
      for (const page of (running?.contexts() ?? []).flatMap((context) => context.pages()))
        t.diagnostic(`${page.url()}: ${await stateOf(page)}`);
      throw error;
    } finally {
      // pages left open would go on drawing
      await Promise.all((running?.contexts() ?? []).map((context) => context.close()));
    }
  });
}

/// How far the page has come, as text: what helps to find out why a test has failed that passes alone.
async function stateOf(page) {
  const state = () => {
    const { framesReceived, framesDrawn, lastFrame, simTime } = window.clothlab ?? {};
    const { sequence, topologyRevision, range } = lastFrame?.header ?? {};
    const drawing = new Promise((resolve) => {
      requestAnimationFrame(() => resolve("drawing"));
      setTimeout(() => resolve("no animation frame in 5 s"), 5000);
    });
    const notices = [...document.querySelectorAll("#notices > *")].map((notice) => notice.textContent.trim());
    return drawing.then((draws) =>
      JSON.stringify({
        draws,
        visibility: document.visibilityState,
        link: document.getElementById("link")?.textContent.trim(),
        notices,
        ...{ framesReceived, framesDrawn, simTime, sequence, topologyRevision, range },
      }),
    );
  };
  const late = new Promise((resolve) => setTimeout(() => resolve("does not answer"), 20_000).unref());
  return Promise.race([page.evaluate(state).catch((error) => error.message), late]);
}

/// Reads repeatedly until `good` accepts the value, for at most `milliseconds`.
export async function eventually(what, read, good, milliseconds = patience) {
  const until = Date.now() + milliseconds;
  for (;;) {
    const value = await read();
    if (good(value)) return value;
    assert.ok(Date.now() < until, `${what}: still ${JSON.stringify(value)}`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

/// Waits until what a press has changed is laid out, and what slides or fades has arrived.
export const arrived = (page) =>
  page.evaluate(async () => {
    const drawn = () => new Promise(requestAnimationFrame);
    for (let picture = 0; picture < 2; ++picture) await drawn();
    const ending = document.getAnimations().filter(({ effect }) => Number.isFinite(effect.getComputedTiming().endTime));
    await Promise.allSettled(ending.map(({ finished }) => finished));
    await drawn();
  });

/// The bytes of a file that the page has saved. The browser may be another process's (chromium.mjs), so that the file
/// has no path here.
export async function bytesOf(download) {
  const parts = [];
  for await (const part of await download.createReadStream()) parts.push(part);
  return Buffer.concat(parts);
}

export const screenshots = fileURLToPath(new URL("../../build/screenshots/", import.meta.url));
mkdirSync(screenshots, { recursive: true });

let running = null;

/// The browser; null if there is none.
export async function launch() {
  if (!executablePath) return null;
  running = await browser();
  // Also pages that a test opens itself wait as long as a busy machine needs.
  const newContext = running.newContext.bind(running);
  running.newContext = async (options) => {
    const context = await newContext(options);
    context.setDefaultTimeout(patience);
    return context;
  };
  return running;
}

/// Gives a file's tests a browser, which closes after them.
export function withBrowser() {
  const here = {
    browser: null,
    open: (server, options) => Viewer.open(here.browser, server, options),
  };
  before(async () => {
    here.browser = await launch();
  });
  after(() => here.browser?.close());
  return here;
}

/// Gives a file's tests a browser and a server, which both stop after them.
export function withServer(...args) {
  const browser = withBrowser();
  const here = {
    server: null,
    /// `options.server`: a server other than the file's.
    open: (options = {}) => browser.open(options.server ?? here.server, options),
    /// A page and a script on the same session, and a function that reads the server's scene. `paused`: the cloth
    /// stands still, as its steps take the time that the page needs.
    async both(session, { paused = false, ...options } = {}) {
      const viewer = await here.open({ session, width: 1280, height: 800, ...options });
      const client = await Client.connect(options.server ?? here.server, { session });
      if (paused) await client.request("sim.pause");
      return { viewer, client, scene: async () => (await client.request("scene.get", {})).document };
    },
  };
  before(async () => {
    here.server = await Server.start("--max-sessions", "16", ...args);
  });
  after(() => here.server?.stop());
  return here;
}

export class Viewer {
  /// Opens the page on a session of its own, and waits until it has drawn. Pixels in software take most of the time
  /// of these tests: unless the picture must be `sharp`, there is one for every 4x4 of the layout's. A `newcomer` has
  /// never been here; `session` null: the address names none; `more` are options of Playwright's contexts, such as
  /// hasTouch.
  static async open(
    browser,
    server,
    {
      session = "main",
      width = 900,
      height = 600,
      colorScheme = "light",
      drawn = 3,
      sharp = false,
      newcomer = false,
      ...more
    } = {},
  ) {
    const viewer = new Viewer();
    const deviceScaleFactor = sharp ? 1 : 0.25;
    viewer.page = await browser.newPage({ viewport: { width, height }, deviceScaleFactor, colorScheme, ...more });
    // The card of the first minute is for the tests that ask for it. The panel is open for all others, whatever the
    // window's size.
    if (!newcomer)
      await viewer.page.addInitScript(() => {
        localStorage.setItem("clothlab-first-steps", "seen");
        localStorage.getItem("clothlab-panel") ?? localStorage.setItem("clothlab-panel", "open");
      });
    viewer.complaints = [];
    viewer.page.on("console", (message) => {
      if (["error", "warning"].includes(message.type())) viewer.complaints.push(message.text());
    });
    viewer.page.on("pageerror", (error) => viewer.complaints.push(error.message));
    await viewer.page.goto(`http://${server.host}/${session === null ? "" : `?session=${session}`}`);
    if (drawn > 0) await viewer.until((count) => window.clothlab?.framesDrawn >= count, drawn);
    return viewer;
  }

  until(condition, argument) {
    return this.page.waitForFunction(condition, argument, { timeout: patience });
  }

  /// Waits for the picture at rest, which is drawn at full resolution.
  still() {
    return this.until(() => window.clothlab.stage.still);
  }

  /// Stops the page's session by its key, and waits until the picture is at rest.
  async pause() {
    await this.page.keyboard.press(" ");
    await this.page.getByRole("button", { name: "Play", exact: true }).waitFor({ state: "attached" });
    await this.still();
  }

  /// Opens the card of figures, whose headline alone is seen before.
  figures() {
    return this.page.locator("#figures > summary").click();
  }

  read(name) {
    return this.page.evaluate((key) => window.clothlab[key], name);
  }

  input(type, section, label) {
    const folder = this.page.locator(`.lil-gui:has(> .lil-title:text-is("${section}")) > .lil-children`);
    return folder.locator(`input[type=${type}][aria-label^="${label}"]`).first();
  }

  /// The range input of a parameter; its folder is opened if it is closed.
  async slider(section, label) {
    const range = this.input("range", section, label);
    // A parameter that the server has yet to tell of is not there in an open folder either: wait for it first.
    await range.waitFor({ state: "attached" });
    const closed = this.page.locator(`.lil-gui.lil-closed > .lil-title:text-is("${section}")`).first();
    if ((await closed.count()) > 0) await closed.click();
    await range.waitFor({ state: "visible" });
    return range;
  }

  /// The number beside a slider.
  number(section, label) {
    return this.input("text", section, label);
  }

  /// Vertex positions [m] of the frame on screen, decoded here from the uploaded bytes.
  positions() {
    return this.page.evaluate(() => {
      const { header, buffer } = window.clothlab.lastFrame;
      const words = new Uint16Array(buffer, 64, header.vertexCount * 4);
      return Array.from({ length: header.vertexCount }, (_, i) =>
        [0, 1, 2].map((axis) => header.boxMinimum[axis] + (header.boxExtent[axis] * words[4 * i + axis]) / 65535),
      );
    });
  }

  /// Pixels of the cloth's red in a screenshot: their share, their middle and a checksum.
  async cloth() {
    const png = (await this.page.screenshot()).toString("base64");
    const helper = await this.page.context().browser().newPage();
    try {
      return await helper.evaluate(countRed, png);
    } finally {
      await helper.close();
    }
  }
}

/// Pixels of the cloth's red in a picture of the window (a PNG in base64). Runs in a blank page, whose browser decodes
/// it.
export async function countRed(png) {
  const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
  const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
  context.drawImage(image, 0, 0);
  // Only the middle of the window: it has no panel and no red button.
  const left = Math.round(image.width * 0.26),
    width = Math.round(image.width * 0.4),
    height = Math.round(image.height * 0.86);
  const { data } = context.getImageData(left, 0, width, height);
  let count = 0,
    sumX = 0,
    sumY = 0,
    checksum = 0;
  const shades = new Set();
  for (let i = 0; i < data.length; i += 4) {
    const [r, g, b] = [data[i], data[i + 1], data[i + 2]];
    if (r < 60 || r < 1.6 * g || r < 1.6 * b) continue;
    const pixel = i / 4;
    count++;
    sumX += pixel % width;
    sumY += Math.floor(pixel / width);
    checksum = (Math.imul(checksum, 31) + pixel + r) | 0;
    shades.add((r << 16) | (g << 8) | b);
  }
  return { count, share: count / (width * height), x: sumX / count, y: sumY / count, shades: shades.size, checksum };
}
