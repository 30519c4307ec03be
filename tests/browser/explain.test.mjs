// The panel explains each parameter, marks what differs from the scene as loaded, and brings it back.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before } from "node:test";
import { load } from "../page/module.mjs";
import { Client } from "../protocol/harness.mjs";
import { browserTest, eventually, withServer } from "./browser.mjs";

const here = withServer();
const scenes = new URL("../../server/scene/", import.meta.url);
const read = (name) => JSON.parse(readFileSync(new URL(name, scenes), "utf8"));

let schemaOf, baseline, fields;
before(async () => {
  schemaOf = await load("explain/schema");
  baseline = await load("explain/baseline");
  fields = await load("panel/fields");
});

const row = (page, label) => page.locator(`.lil-controller:has(input[aria-label^="${label}"])`).first();
const marked = (page) => page.locator(".lil-controller.differs .lil-name").allInnerTexts();
/// Waits until the page knows the schema and the presets: then a change is marked.
const known = (viewer) =>
  viewer.page.waitForFunction(() => performance.getEntriesByName(`${location.origin}/scenes.json`).length > 0);
const box = (page) => page.locator("#explanation");
const words = async (page) => (await box(page).innerText()).replaceAll(/\s+/g, " ");

/// The document with numbers where it leaves them to a fabric, so that the panel has all its fields.
const withNumbers = (document) => ({
  ...document,
  cloths: document.cloths.map((cloth) => {
    const springs = { structural: 1, shear: 1, bend: 1, damping: 1, strain_limit: null };
    const sheet = { warp: 1, weft: 1, poisson: 0, bending: 1, grain: 0 };
    return { mass: { area_density: 1 }, ...cloth, material: { ...springs, ...sheet, ...cloth.material } };
  }),
});

browserTest(
  "a file of a preset, completed by the schema, is what the server makes of it: nothing is marked",
  async () => {
    const client = await Client.connect(here.server, { session: "presets" });
    const schema = read("scene.schema.json");
    const inside = (section) => [...section.fields, ...section.sections.flatMap(inside)];
    const { presets } = await client.request("scene.presets", {});
    const found = [];
    for (const preset of presets) {
      await client.request("scene.load", { preset });
      const { document } = await client.request("scene.get", {});
      const loaded = schemaOf.completed(schema, read(`presets/${preset}.json`));
      for (const field of fields
        .sectionsOf(withNumbers(document), ["symplectic_euler"], read("fabrics.json"))
        .flatMap(inside))
        for (const { path, op } of baseline.wayBack(field, document, loaded)) found.push(`${preset}: ${op} ${path}`);
    }
    assert.deepEqual(found, []);
    assert.ok(presets.length > 10);
    await client.close();
  },
);

for (const [width, height] of [
  [390, 844],
  [1440, 900],
]) {
  browserTest(`at ${width}x${height} a changed value is marked, and a button brings it back`, async () => {
    const { viewer, client, scene } = await here.both(`reset-${width}`, { width, height });
    const { page } = viewer;
    await known(viewer);
    if (width < 700) await page.getByRole("button", { name: "Parameters" }).click();
    const slider = await viewer.slider("Cloth", "structural");
    assert.deepEqual(await marked(page), []);
    await slider.focus();
    await page.keyboard.press("PageDown");
    const structural = async () => (await scene()).cloths[0].material.structural;
    await eventually("the server's value", structural, (value) => value < 20000);
    await eventually(
      "the mark",
      () => marked(page),
      ([name]) => name?.startsWith("structural"),
    );
    assert.match(await page.locator(".differences").innerText(), /^1 value differs from seed\./);
    await page.keyboard.press("Escape"); // the explanation, which the keys had opened
    const reset = page.getByRole("button", { name: "Reset structural to 20000 N/m" });
    const { width: wide, height: high } = await reset.boundingBox();
    assert.ok(Math.min(wide, high) >= 24, `a target of ${wide}x${high} px`);
    await reset.click();
    await eventually("the value of the preset", structural, (value) => value === 20000);
    await eventually(
      "no mark",
      () => marked(page),
      (names) => names.length === 0,
    );
    assert.equal(await page.locator(".differences").isVisible(), false);
    await client.close();
  });
}

browserTest("the reset is reached by Tab, and leaves the focus in its row", async () => {
  const { viewer, client, scene } = await here.both("reset-keys");
  const { page } = viewer;
  await known(viewer);
  const slider = await viewer.slider("Cloth", "bend");
  await slider.focus();
  await page.keyboard.press("PageUp");
  await page.getByRole("button", { name: "Reset bend to 2000 N/m" }).waitFor();
  await viewer.number("Cloth", "bend").focus();
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.getAttribute("aria-label")), "Reset bend to 2000 N/m");
  await page.keyboard.press("Enter");
  await eventually(
    "bend",
    async () => (await scene()).cloths[0].material.bend,
    (value) => value === 2000,
  );
  await eventually(
    "the focus",
    () => page.evaluate(() => document.activeElement.getAttribute("aria-label")),
    (name) => name === "bend [N/m]",
  );
  await client.close();
});

browserTest("a page that opens late marks what others changed; all of it goes back at once", async () => {
  const session = "reset-late";
  const first = await Client.connect(here.server, { session });
  const { document: before } = await first.request("scene.get", {});
  await first.request("scene.patch", {
    patch: { gravity: [0, -3, 0], self_collision: null, solver: { method: "implicit_euler", dt: 0.01 } },
  });
  const silk = [
    { op: "replace", path: "/cloths/0/material", value: { model: "fem", fabric: "silk" } },
    { op: "remove", path: "/cloths/0/mass" },
  ];
  await first.request("scene.patch", { patch: silk });
  const viewer = await here.open({ session, width: 1280, height: 800, drawn: 1 });
  await eventually(
    "the marks",
    () => marked(viewer.page),
    (names) => names.length === 5,
  );
  await viewer.page.getByRole("button", { name: "Reset all" }).click();
  await eventually(
    "no marks",
    () => marked(viewer.page),
    (names) => names.length === 0,
  );
  assert.deepEqual((await first.request("scene.get", {})).document, before);
  await first.close();
});

browserTest("a scene that is no preset is compared with what was loaded", async () => {
  const { viewer, client, scene } = await here.both("reset-own");
  await known(viewer);
  const own = { ...(await scene()), name: "my own" };
  own.solver.dt = 0.0004;
  await client.request("scene.load", { scene: own });
  await viewer.until(() => window.clothlab.document.name === "my own");
  assert.deepEqual(await marked(viewer.page), []);
  await client.request("scene.patch", { patch: { solver: { dt: 0.0005 } } });
  await viewer.page.getByRole("button", { name: "Reset time step to 0.0004 s" }).waitFor();
  await client.close();
});

browserTest("a parameter explains itself to the mouse, and the box can be pointed at and sent away", async () => {
  const viewer = await here.open({ session: "hover", width: 1440, height: 900 });
  const { page } = viewer;
  await known(viewer);
  await viewer.slider("Solver", "time step");
  const at = await row(page, "time step").boundingBox();
  await page.mouse.move(at.x + 30, at.y + at.height / 2);
  await box(page).waitFor();
  const text = await words(page);
  for (const part of [
    "time step [s]",
    "Time step [s].",
    "Range 1e-9 to 1 s",
    "Default 0.001 s",
    "In seed 0.001 s",
    "Costs Half the step is twice the work",
  ])
    assert.ok(text.includes(part), `${part} is not in: ${text}`);
  const place = await box(page).boundingBox();
  assert.ok(place.x + place.width <= at.x, "it covers no part of the panel");
  await page.mouse.move(place.x + place.width - 20, place.y + 20);
  await page.waitForTimeout(500);
  assert.ok(await box(page).isVisible(), "it stays under the pointer");
  await page.keyboard.press("Escape");
  await box(page).waitFor({ state: "hidden" });
  await page.mouse.move(at.x + 30, at.y + at.height / 2);
  await box(page).waitFor();
  await page.mouse.move(500, 500);
  await box(page).waitFor({ state: "hidden" });
});

browserTest("a parameter explains itself to the keyboard and to a screen reader", async () => {
  const viewer = await here.open({ session: "focus", width: 1440, height: 900 });
  const { page } = viewer;
  await known(viewer);
  await viewer.slider("Cloth", "structural");
  await page.getByRole("combobox", { name: "fabric" }).focus();
  await page.keyboard.press("Tab");
  await box(page).waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.getAttribute("aria-label")), "structural [N/m]");
  const described = await page.evaluate(() => {
    const by = document.activeElement.getAttribute("aria-describedby");
    return document.getElementById(by).innerText;
  });
  assert.match(described, /Springs to the neighbours along a grid's rows and columns/);
  assert.match(described, /Range\s+0 to 1e12 N\/m/);
  await page.keyboard.press("Escape");
  await box(page).waitFor({ state: "hidden" });
  assert.equal(await page.evaluate(() => document.activeElement.getAttribute("aria-label")), "structural [N/m]");
});

browserTest("a tap on a parameter's name explains it, and does not switch it", async () => {
  const { viewer, client, scene } = await here.both("tap", { width: 390, height: 844, hasTouch: true });
  const { page } = viewer;
  await known(viewer);
  await page.getByRole("button", { name: "Parameters" }).tap();
  await viewer.slider("Self-collision", "thickness");
  const title = page.locator('.lil-gui:has(> .lil-title:text-is("Self-collision")) .lil-name:text-is("on")');
  await title.scrollIntoViewIfNeeded();
  await page.waitForTimeout(300);
  await title.tap();
  await box(page).waitFor();
  assert.match(await words(page), /the cloths pass through themselves and each other.*about twice the time of a step/);
  const { x, y, width, height } = await box(page).boundingBox();
  assert.ok(x >= 0 && y >= 0 && x + width <= 390 && y + height <= 844, "it is in the window");
  await page.waitForTimeout(400); // a change would have been sent
  assert.notEqual((await scene()).self_collision, null);
  await title.tap();
  await box(page).waitFor({ state: "hidden" });
  await title.click(); // the mouse has hovering for it
  await eventually(
    "switched off",
    async () => (await scene()).self_collision,
    (value) => value === null,
  );
  await client.close();
});
