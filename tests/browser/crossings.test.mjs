import assert from "node:assert/strict";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { thorough } from "../thorough.mjs";

const { both } = withServer();

const grid = (columns) => ({ grid: { columns, rows: columns, width: 0.5, height: 0.5 } });
const material = { fabric: "cotton" };
/// A sheet, and one that stands through its middle.
const crossing = {
  version: 1,
  name: "crossing",
  cloths: [
    { name: "lying", mesh: grid(9), material, transform: { translate: [0, 0.4, 0] }, pins: [{ at: "edge:row:0" }] },
    {
      name: "standing",
      mesh: grid(8),
      material,
      color: "#3b6ea5",
      transform: { translate: [0.02, 0.6, 0.24], rotate: [90, 0, 0] },
      pins: [{ at: "edge:row:0" }],
    },
  ],
  self_collision: { thickness: 0.01, friction: 0.2, kind: "points" },
  solver: { method: "implicit_euler", dt: 0.005 },
};

const refusal = (page) => page.locator("#notices .notice", { hasText: "Not applied" });
const shown = (page) => page.evaluate(() => window.clothlab.stage.showsCrossings);
const eye = (page) => page.evaluate(() => window.clothlab.stage.controls.object.position.toArray());

/// A page whose user has chosen contact between surfaces for a cloth that passes through another one.
async function refusedPage(session, options) {
  const here = await both(session, options);
  await options?.before?.(here.viewer.page);
  await here.client.request("sim.pause");
  await here.client.request("scene.load", { scene: crossing });
  const { page } = here.viewer;
  await here.viewer.until(() => window.clothlab.document?.name === "crossing" && window.clothlab.simTime === 0);
  if (options?.width < 700) await page.getByRole("button", { name: "Parameters" }).click();
  await page.getByRole("combobox", { name: "between" }).selectOption("surface");
  await refusal(page).waitFor();
  if (options?.width < 700) await page.getByRole("button", { name: "Parameters" }).click();
  return here;
}

for (const [width, height] of [
  [1280, 800],
  [360, 740],
]) {
  browserTest(
    `at ${width}x${height} a start with crossings is told, shown on request, and fits the window`,
    async () => {
      const { viewer, client } = await refusedPage(`crossings-${width}`, { width, height, sharp: thorough });
      const { page } = viewer;
      assert.match(await refusal(page).textContent(), /edge \d+-\d+ of (lying|standing) × triangle \d+-\d+-\d+ of/);
      assert.equal(await shown(page), false);
      const before = await eye(page);
      await page.waitForTimeout(600);
      await page.screenshot({ path: `${screenshots}crossings-${width}-told.png` });
      await refusal(page).getByRole("button", { name: "Show me" }).focus();
      await page.keyboard.press("Enter");
      await eventually("the crossings", () => shown(page), Boolean);
      assert.notDeepEqual(await eye(page), before, "the camera went there");
      await page.waitForTimeout(900);
      await page.screenshot({ path: `${screenshots}crossings-${width}-shown.png` });
      const box = await refusal(page).boundingBox();
      assert.ok(box.x >= 0 && box.x + box.width <= width && box.y >= 0 && box.y + box.height <= height);
      await refusal(page).getByRole("button", { name: "Dismiss" }).press("Enter");
      await eventually(
        "nothing shown",
        () => shown(page),
        (is) => !is,
      );
      await client.close();
    },
  );
}

/// Keeps the page's connections where a test can close them.
async function keepSockets(page) {
  await page.addInitScript(() => {
    window.sockets = [];
    window.WebSocket = class extends WebSocket {
      constructor(...words) {
        super(...words);
        window.sockets.push(this);
      }
    };
  });
  await page.reload();
}

browserTest("a connection that is lost and comes back leaves the notice of crossings", async () => {
  const { viewer, client } = await refusedPage("crossings-again", { before: keepSockets });
  const { page } = viewer;
  await page.evaluate(() => window.sockets.at(-1).close());
  await viewer.until(() => window.sockets.length > 1 && window.sockets.at(-1).readyState === WebSocket.OPEN);
  await page.waitForTimeout(500); // the scene comes, and comes again
  assert.equal(await refusal(page).count(), 1);
  await client.close();
});

browserTest("a loaded scene takes crossings and their notice away", async () => {
  const { viewer, client } = await refusedPage("crossings-load");
  const { page } = viewer;
  await refusal(page).getByRole("button", { name: "Show me" }).click();
  await eventually("the crossings", () => shown(page), Boolean);
  await client.request("scene.load", { preset: "seed" });
  await eventually(
    "nothing shown",
    () => shown(page),
    (is) => !is,
  );
  assert.equal(await refusal(page).count(), 0);
  await client.close();
});

browserTest("an edit refused for crossings is applied with points instead, by one button", async () => {
  const { viewer, client, scene } = await both("crossings-points");
  const { page } = viewer;
  const [lying, standing] = crossing.cloths;
  const above = { ...lying, transform: { translate: [0, 1.2, 0] } };
  const apart = { ...crossing, name: "apart", cloths: [above, standing] };
  apart.self_collision = { ...crossing.self_collision, kind: "surface" };
  await client.request("sim.pause");
  await client.request("scene.load", { scene: apart });
  await viewer.until(() => window.clothlab.document?.name === "apart");
  await viewer.slider("Place", "scale");
  const height = viewer.number("Place", "place y");
  await height.fill("0.4");
  await height.press("Enter");
  await refusal(page).getByRole("button", { name: "Use points instead" }).press("Enter");
  const applied = await eventually("the edit", scene, (now) => now.cloths[0].transform.translate[1] === 0.4);
  assert.equal(applied.self_collision.kind, "points");
  assert.equal(await refusal(page).count(), 0);
  await client.close();
});

browserTest("an edit refused for crossings of the start leads the cloth out, by one button", async () => {
  const { viewer, client, scene } = await refusedPage("crossings-led-out");
  await refusal(viewer.page).getByRole("button", { name: "Lead it out" }).press("Enter");
  const applied = await eventually("the edit", scene, (now) => now.self_collision.kind === "surface");
  assert.deepEqual(
    applied.cloths.map(({ start }) => start),
    [{ dress: 1 }, { dress: 1 }],
  );
  await viewer.page.locator("#notices .notice", { hasText: "led out at the start" }).waitFor();
  await client.close();
});

browserTest("the figures have the counts of contact between surfaces while there are any", async () => {
  const { viewer, client } = await both("crossings-figures");
  await viewer.figures();
  await viewer.page.locator("#stats").getByText("Vertices").waitFor();
  const figure = viewer.page.locator("#stats > div", { hasText: "Surface" });
  assert.equal(await figure.isVisible(), false);
  await client.request("scene.patch", { patch: { self_collision: { kind: "surface" } } });
  await figure.filter({ hasText: /\d[\d.]*[KM]? pairs, \d[\d.]*[KM]? cut/ }).waitFor();
  await client.close();
});
