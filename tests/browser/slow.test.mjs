// What the page shows when a server cannot keep up. The server here is quick; its messages are held back.
import assert from "node:assert/strict";
import { thorough } from "../thorough.mjs";
import { browserTest, eventually, withServer } from "./browser.mjs";

const { both } = withServer();

/// Opens a page whose connection passes through `slow`: while it is on, no frames pass, and every status has its
/// factor.
async function throttled(session) {
  const link = { slow: false, frames: true, factor: 1 };
  const opened = await both(session);
  await opened.viewer.page.routeWebSocket("**/ws**", (page) => {
    const server = page.connectToServer();
    server.onMessage((message) => {
      if (Buffer.isBuffer(message)) {
        if (link.frames || message[0] !== 2) return page.send(message);
        // Acknowledges the dropped frame, so that the server goes on sending.
        server.send(
          JSON.stringify({ jsonrpc: "2.0", method: "stream.ack", params: { frame: message.readUInt32LE(8) } }),
        );
        return;
      }
      const text = JSON.parse(message);
      // The busy machine's own slowness must not count.
      if (text.method === "sim.status")
        Object.assign(text.params, { real_time_factor: link.slow ? link.factor : 1, asleep: false });
      page.send(JSON.stringify(text));
    });
  });
  await opened.viewer.page.reload();
  await opened.viewer.until(() => window.clothlab?.framesDrawn > 3);
  return { ...opened, link };
}

browserTest(
  "a page without pictures says so while that lasts, with what a step takes, and undoes its last change",
  async () => {
    const { viewer, client, scene, link } = await throttled("slow-still");
    const { version } = await client.notification("hello");
    assert.equal(await viewer.page.locator("#stats .version").textContent(), version);
    const box = viewer.page.locator("#slow");
    await box.waitFor({ state: "hidden" });
    const before = (await scene()).cloths[0].material.structural;
    const number = viewer.number("Cloth", "structural");
    await number.fill("12345");
    await number.press("Enter");
    await eventually("the change", scene, ({ cloths }) => cloths[0].material.structural === 12345);
    Object.assign(link, { slow: true, frames: false, factor: 5e-4 });
    await box.filter({ hasText: /No new picture for \d+ s/ }).waitFor({ state: "visible" });
    await box.filter({ hasText: "a step takes it 2 s" }).waitFor(); // 1 ms at that factor
    assert.equal(await viewer.page.locator("#stats .rtf").textContent(), "×0.0005");
    await viewer.page.waitForTimeout(thorough ? 10_000 : 1000); // the former is longer than any notice stays
    assert.ok(await box.isVisible());
    await box.getByRole("button", { name: "Undo" }).click();
    await eventually("the change undone", scene, ({ cloths }) => cloths[0].material.structural === before);
    Object.assign(link, { slow: false, frames: true });
    await box.waitFor({ state: "hidden" });
  },
);

browserTest("time that creeps is told of with its factor, a pause and a scene at rest are not", async () => {
  const { viewer, client, scene, link } = await throttled("slow-creeps");
  const box = viewer.page.locator("#slow");
  Object.assign(link, { slow: true, factor: 0.02 });
  await box.filter({ hasText: "Only ×0.02 of real time" }).waitFor({ state: "visible" });
  // Nothing has changed that could be undone: the one thing to do is a coarser cloth.
  assert.deepEqual(await box.getByRole("button").allInnerTexts(), ["Coarser cloth"]);
  await box.getByRole("button").click();
  await eventually("half the rows and columns", scene, ({ cloths: [{ mesh }] }) => mesh.grid.rows === 13);
  await eventually(
    "then an undo",
    () => box.getByRole("button").allInnerTexts(),
    ([only]) => only === "Undo",
  );
  assert.deepEqual(await viewer.page.locator(".notice", { hasText: "keep up" }).count(), 0);
  await client.request("sim.pause", {});
  await box.waitFor({ state: "hidden" });
  await viewer.page.waitForTimeout(4000); // paused: no pictures come, and nothing is wrong
  assert.equal(await box.isVisible(), false);
});
