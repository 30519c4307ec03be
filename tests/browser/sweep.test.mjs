// The page that `clothlab sweep --merge` writes, opened from the disk.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before } from "node:test";
import { violations } from "./axe.mjs";
import { browserTest, screenshots, withBrowser } from "./browser.mjs";

const here = withBrowser();
const folder = mkdtempSync(join(tmpdir(), "clothlab-sweep-page-"));
after(() => rmSync(folder, { recursive: true, force: true }));
const plan = {
  name: "</script> & co",
  scene: "hanging-strip",
  time: 0.1,
  measure: [],
  axes: [
    { at: "/solver/method", values: ["verlet", "rk4"] },
    { at: "/cloths/0/mesh/grid/rows", values: [11, 21] },
    { at: "/solver/dt", from: 0.0005, to: 0.002, count: 3, spacing: "log" },
  ],
};
before(() => {
  const sweep = (...args) => execFileSync(process.env.CLOTHLAB, ["sweep", ...args], { stdio: "pipe" });
  writeFileSync(join(folder, "plan.json"), JSON.stringify(plan));
  sweep(join(folder, "plan.json"), "--out", join(folder, "out"));
  sweep("--merge", join(folder, "out"));
});

async function open(options) {
  const context = await here.browser.newContext(options);
  const page = await context.newPage();
  const complaints = [];
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(error.message));
  await page.goto(`file://${join(folder, "out/sweep.html")}`);
  return { page, complaints };
}

browserTest("a sweep's page draws any two columns, filters, and says all of a point", async () => {
  const { page, complaints } = await open({ viewport: { width: 1000, height: 900 }, bypassCSP: true });
  assert.equal(await page.locator("h1").textContent(), plan.name);
  assert.deepEqual(await page.locator("#pictures a").allTextContents(), ["map.svg"]);
  const [marks, lines] = [page.locator(".point"), page.locator("#plot path")];
  await page.locator("select[name=x]").selectOption("dt");
  await page.locator("select[name=y]").selectOption("largest_strain");
  assert.equal(await marks.count(), 12);
  assert.equal(await lines.count(), 4); // one for each method and number of rows
  // Equal ratios have equal distances on a logarithmic scale.
  const x = await marks.evaluateAll((all) => all.slice(0, 3).map((mark) => Number(mark.getAttribute("cx"))));
  assert.ok(Math.abs(x[2] - x[1] - (x[1] - x[0])) < 1e-6 * (x[2] - x[0]), x.join(", "));
  await page.locator("select[name='only method']").selectOption("rk4");
  assert.equal(await marks.count(), 6);
  await marks.nth(1).focus();
  assert.match(await page.locator("#picked").textContent(), /method rk4, rows 11, dt 0.001, .*vertices 55/);
  await page.getByText("All points").click();
  await page.locator("tr").nth(12).waitFor(); // the table is made once it is unfolded
  assert.equal(await page.locator("tr").count(), 13);
  await page.screenshot({ path: join(screenshots, "sweep.png"), fullPage: true });
  assert.deepEqual(complaints, []);
});

for (const [width, colorScheme] of [
  [1000, "dark"],
  [390, "light"],
])
  browserTest(`a sweep's page, ${width} px wide and ${colorScheme}: axe-core finds nothing wrong`, async () => {
    const { page } = await open({ viewport: { width, height: 800 }, colorScheme, bypassCSP: true });
    assert.deepEqual(await violations({ page }, "page"), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true);
  });
