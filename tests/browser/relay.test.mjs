import assert from "node:assert/strict";
import { NatsServer, noBus } from "../protocol/bus.mjs";
import { Server } from "../protocol/harness.mjs";
import { browserTest, withBrowser } from "./browser.mjs";

const { open } = withBrowser();

browserTest("the page of a relay draws the cloth and offers nothing that a relay cannot do", async (t) => {
  const why = noBus();
  if (why) return t.skip(why);
  const bus = await NatsServer.start();
  const server = await Server.start("--publish", bus.url, "--scene", "mannequin");
  const relay = await Server.launch("relay", "--from", bus.url);
  try {
    const viewer = await open(relay);
    const { page } = viewer;
    await viewer.figures();
    assert.equal(await page.locator("#scene-name").innerText(), "mannequin");
    for (const id of ["#save-model", "#inside-open", "#record"])
      assert.equal(await page.locator(id).isVisible(), false);
    assert.equal(await page.locator("#save-picture").isVisible(), true);
  } finally {
    for (const each of [relay, server]) await each.stop();
    await bus.stop();
  }
});
