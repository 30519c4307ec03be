// Undo and redo on the page: buttons, keys, and what other viewers do, on a wide window and on a phone.
import assert from "node:assert/strict";
import { browserTest, eventually, withServer } from "./browser.mjs";

const here = withServer();
const gravity = ({ gravity }) => gravity[1];

for (const [width, height, hasTouch] of [
  [1440, 900, false],
  [390, 844, true],
])
  browserTest(`at ${width}x${height} a change is undone and redone by buttons and keys, named`, async () => {
    const { viewer, client, scene } = await here.both(`undo-${width}`, { width, height, hasTouch });
    const { page } = viewer;
    const [undo, redo] = ["undo", "redo"].map((id) => page.locator(`#${id}`));
    const press = (button) => (hasTouch ? button.tap() : button.click());
    const said = (text) => page.locator(".notice", { hasText: text }).waitFor();
    const bar = await page.locator("#transport").boundingBox();
    assert.ok(bar.x >= 0 && bar.x + bar.width <= width, JSON.stringify(bar));
    assert.equal(await undo.getAttribute("aria-disabled"), "true");
    const first = gravity(await scene());

    // a slider of the panel, by a key
    if (width < 700) await page.getByRole("button", { name: "Parameters" }).click();
    const slider = await viewer.slider("World", "gravity");
    await slider.focus();
    await page.keyboard.press("ArrowRight");
    const changed = gravity(await eventually("the change", scene, (now) => Math.abs(gravity(now) - first) > 1e-9));
    await page.getByRole("button", { name: "Undo: Gravity" }).waitFor();
    assert.match(await undo.getAttribute("title"), /Undo: Gravity/);
    await page.keyboard.press("Control+z");
    await eventually("the change undone", scene, (now) => gravity(now) === first);
    await said("Undone: Gravity");
    await eventually(
      "the slider back",
      () => slider.getAttribute("aria-valuetext"),
      (text) => parseFloat(text) !== changed,
    );
    await page.getByRole("button", { name: "Redo: Gravity" }).waitFor();
    await page.keyboard.press("Control+Shift+Z");
    await eventually("the change redone", scene, (now) => gravity(now) !== first);
    await said("Redone: Gravity");
    if (width < 700) await page.getByRole("button", { name: "Parameters" }).click();

    await press(undo);
    await eventually("undone by the button", scene, (now) => gravity(now) === first);
    await press(redo);
    await eventually("redone by the button", scene, (now) => gravity(now) !== first);
    await page.keyboard.press("Control+z");
    await eventually("undone again", scene, (now) => gravity(now) === first);
    await page.keyboard.press("Control+y");
    await eventually("redone by Ctrl+Y", scene, (now) => gravity(now) !== first);

    // somebody else
    const { name } = await client.request("scene.undo");
    assert.equal(name, "Gravity");
    await page.locator(".notice", { hasText: "Undone: Gravity" }).getByText("By another viewer.").waitFor();
    assert.equal(await page.locator(".notice", { hasText: "Gravity, by another" }).count(), 0, "its own are not told");
    await client.request("scene.patch", { patch: { gravity: [0, -4, 0] } });
    await page.locator(".notice", { hasText: "Gravity, by another viewer" }).waitFor();
    await client.request("scene.load", { preset: "cantilever" });
    await page.getByRole("button", { name: "Undo: Load cantilever" }).waitFor();
    assert.equal(await redo.getAttribute("aria-disabled"), "true");
    await press(undo);
    await eventually("the first scene", scene, (now) => now.name === "seed");
    await page.locator("#scene-name", { hasText: "seed" }).waitFor();
    assert.deepEqual(
      viewer.complaints.filter((text) => !text.includes("GPU stall")),
      [],
    );
  });

browserTest("in a text field Ctrl+Z belongs to the field, and a page that just came tells nothing as new", async () => {
  const { viewer, client, scene } = await here.both("undo-text");
  await client.request("scene.patch", { patch: { gravity: [0, -5, 0] }, name: "half of it" });
  await client.request("scene.undo");
  await client.request("scene.redo");
  await viewer.page.reload();
  await viewer.until(() => window.clothlab?.framesDrawn > 2);
  await viewer.page.getByRole("button", { name: "Undo: half of it" }).waitFor();
  assert.equal(await viewer.page.locator(".notice", { hasText: "Redone" }).count(), 0);
  const number = viewer.number("Cloth", "structural");
  await number.focus();
  await viewer.page.keyboard.press("Control+z");
  await viewer.page.waitForTimeout(500);
  assert.equal(gravity(await scene()), -5);
  await number.blur();
  await viewer.page.keyboard.press("Control+z");
  await eventually("undone", scene, (now) => gravity(now) !== -5);
});
