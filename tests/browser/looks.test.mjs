import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";

const here = withServer();

/// Visible controls and cards that stick out of the window, and text cut off inside them.
const cutOff = () => {
  const problems = [];
  const visible = (node) => node.checkVisibility({ visibilityProperty: true, opacityProperty: true });
  for (const node of document.querySelectorAll(
    ".card, .card button, .card select, #headline-fps, #headline-rtf, .brand",
  )) {
    if (!visible(node)) continue;
    const { left, top, right, bottom } = node.getBoundingClientRect();
    const inPanel = node.closest(".panel-body"); // the panel's body scrolls
    if (left < 0 || right > innerWidth + 0.5 || (!inPanel && (top < 0 || bottom > innerHeight + 1))) {
      problems.push(`${node.id || node.className} at ${[left, top, right, bottom].map(Math.round)}`);
    }
  }
  for (const node of document.querySelectorAll(".lil-name, .lil-title, .note, .gauge-line, dt, #applied")) {
    if (visible(node) && node.scrollWidth > node.clientWidth + 1) problems.push(`"${node.textContent}" is cut off`);
  }
  if (document.documentElement.scrollWidth > innerWidth) problems.push("the page scrolls sideways");
  return problems;
};

for (const [width, height] of [
  [1280, 800],
  [360, 740],
]) {
  for (const colorScheme of ["dark", "light"]) {
    browserTest(`at ${width}x${height}, ${colorScheme}, nothing is cut off and the console is silent`, async () => {
      const viewer = await here.open({
        sharp: true,
        session: `looks-${width}-${colorScheme}`,
        width,
        height,
        colorScheme,
      });
      await viewer.until(() => window.clothlab.simTime > 1.1);
      await viewer.pause();
      assert.equal(await viewer.page.evaluate(() => document.documentElement.dataset.theme), colorScheme);
      assert.deepEqual(await viewer.page.evaluate(cutOff), []);
      await viewer.page.screenshot({ path: `${screenshots}${width}x${height}-${colorScheme}.png` });
      if (width < 700) {
        await viewer.page.getByRole("button", { name: "Parameters" }).click();
        await viewer.page.waitForTimeout(900);
        assert.deepEqual(await viewer.page.evaluate(cutOff), []);
        assert.ok(await (await viewer.slider("Cloth", "structural")).isVisible());
        await viewer.page.screenshot({ path: `${screenshots}${width}x${height}-${colorScheme}-parameters.png` });
      }
      await viewer.page.getByRole("combobox", { name: "method" }).selectOption("PBD"); // PBD has the most notes
      await eventually(
        "notes",
        () => viewer.page.locator(".note:visible").count(),
        (count) => count === 4,
      );
      assert.deepEqual(await viewer.page.evaluate(cutOff), []);
      await viewer.page.screenshot({ path: `${screenshots}${width}x${height}-${colorScheme}-pbd.png` });
      const forbidden = viewer.complaints.filter((text) => !/GPU stall|GL Driver Message/.test(text));
      assert.deepEqual(forbidden, [], "no violation of the content security policy, no error, no warning");
    });
  }
}

browserTest("every control is reachable by Tab, and has a name", async () => {
  const viewer = await here.open({ session: "tab", width: 1280, height: 800 });
  const reached = new Set();
  for (let i = 0; i < 90; ++i) {
    await viewer.page.keyboard.press("Tab");
    reached.add(
      await viewer.page.evaluate(() => {
        const node = document.activeElement;
        return (
          node?.getAttribute("aria-label") ?? node?.getAttribute("aria-labelledby") ?? node?.textContent?.trim() ?? ""
        );
      }),
    );
  }
  for (const name of [
    "Pause",
    "Step",
    "Reset",
    "Speed",
    "Colour by",
    "Fit the scene",
    "Dark or light",
    "Help",
    "structural [N/m]",
    "time step [s]",
  ]) {
    assert.ok(
      [...reached].some((label) => label === name),
      `${name} is not among ${[...reached].join(", ")}`,
    );
  }
});

browserTest("the first look takes at most 200 kB, compressed by the server; the rest comes later", async () => {
  const viewer = await here.open({ session: "weight", newcomer: true });
  await viewer.page.waitForFunction(() => performance.getEntriesByName(`${location.origin}/scenes.json`).length > 0);
  const { first, later } = await viewer.page.evaluate(() => {
    const all = [...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")];
    const seen = all.map(({ name, startTime, encodedBodySize, decodedBodySize }) => {
      return { name: new URL(name).pathname, startTime, bytes: encodedBodySize, unpacked: decodedBodySize };
    });
    const before = ({ startTime }) => startTime <= window.clothlab.firstFrameAt;
    return { first: seen.filter(before), later: seen.filter((each) => !before(each)).map(({ name }) => name) };
  });
  const total = first.reduce((sum, { bytes }) => sum + bytes, 0);
  const list = first.map(({ name, bytes }) => `${name} ${bytes}`).join(", ");
  assert.ok(total > 100_000 && total <= 200_000, `${total} bytes: ${list}`);
  const script = first.find(({ name }) => name === "/app.js");
  assert.ok(script.bytes < 0.5 * script.unpacked, `the server compresses: ${list}`);
  assert.ok(later.includes("/scenes.json"), `${later} came later`);
  const folder = fileURLToPath(new URL("../../web/dist/", import.meta.url));
  // All but the player, which goes into recordings: the page does not load it; and each once, not compressed as well.
  const own = readdirSync(folder).filter((name) => name !== "player.html" && !name.endsWith(".br"));
  const all = own.reduce((sum, name) => sum + gzipSync(readFileSync(folder + name)).length, 0);
  assert.ok(all < 360_000, `all files together: ${all} bytes`);
});
