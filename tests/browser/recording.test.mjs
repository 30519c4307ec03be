// What `clothlab record --out F.html` writes, opened from the disk by a browser that has never been here.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before } from "node:test";
import { browserTest, Viewer, withBrowser, screenshots, eventually } from "./browser.mjs";

const here = withBrowser();
const folder = mkdtempSync(join(tmpdir(), "clothlab-recording-"));
after(() => rmSync(folder, { recursive: true, force: true }));
const file = (name) => join(folder, name);
before(() => {
  const record = (...args) => execFileSync(process.env.CLOTHLAB, ["record", ...args], { stdio: "pipe" });
  record("seed", "--time", "3", "--out", file("seed.html"));
  record("mannequin", "--time", "0.2", "--out", file("mannequin.html"));
  const body = { name: "torso", mesh: { obj: "presets/torso.obj" }, transform: { translate: [0, -3, 0] } };
  const cloth = { mesh: { grid: { columns: 8, rows: 8, width: 1, height: 1 } } };
  const scene = { version: 1, name: "above", cloths: [cloth], colliders: [body] };
  writeFileSync(file("above.json"), JSON.stringify(scene));
  record(file("above.json"), "--time", "0.1", "--out", file("above.html"));
});

/// Opens a file in a profile of its own, in which anything that is not in the file itself is noted.
async function open(name, { width = 900, height = 600, ...more } = {}) {
  const viewer = Object.assign(new Viewer(), { complaints: [], asked: [] });
  const context = await here.browser.newContext({ viewport: { width, height }, ...more });
  const page = (viewer.page = await context.newPage());
  page.on("request", (request) => viewer.asked.push(request.url()));
  page.on("console", (message) => message.type() === "error" && viewer.complaints.push(message.text()));
  page.on("pageerror", (error) => viewer.complaints.push(error.message));
  await page.goto(`file://${file(name)}`);
  return viewer;
}
const frame = (viewer) => viewer.page.locator("#frame").inputValue().then(Number);
const playing = (viewer) => viewer.page.evaluate(() => document.body.classList.contains("playing"));
const drawn = (viewer, count) => viewer.until((least) => window.clothlab?.framesDrawn >= least, count);
const camera = (viewer) => viewer.page.evaluate(() => window.clothlab.stage.camera.position.toArray());

browserTest(
  "it plays by itself: the cloth is in the picture and moves, and nothing but the file is loaded",
  async () => {
    const viewer = await open("seed.html");
    await drawn(viewer, 3);
    // The time first: on a busy machine it may be at its end once the picture is read.
    const time = await viewer.read("simTime");
    const early = { cloth: await viewer.cloth(), time };
    await viewer.until((from) => window.clothlab.simTime > from + 0.5, early.time);
    const later = await viewer.cloth();
    await viewer.page.screenshot({ path: join(screenshots, "recording.png") });
    assert.ok(early.cloth.share > 0.02 && later.share > 0.02, `${early.cloth.share}, ${later.share}`);
    assert.ok(later.shades > 50, `${later.shades} shades`);
    assert.notEqual(early.cloth.checksum, later.checksum);
    const lowest = Math.min(...(await viewer.positions()).map(([, y]) => y));
    assert.ok(lowest < 0.8, `the lowest vertex is at ${lowest} m`);
    assert.deepEqual(
      viewer.asked.filter((url) => !/^(file|data|blob):/.test(url)),
      [],
    );
    assert.equal(viewer.asked.filter((url) => url.startsWith("file:")).length, 1);
    assert.deepEqual(viewer.complaints, []);
  },
);

browserTest("keys and the bar play, stop, step and scrub; the end stops, and from there it plays anew", async () => {
  const viewer = await open("seed.html", { reducedMotion: "reduce" });
  await drawn(viewer, 1);
  assert.equal(await playing(viewer), false); // the system wishes for less motion
  assert.equal(await frame(viewer), 0);
  await viewer.page.keyboard.press(".");
  await eventually(
    "a frame on",
    () => frame(viewer),
    (at) => at === 1,
  );
  await viewer.page.keyboard.press(",");
  await eventually(
    "a frame back",
    () => frame(viewer),
    (at) => at === 0,
  );
  await viewer.page.keyboard.press(" ");
  assert.equal(await playing(viewer), true);
  await eventually(
    "it plays",
    () => frame(viewer),
    (at) => at > 3,
  );
  await viewer.page.click("#play");
  assert.equal(await playing(viewer), false);
  // By mouse to the middle of the bar.
  const bar = await viewer.page.locator("#frame").boundingBox();
  await viewer.page.mouse.click(bar.x + bar.width / 2, bar.y + bar.height / 2);
  const middle = await eventually(
    "the middle",
    () => viewer.read("simTime"),
    (time) => time > 1.2 && time < 1.8,
  );
  assert.match(await viewer.page.textContent("#clock"), /^1\.\d\d s$/);
  // By the arrow keys that a slider has.
  await viewer.page.focus("#frame");
  await viewer.page.keyboard.press("ArrowRight");
  await eventually(
    "the next frame",
    () => viewer.read("simTime"),
    (time) => time > middle && time < middle + 0.05,
  );
  await viewer.page.keyboard.press("End");
  await eventually(
    "the end",
    () => viewer.read("simTime"),
    (time) => time === 3,
  );
  await viewer.page.keyboard.press(" ");
  await eventually(
    "anew",
    () => viewer.read("simTime"),
    (time) => time < 2.5,
  );
  assert.deepEqual(viewer.complaints, []);
});

browserTest("a drag orbits, S colours by strain, and the ball and the pins are in the picture", async () => {
  const viewer = await open("seed.html", { reducedMotion: "reduce" });
  await drawn(viewer, 1);
  await viewer.page.keyboard.press("End");
  await eventually(
    "the end",
    () => viewer.read("simTime"),
    (time) => time === 3,
  );
  const red = await viewer.cloth();
  await viewer.page.keyboard.press("s");
  await viewer.page.waitForFunction(() => !document.getElementById("legend").hidden);
  await eventually(
    "no red cloth",
    () => viewer.cloth(),
    (cloth) => cloth.count < red.count / 5,
  );
  assert.match(await viewer.page.textContent("#legend-most"), /^[\d.]+ %$/);
  const from = await camera(viewer);
  await viewer.page.mouse.move(450, 200);
  await viewer.page.mouse.down();
  await viewer.page.mouse.move(600, 220, { steps: 4 });
  await viewer.page.mouse.up();
  const to = await camera(viewer);
  assert.ok(Math.hypot(...to.map((x, i) => x - from[i])) > 0.2, "the camera has moved");
  assert.equal(await viewer.page.evaluate(() => window.clothlab.stage.colliders.bodies.length), 1);
});

browserTest("on a phone a finger scrubs and orbits, and all of the bar is in the window", async () => {
  const viewer = await open("seed.html", { width: 390, height: 700, hasTouch: true, reducedMotion: "reduce" });
  await drawn(viewer, 1);
  const bar = await viewer.page.locator("#bar").boundingBox();
  assert.ok(bar.x >= 0 && bar.x + bar.width <= 390 && bar.y + bar.height <= 700, JSON.stringify(bar));
  const slider = await viewer.page.locator("#frame").boundingBox();
  await viewer.page.touchscreen.tap(slider.x + slider.width * 0.7, slider.y + slider.height / 2);
  await eventually(
    "there",
    () => viewer.read("simTime"),
    (time) => time > 1.5,
  );
  const wide = await viewer.page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390);
});

browserTest("a recording shows bodies whose triangles are in files, and two cloths", async () => {
  const viewer = await open("above.html");
  await drawn(viewer, 2);
  const bodies = await viewer.page.evaluate(() =>
    window.clothlab.stage.colliders.bodies.map(({ mesh }) => mesh.geometry.attributes.position?.count ?? 0),
  );
  assert.ok(bodies.length === 1 && bodies[0] > 100, JSON.stringify(bodies));
  const dressed = await open("mannequin.html");
  await drawn(dressed, 2);
  assert.equal(await dressed.page.evaluate(() => window.clothlab.stage.cloth.topology.cloths.length), 2);
  assert.deepEqual([...viewer.complaints, ...dressed.complaints], []);
});

browserTest("a page whose recording is cut off says so", async () => {
  const html = readFileSync(file("seed.html"), "utf8");
  writeFileSync(file("cut.html"), html.replace(/(id="recording">[A-Za-z0-9+/]{40000})[A-Za-z0-9+/=]*/, "$1"));
  const viewer = await open("cut.html");
  await viewer.page.waitForSelector("#message:not([hidden])");
  assert.match(await viewer.page.textContent("#message"), /cut off/);
});
