// The page on every window and by every means: contrast and names by axe-core, sizes from 320 px to 4K, keyboard, less
// motion, folded panels.
import assert from "node:assert/strict";
import { violations } from "./axe.mjs";
import { arrived, browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { hiddenPoints } from "./hidden_points.mjs";

const here = withServer();

for (const [width, height] of [
  [1440, 900],
  [390, 844],
])
  for (const colorScheme of ["dark", "light"])
    browserTest(`at ${width}x${height}, ${colorScheme}, axe-core finds nothing wrong`, async () => {
      const session = `axe-${width}-${colorScheme}`;
      const { viewer, client } = await here.both(session, { width, height, colorScheme, newcomer: true });
      const { page } = viewer;
      const turnSheet = async () => {
        if (width < 700) await page.getByRole("button", { name: "Parameters" }).click();
      };
      await page.locator("#first-steps").waitFor();
      const found = await violations(viewer, "first steps");
      await page.keyboard.press("n");
      await page.getByRole("button", { name: "Take off" }).waitFor();
      found.push(...(await violations(viewer, "a pin is chosen")));
      await page.keyboard.press("g");
      await page.locator(".hands .mine").waitFor();
      found.push(...(await violations(viewer, "the cloth is held")));
      await page.keyboard.press("Escape");
      await page.locator(".hand-hint[data-of=hand]").waitFor({ state: "hidden" });
      assert.ok(await page.locator("#first-steps").isVisible(), "Escape let go of the cloth alone");
      await client.request("sim.pause"); // what moves would be drawn while axe-core looks
      await page.keyboard.press("Escape");
      await turnSheet();
      const slider = await viewer.slider("Cloth", "structural");
      await slider.focus();
      await page.keyboard.press("ArrowLeft");
      await page.locator(".differs").waitFor();
      await page.keyboard.press("Tab");
      await page.locator("#explanation").waitFor();
      await page.evaluate(() => {
        for (const title of document.querySelectorAll(".lil-gui.lil-closed > .lil-title")) title.click();
      });
      await page.waitForFunction(() => !document.querySelector(".lil-gui.lil-closed"));
      found.push(...(await violations(viewer, "panel")));
      await turnSheet();
      await page.getByRole("combobox", { name: "Colour by" }).selectOption("strain");
      await page.locator("#legend").waitFor();
      found.push(...(await violations(viewer, "legend", "#legend")));
      await page.evaluate(() => document.activeElement.blur());
      await page.keyboard.press("i");
      for (const overlay of ["structural", "Contact pairs"])
        await page.getByRole("checkbox", { name: overlay, exact: true }).check();
      await page.locator(".inside-label").waitFor();
      found.push(...(await violations(viewer, "see inside", "#inside")));
      await page.keyboard.press("Escape");
      await page.getByRole("button", { name: "Lab", exact: true }).click();
      await page.getByRole("button", { name: "Options" }).first().click();
      for (const tab of ["Chart", "Stability", "Choose", "Simplify"]) {
        await page.getByRole("tab", { name: tab }).click();
        found.push(...(await violations(viewer, `lab, ${tab}`, "#lab")));
      }
      await page.keyboard.press("Escape");
      await page.keyboard.press("j");
      const text = page.getByLabel("The scene as JSON");
      await text.waitFor();
      await page.getByRole("button", { name: "command line" }).click();
      await text.fill("{");
      await page.keyboard.press("Control+Enter");
      await page.locator(".text-band").waitFor();
      found.push(...(await violations(viewer, "the scene as text, with a mistake", "#text")));
      await page.keyboard.press("Escape");
      await page.keyboard.press("c");
      const compare = page.locator("#compare");
      await compare.getByLabel("simulate [s]").fill("0.2");
      await compare.getByRole("button", { name: "Start together" }).click();
      await compare.getByText(/^Up to /).waitFor();
      for (const fold of ["A and B", "The difference as a table"]) {
        const details = compare.locator("details", { has: page.getByText(fold, { exact: true }) }).first();
        if ((await details.getAttribute("open")) === null) await details.locator("summary").first().click();
      }
      found.push(...(await violations(viewer, "a comparison", "#compare")));
      await page.keyboard.press("Escape");
      await page.evaluate(() => {
        // raw deflate of a scene with one cloth
        location.hash = "#scene=BcExDoAgDEDRu_yZxbVXMQ5GGiFCScC4NL277zmfzlWHIVvCzq4IrdqjmcTVxlsWsjtdV0Gce9aMeEQc8QM";
      });
      await page.getByRole("dialog", { name: "A scene by link" }).waitFor();
      found.push(...(await violations(viewer, "a scene by link", "dialog")));
      await page.keyboard.press("Escape");
      await page.locator(".scene-actions button", { hasText: "Gallery" }).evaluate((gallery) => gallery.click());
      await page.getByRole("dialog", { name: "Presets" }).waitFor();
      found.push(...(await violations(viewer, "the gallery", "dialog")));
      await page.keyboard.press("Escape");
      await page.getByRole("button", { name: "Help" }).click();
      found.push(...(await violations(viewer, "help", "#help")));
      assert.deepEqual(found, []);
      await client.close();
    });

// A graphics processor draws glass: what is behind a card shows through. The worst that can be behind is black or
// white.
for (const colorScheme of ["dark", "light"])
  browserTest(`in ${colorScheme}, the text of a card is read over any picture`, async () => {
    const { page } = await here.open({ session: "glass", colorScheme });
    const contrasts = await page.evaluate(() => {
      document.body.classList.remove("software");
      const numbers = (text) => (text.match(/[\d.]+/g) ?? []).map(Number);
      const probe = document.createElement("i");
      document.body.append(probe);
      const color = (name) => ((probe.style.color = `var(${name})`), numbers(getComputedStyle(probe).color));
      const card = numbers(getComputedStyle(document.getElementById("hud")).backgroundColor);
      const light = (rgb) => {
        const [r, g, b] = rgb.map((v) => (v <= 10.31 ? v / 3294.6 : ((v / 255 + 0.055) / 1.055) ** 2.4));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
      };
      return [0, 255].flatMap((behind) => {
        const under = [0, 1, 2].map((i) => (card[3] ?? 1) * card[i] + (1 - (card[3] ?? 1)) * behind);
        return ["--text", "--muted"].map((name) => {
          const [a, b] = [light(color(name).slice(0, 3)), light(under)].sort((x, y) => y - x);
          return [`${name} over ${behind}`, (a + 0.05) / (b + 0.05)];
        });
      });
    });
    for (const [what, contrast] of contrasts) assert.ok(contrast >= 4.5, `${what}: ${contrast.toFixed(2)}`);
  });

/// Cards and controls that stick out of the window or cover each other's controls.
const unreachable = () => {
  const problems = [];
  const shown = (node) => node.checkVisibility({ visibilityProperty: true, opacityProperty: true });
  for (const node of document.querySelectorAll(".card, .card button, .card select, .card summary")) {
    if (!shown(node)) continue;
    const { left, top, right, bottom } = node.getBoundingClientRect();
    const scrolls = node.closest(".panel-body, .lab-body, .inside-body");
    const name = node.id || node.getAttribute("aria-label") || node.textContent.trim().slice(0, 20);
    if (left < -0.5 || right > innerWidth + 0.5) problems.push(`${name} sticks out to a side`);
    if (!scrolls && (top < -0.5 || bottom > innerHeight + 1)) problems.push(`${name} sticks out above or below`);
    if (scrolls || node.matches(".card")) continue;
    const at = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
    if (at && !node.contains(at) && !at.contains(node)) problems.push(`${name} is under ${at.id || at.className}`);
  }
  if (document.documentElement.scrollWidth > innerWidth) problems.push("the page scrolls sideways");
  return problems;
};

for (const [width, height] of [
  [320, 568],
  [390, 844],
  [768, 1024],
  [844, 390],
  [1440, 900],
  [3840, 2160],
])
  browserTest(`at ${width}x${height} every control is in the window and uncovered, whatever is open`, async () => {
    const viewer = await here.open({ session: `size-${width}`, width, height, newcomer: true });
    const { page } = viewer;
    const found = [];
    const look = async (when) => {
      // Those that go by themselves may do so meanwhile.
      await page.locator(".notice .close").evaluateAll((all) => all.forEach((close) => close.click()));
      await arrived(page);
      found.push(...(await page.evaluate(unreachable)).map((problem) => `${when}: ${problem}`));
    };
    await page.locator("#first-steps").waitFor();
    await look("first steps");
    await page.keyboard.press("n");
    await page.getByRole("button", { name: "Take off" }).waitFor();
    await look("a pin is chosen");
    const edge = (selector, side) =>
      page.locator(selector).evaluate((node, of) => node.getBoundingClientRect()[of], side);
    const above = await edge(".hand-hint[data-of=hand]", "bottom");
    assert.ok(above <= (await edge("#first-steps", "top")) + 0.5, "the hint lies on the first steps");
    await page.keyboard.press("Escape");
    await page.keyboard.press("Escape");
    await page.locator("#first-steps").waitFor({ state: "detached" });
    await look("at rest");
    await page.getByRole("button", { name: "Parameters" }).click();
    await look(width <= 760 ? "panel open" : "panel folded");
    await page.getByRole("button", { name: "Parameters" }).click();
    await page.getByRole("combobox", { name: "Colour by" }).selectOption("strain");
    await page.keyboard.press("Escape");
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press("i");
    await page.locator("#inside").waitFor();
    await page.getByRole("checkbox", { name: "structural", exact: true }).check();
    await look("see inside");
    await page.getByRole("button", { name: "Timeline" }).click();
    await page.locator("#timeline").waitFor();
    await look("see inside, with the timeline");
    await page.screenshot({ path: `${screenshots}everywhere-inside-${width}x${height}.png` });
    await page.getByRole("button", { name: "Timeline" }).click();
    await page.getByRole("button", { name: "Close See inside" }).click();
    await page.keyboard.press("l");
    await look("lab");
    await page.screenshot({ path: `${screenshots}everywhere-${width}x${height}.png` });
    assert.deepEqual(found, []);
  });

browserTest("the panel folds, the picture takes its room, and it unfolds by key", async () => {
  const viewer = await here.open({ session: "fold", width: 1440, height: 900 });
  const { page } = viewer;
  const fold = page.getByRole("button", { name: "Parameters" });
  const room = () => page.evaluate(() => window.clothlab.stage.area.width);
  const before = await room();
  await fold.click();
  await eventually("more room", room, (width) => width > before + 250);
  assert.equal(await fold.getAttribute("aria-expanded"), "false");
  assert.equal(await page.getByRole("combobox", { name: "preset" }).isVisible(), false);
  await fold.press("Enter");
  await eventually("as before", room, (width) => width === before);
  assert.ok(await page.getByRole("combobox", { name: "preset" }).isVisible());
});

/// Where the camera stands, as angles [radians], distance and target.
const camera = ({ page }) =>
  page.evaluate(() => {
    const { controls } = window.clothlab.stage;
    return {
      azimuth: controls.getAzimuthalAngle(),
      polar: controls.getPolarAngle(),
      distance: controls.getDistance(),
      target: controls.target.toArray(),
      fitted: window.clothlab.stage.fitted,
    };
  });

browserTest("the camera is moved by keys alone, once Tab has reached the picture", async () => {
  const { viewer, client } = await here.both("camera-keys", { width: 1440, height: 900 });
  const { page } = viewer;
  await client.request("sim.pause", {});
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.id), "view");
  const ring = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
  assert.equal(ring, "solid", "the focus is seen");
  const after = async (keys, reached) => {
    for (const key of keys) await page.keyboard.press(key);
    return eventually(`the camera after ${keys}`, () => camera(viewer), reached);
  };
  const home = await camera(viewer);
  const near = (a, b) => Math.abs(a - b) < 0.003;
  const step = Math.PI / 36;
  await after(["ArrowRight", "ArrowRight"], ({ azimuth }) => near(azimuth, home.azimuth + 2 * step));
  await after(["ArrowLeft"], ({ azimuth }) => near(azimuth, home.azimuth + step));
  await after(["ArrowUp"], ({ polar }) => near(polar, home.polar - step));
  await after(["+", "+"], ({ distance }) => near(distance / home.distance, 0.81));
  await after(["-"], ({ distance }) => near(distance / home.distance, 0.9));
  await after(["Shift+ArrowUp"], ({ target }) => target[1] > home.target[1] + 0.02);
  await page.keyboard.press("f");
  await eventually(
    "the fitted camera",
    () => camera(viewer),
    ({ azimuth, polar, fitted }) => fitted && near(azimuth, home.azimuth) && near(polar, home.polar),
  );
  await client.close();
});

browserTest(
  "who wishes less motion gets none of the page's own: nothing slides, the camera does not swing on",
  async () => {
    const viewer = await here.open({
      session: "calm",
      width: 390,
      height: 844,
      reducedMotion: "reduce",
      newcomer: true,
    });
    const { page } = viewer;
    const moving = () => page.evaluate(() => document.getAnimations().length);
    await page.locator("#first-steps").waitFor();
    for (const open of ["#first-steps .first-close", "#sheet-handle", "#sheet-handle", "#lab-open", "#lab-close"]) {
      await page.locator(open).click();
      assert.equal(await moving(), 0, `after ${open}`);
    }
    const damped = () => page.evaluate(() => window.clothlab.stage.controls.enableDamping);
    assert.equal(await damped(), false);
    await page.emulateMedia({ reducedMotion: "no-preference" });
    await eventually("the wish, followed while the page is open", damped, (now) => now === true);
  },
);

browserTest("on a phone the whole cloth of every preset is in the picture at first look", async () => {
  const { client } = await here.both("first-look", { drawn: 1 });
  const { presets } = await client.request("scene.presets", {});
  const found = [];
  for (const preset of presets.filter((name) => name !== "blowup")) {
    await client.request("scene.load", { preset });
    const options = { session: "first-look", width: 390, height: 844, drawn: 1, newcomer: true };
    const viewer = await here.open(options);
    await viewer.until((name) => window.clothlab.document?.name === name, preset);
    const look = () => viewer.page.evaluate(hiddenPoints, 0);
    const seen = await eventually(preset, look, ({ hidden }) => hidden === 0).catch(look);
    if (seen.hidden)
      found.push(`${preset}: ${seen.hidden} of ${seen.of} vertices, ${seen.worst} px into ${seen.where}`);
    await viewer.page.close();
  }
  assert.deepEqual(found, []);
  await client.close();
});
