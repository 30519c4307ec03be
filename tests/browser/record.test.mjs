// The button that records: what it saves plays without the server.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { browserTest, withServer } from "./browser.mjs";

const here = withServer();
const folder = mkdtempSync(join(tmpdir(), "clothlab-record-"));
after(() => rmSync(folder, { recursive: true, force: true }));

browserTest("Record and Stop make a page to save, which plays from the disk what was seen", async () => {
  const { viewer, client } = await here.both("recorded");
  const { page } = viewer;
  await page.click("#record");
  await page.waitForFunction(() => document.getElementById("record").textContent.startsWith("Stop recording"));
  const from = await viewer.read("simTime");
  await viewer.until((time) => window.clothlab.simTime > time + 1, from);
  await page.click("#record");
  await page.waitForSelector("#record-files:not([hidden])");
  assert.equal(await page.textContent("#record"), "Record");
  assert.equal((await client.request("record.get")).state, "ready");
  for (const [button, name] of [
    ["Save as page", "clothlab.html"],
    ["Save as .clothlab", "clothlab.clothlab"],
    ["Export .glb", "clothlab.glb"],
    ["Export .usda", "clothlab.usda"],
  ]) {
    const [download] = await Promise.all([page.waitForEvent("download"), page.click(`text=${button}`)]);
    const [, ending] = name.split(".");
    assert.match(download.suggestedFilename(), new RegExp(`^seed \\d+\\.\\d\\d-\\d+\\.\\d\\d s\\.${ending}$`));
    await download.saveAs(join(folder, name));
  }
  assert.deepEqual(
    viewer.complaints.filter((text) => !text.includes("GL Driver Message")),
    [],
  );
  const context = await page
    .context()
    .browser()
    .newContext({ viewport: { width: 900, height: 600 } });
  const saved = await context.newPage();
  await saved.goto(`file://${join(folder, "clothlab.html")}`);
  await saved.waitForFunction((time) => window.clothlab?.simTime > time + 0.5, from);
  await client.close();
});

browserTest("who comes later sees that the session is recorded, and may stop it", async () => {
  const { viewer, client } = await here.both("later");
  await client.request("record.start");
  await viewer.page.waitForFunction(() => document.getElementById("record").textContent.startsWith("Stop recording"));
  await viewer.page.click("#record");
  await viewer.page.waitForFunction(() => document.getElementById("record").textContent === "Record");
  assert.equal((await client.request("record.get")).state, "ready");
  await client.close();
});
