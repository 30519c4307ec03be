// The first minute: what a newcomer sees, once, and how it goes away.
import assert from "node:assert/strict";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { hiddenPoints } from "./hidden_points.mjs";
import { Server } from "../protocol/harness.mjs";

const here = withServer();
const card = (page) => page.getByRole("region", { name: "Cloth, computed live" });
const newcomer = (session, width, height, more = {}) => here.open({ session, width, height, newcomer: true, ...more });

/// The share of the cloth's vertices that lies behind the card, or outside the window.
async function covered({ page }) {
  const { hidden, of } = await page.evaluate(hiddenPoints, 0);
  return hidden / of;
}

for (const [width, height] of [
  [390, 844],
  [1440, 900],
  [844, 390],
  [320, 568],
]) {
  browserTest(
    `at ${width}x${height} a newcomer sees what it is, three things to try, and all of the cloth`,
    async () => {
      const viewer = await newcomer(`new-${width}`, width, height);
      const { page } = viewer;
      await card(page).waitFor();
      assert.deepEqual(await card(page).locator("li").count(), 3);
      assert.match(await card(page).innerText(), /Pull it: drag the cloth/);
      await eventually(
        "the cloth in view",
        () => covered(viewer),
        (share) => share === 0,
      );
      const { x, y, width: wide, height: high } = await card(page).boundingBox();
      assert.ok(x >= 0 && y >= 0 && x + wide <= width && y + high <= height, "the card is in the window");
      assert.ok(wide * high < (width * height) / 3, `it takes ${wide}x${high}`);
      await page.screenshot({ path: `${screenshots}first-steps-${width}x${height}.png` });
    },
  );
}

for (const [how, go] of [
  ["its button", (page) => card(page).getByRole("button", { name: "Close the first steps" }).click()],
  ["Escape", (page) => page.keyboard.press("Escape")],
])
  browserTest(`the card goes by ${how}, the picture takes its room, and it does not come again`, async () => {
    const viewer = await newcomer(`gone-${how.length}`, 1440, 900);
    const { page } = viewer;
    await card(page).waitFor();
    const room = () => page.evaluate(() => window.clothlab.stage.area.height);
    const before = await eventually("room above the card", room, (height) => height < 750);
    await go(page);
    await card(page).waitFor({ state: "detached" });
    await eventually("more room", room, (now) => now > before + 100);
    await page.reload();
    await viewer.until(() => window.clothlab?.framesDrawn > 1);
    await page.waitForTimeout(500);
    assert.equal(await card(page).count(), 0);
    await page.getByRole("button", { name: "Help" }).click();
    await page.getByRole("button", { name: "First steps" }).click();
    await card(page).waitFor();
  });

for (const [width, height] of [
  [390, 844],
  [1440, 900],
])
  browserTest(`at ${width}x${height} a click blows the cloth up, and the remedy mends it`, async () => {
    const viewer = await newcomer(`blow-${width}`, width, height);
    const { page } = viewer;
    await card(page).getByRole("button", { name: "Make it blow up" }).click();
    const remedy = page.getByRole("button", { name: "Apply the remedy" });
    await remedy.waitFor();
    await remedy.click();
    await remedy.waitFor({ state: "detached" });
    const at = await viewer.read("simTime");
    await eventually(
      "the cloth moves again",
      () => viewer.read("simTime"),
      (time) => time > at + 0.1,
    );
    await page.waitForTimeout(500);
    assert.equal(await remedy.count(), 0);
  });

browserTest("each step is ticked off when it is done, and after the last one the card goes by itself", async () => {
  const viewer = await newcomer("ticks", 1440, 900);
  const { page } = viewer;
  await card(page).waitFor();
  const done = () => card(page).locator("li.done").allInnerTexts();
  assert.deepEqual(await done(), []);
  const cloth = await page.evaluate(() => {
    const { left, top, width, height } = window.clothlab.stage.area;
    return [left + width / 2, top + height / 2];
  });
  await page.mouse.move(...cloth);
  await page.mouse.down();
  await page.mouse.move(cloth[0] + 60, cloth[1] - 40, { steps: 5 });
  await page.mouse.up();
  await eventually("the first tick", done, ([first]) => /Done:\s*Pull it/.test(first));
  await card(page).getByRole("button", { name: "Make it blow up" }).click();
  await page.getByRole("button", { name: "Apply the remedy" }).click();
  await eventually("the second tick", done, ({ length }) => length === 2);
  await card(page).getByRole("button", { name: "Ask the lab" }).click();
  await page.getByRole("tab", { name: "Chart" }).waitFor();
  await page.locator("#first-steps").waitFor({ state: "detached" });
});

browserTest("the third step opens the lab, and the card stands back while it is open", async () => {
  const viewer = await newcomer("ask", 1440, 900);
  const { page } = viewer;
  await card(page).getByRole("button", { name: "Ask the lab" }).click();
  await page.getByRole("tab", { name: "Chart" }).waitFor();
  assert.equal(await page.locator("#first-steps").isVisible(), false);
  await page.keyboard.press("Escape");
  await page.locator("#lab").waitFor({ state: "hidden" });
  assert.ok(await card(page).isVisible(), "Escape closed the lab alone");
});

browserTest("who may only watch is told that an operator may pull, and gets no button to blow up", async () => {
  const server = await Server.start("--token", "spun gold", "--view-token", "look");
  try {
    const { page } = await newcomer("main", 390, 844, { server, drawn: 0 });
    await page.getByLabel("Token", { exact: true }).fill("look");
    await page.getByRole("button", { name: "Connect" }).click();
    await card(page).waitFor();
    assert.match(await card(page).innerText(), /Pull it by dragging the cloth; an operator may/);
    assert.equal(await card(page).getByRole("button", { name: "Make it blow up" }).count(), 0);
  } finally {
    await server.stop();
  }
});
