// The gallery of presets: pictures that the build has drawn, by mouse, by keys, on every window.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { Server } from "../protocol/harness.mjs";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { thorough } from "../thorough.mjs";

const { both, open } = withServer();
const drawn = existsSync(fileURLToPath(new URL("../../web/pictures/seed.png", import.meta.url)));

/// Opens the gallery from the panel, which is a sheet on a phone.
async function gallery(page, width) {
  if (width < 700) await page.getByRole("button", { name: "Parameters" }).click();
  await page.getByRole("button", { name: "Gallery" }).click();
  const dialog = page.getByRole("dialog", { name: "Presets" });
  await dialog.waitFor();
  return dialog;
}

for (const [width, height] of [
  [1440, 900],
  [390, 844],
  [320, 640],
])
  browserTest(`at ${width}x${height} each preset has its picture and its sentence, and a click loads it`, async () => {
    const { viewer, client, scene } = await both(`gallery-${width}`, { width, height, sharp: thorough });
    const { page } = viewer;
    const dialog = await gallery(page, width);
    const { presets, about } = await client.request("scene.presets");
    const cards = dialog.getByRole("listitem").getByRole("button");
    const texts = await cards.evaluateAll((all) => all.map(({ innerText }) => innerText.trim().split(/\n+/)));
    assert.deepEqual(
      texts,
      presets.map((name) => [name, about[name]]),
    );
    assert.equal(await cards.filter({ hasText: /^seed/ }).getAttribute("aria-current"), "true");
    const box = await dialog.boundingBox();
    assert.ok(box.x >= 0 && box.x + box.width <= width && box.y >= 0 && box.y + box.height <= height);
    assert.ok(await dialog.evaluate((of) => of.scrollWidth <= of.clientWidth), "nothing is cut off at the side");
    if (drawn) {
      const shown = () =>
        cards
          .first()
          .locator("img")
          .evaluate((image) => image.naturalWidth);
      await eventually("the first picture", shown, (natural) => natural === 320);
    }
    await page.screenshot({ path: join(screenshots, `gallery-${width}.png`) });
    await cards.filter({ hasText: /^drape/ }).click();
    await eventually("the preset", scene, ({ name }) => name === "drape");
    await dialog.waitFor({ state: "detached" });
  });

browserTest("by keys: Tab and Enter load, Escape closes and gives the focus back", async () => {
  const { viewer, scene } = await both("gallery-keys");
  const { page } = viewer;
  await page.getByRole("button", { name: "Gallery" }).focus();
  await page.keyboard.press("Enter");
  const dialog = page.getByRole("dialog", { name: "Presets" });
  await dialog.waitFor();
  assert.match(await page.evaluate(() => document.activeElement.innerText), /^seed/);
  await page.keyboard.press("Escape");
  await dialog.waitFor({ state: "detached" });
  assert.equal(await page.evaluate(() => document.activeElement.textContent), "Gallery");
  await page.keyboard.press("Enter");
  await dialog.waitFor();
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  await eventually("the next preset", scene, ({ name }) => name === "flag");
});

browserTest("without pictures the names and sentences stay; a viewer may look only", async () => {
  const guarded = await Server.start("--token", "secret", "--view-token", "public");
  try {
    const viewer = await open({ server: guarded, drawn: 0 });
    const { page } = viewer;
    await page.route("**/presets/*.png", (route) => route.fulfill({ status: 404 }));
    await page.locator("#auth-token").fill("public");
    await page.keyboard.press("Enter");
    await viewer.until(() => window.clothlab?.framesDrawn > 2);
    const opener = page.getByRole("button", { name: "Gallery" });
    await opener.focus(); // a viewer's panel takes no clicks
    await page.keyboard.press("Enter");
    const dialog = page.getByRole("dialog", { name: "Presets" });
    await dialog.getByText("You are a viewer").waitFor();
    await eventually(
      "the first one gone",
      () => dialog.locator("li").first().locator("img").count(),
      (count) => count === 0,
    );
    const card = dialog.getByRole("button", { name: /^seed/ });
    assert.ok(await card.isDisabled());
    assert.match(await card.innerText(), /two swinging corners/);
  } finally {
    await guarded.stop();
  }
});
