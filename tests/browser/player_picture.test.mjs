// The page of a recording saves pictures of what it shows.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { decode, region } from "../cli/png.mjs";
import { browserTest, bytesOf, screenshots, withBrowser } from "./browser.mjs";

const here = withBrowser();
const folder = mkdtempSync(join(tmpdir(), "clothlab-player-"));
after(() => rmSync(folder, { recursive: true, force: true }));

browserTest("a picture of a recording has the size that is chosen, its subject in the middle", async () => {
  const film = join(folder, "film.html");
  const { status, stderr } = spawnSync(
    process.env.CLOTHLAB,
    ["record", "seed", "--time", "0.5", "--set", "/colliders=[]", "--out", film],
    { encoding: "utf8" },
  );
  assert.equal(status, 0, stderr);
  const context = await here.browser.newContext({
    viewport: { width: 400, height: 700 },
    reducedMotion: "reduce", // it shows the start
    acceptDownloads: true,
  });
  const page = await context.newPage();
  await page.goto(`file://${film}`);
  await page.waitForFunction(() => window.clothlab?.framesDrawn > 0);
  await page.getByLabel("Time").fill("6");
  await page.waitForFunction(() => document.getElementById("clock").textContent === "0.20 s");
  await page.getByTitle("Save a picture").click();
  await page.screenshot({ path: `${screenshots}player-picture-400x700.png` });
  await page.getByLabel("Clear").check();
  for (const [label, width, height] of [
    ["Square", 1080, 1080],
    ["1080p", 1920, 1080],
  ]) {
    await page.getByLabel("Size of the picture").selectOption({ label });
    const [download] = await Promise.all([
      page.waitForEvent("download"),
      page.getByRole("button", { name: "Save" }).click(),
    ]);
    assert.equal(download.suggestedFilename(), "seed-0.20s.png");
    const bytes = await bytesOf(download);
    writeFileSync(`${screenshots}player-picture-${label}.png`, bytes);
    const image = decode(bytes, true);
    assert.deepEqual([image.width, image.height], [width, height]);
    const seen = region(image, ([, , , opacity]) => opacity === 255);
    // The camera fits to the margin to a twentieth, as perspective makes the near side larger.
    const larger = Math.max((seen.right - seen.left) / width, (seen.bottom - seen.top) / height);
    assert.ok(larger > 0.85 && larger < 1, JSON.stringify(seen));
    assert.ok(Math.abs((seen.left + seen.right) / 2 / width - 0.5) < 0.03, JSON.stringify(seen));
    assert.ok(Math.abs((seen.top + seen.bottom) / 2 / height - 0.5) < 0.03, JSON.stringify(seen));
  }
  await context.close();
});
