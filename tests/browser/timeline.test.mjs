// The timeline on the page: looking back over what came, and going on from there.
import assert from "node:assert/strict";
import { browserTest, eventually, withServer } from "./browser.mjs";

const here = withServer();
const step = ({ page }) => page.evaluate(() => window.clothlab.lastFrame.header.step);

for (const [width, height, hasTouch] of [
  [1440, 900, false],
  [390, 844, true],
])
  browserTest(
    `at ${width}x${height} one scrubs, steps back frame by frame, and the session goes on from there`,
    async () => {
      const { viewer, client, scene } = await here.both(`timeline-${width}`, { width, height, hasTouch });
      const { page } = viewer;
      const press = (locator) => (hasTouch ? locator.tap() : locator.click());
      await press(page.getByRole("button", { name: "Timeline" }));
      const range = page.getByRole("slider", { name: "Moment of the last minute" });
      await range.waitFor();
      const box = await page.locator("#timeline").boundingBox();
      assert.ok(box.x >= 0 && box.x + box.width <= width && box.y + box.height <= height, JSON.stringify(box));
      await viewer.until(() => window.clothlab.lastFrame.header.step > 1000);
      const early = await step(viewer);
      await client.request("scene.patch", { patch: { gravity: [0, -3, 0] } });
      await viewer.until((then) => window.clothlab.lastFrame.header.step > then + 300, early);
      assert.match(await range.getAttribute("aria-valuetext"), /live, step \d+/);
      assert.match(await page.locator(".timeline-size").textContent(), /^\d+ s, \d+\.\d MB$/);

      // by pointer or finger: on the bar, as far along as a part of `early` is, however long the session has run by now
      const told = async () => Number(/step (\d+)/.exec(await range.getAttribute("aria-valuetext"))[1]);
      const bar = await range.boundingBox();
      const lookBack = async (part) => {
        const [x, y] = [bar.x + (bar.width * part * early) / (await told()), bar.y + bar.height / 2];
        await (hasTouch ? page.touchscreen.tap(x, y) : page.mouse.click(x, y));
      };
      await lookBack(0.5);
      await page.getByRole("button", { name: "Live" }).and(page.locator(":enabled")).waitFor();
      const value = async () => Number(await range.inputValue());
      const at = await value();
      assert.ok(at > 0 && at < Number(await range.getAttribute("max")), `${at}`);
      const shown = await eventually(
        "the frame there",
        () => step(viewer),
        (now) => now < early,
      );
      assert.equal(await told(), shown);

      // the session goes on meanwhile, and the picture stays
      await client.nextNotification("sim.status", ({ step: now }) => now > shown + 600);
      assert.equal(await step(viewer), shown);

      // frame by frame, by keys
      await page.keyboard.press(",");
      await page.keyboard.press(",");
      assert.equal(await value(), at - 2);
      await page.keyboard.press(".");
      assert.equal(await value(), at - 1);
      await range.focus();
      await page.keyboard.press("ArrowLeft");
      assert.equal(await value(), at - 2);
      const chosen = await told();
      await eventually(
        "the frame before",
        () => step(viewer),
        (now) => now === chosen,
      );
      const positions = await viewer.positions();

      // live again, and back
      await page.keyboard.press("Escape");
      await eventually(
        "the present",
        () => step(viewer),
        (now) => now > shown + 500,
      );
      await lookBack(0.25);
      await eventually(
        "the past",
        () => step(viewer),
        (now) => now < early,
      );
      const [from, was] = [await told(), await viewer.positions()];
      assert.notDeepEqual(was, positions);
      await press(page.getByRole("button", { name: "Go on from here" }));
      await page.locator(".notice", { hasText: "Back at" }).waitFor();
      await client.nextNotification("sim.status", ({ step: now, playing }) => now === from && !playing);
      assert.equal((await scene()).gravity[1], -9.8);
      await eventually(
        "the frame of the server",
        () => step(viewer),
        (now) => now === from,
      );
      assert.deepEqual(await viewer.positions(), was);

      // taken back: the run as it was, with its scene, its frames and its pace
      await page.getByRole("button", { name: /^Undo: Go on from \d/ }).waitFor();
      if (hasTouch) await press(page.getByRole("button", { name: /^Undo: to \d/ }));
      else await page.keyboard.press("Control+z");
      const back = await client.nextNotification("sim.status", ({ step: now }) => now > shown + 600);
      assert.equal((await scene()).gravity[1], -3);
      await client.nextNotification("sim.status", ({ step: now, playing }) => playing && now > back.step);
      await viewer.until((then) => window.clothlab.lastFrame.header.step > then, back.step);
      const all = Number(await range.getAttribute("max"));
      assert.ok(all > at, `${all} frames on the bar`);
      await lookBack(0.25);
      await eventually(
        "the past again",
        () => step(viewer),
        (now) => now < early,
      );
      const second = await told();
      await press(page.getByRole("button", { name: "Go on from here" }));
      await client.nextNotification("sim.status", ({ step: now, playing }) => now === second && !playing);
      await page.locator(".notice", { hasText: "Back at" }).waitFor();
      // another viewer goes back, too: that is what could be undone now, by him
      await client.request("timeline.resume", { step: second - 10 });
      await page.locator(".notice", { hasText: "Back at" }).waitFor({ state: "detached" });
      await page.getByRole("button", { name: "Play", exact: true }).waitFor();
      await page.keyboard.press("Space");
      await eventually(
        "it goes on",
        () => step(viewer),
        (now) => now > second + 50,
      );
      await press(page.getByRole("button", { name: "Timeline" }));
      await page.locator("#timeline").waitFor({ state: "hidden" });
    },
  );
