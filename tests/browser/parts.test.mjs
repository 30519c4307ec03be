// Cloths, pins and bodies are added and removed in the panel, each as one change with a way back.
import assert from "node:assert/strict";
import { join } from "node:path";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";

const { both } = withServer();

for (const [size, window] of [
  ["desktop", { width: 1440, height: 900 }],
  ["phone", { width: 390, height: 844, hasTouch: true }],
])
  browserTest(`${size}: bodies, pins and cloths come and go by buttons, and Undo brings them back`, async () => {
    const { viewer, client, scene } = await both(`parts-${size}`, { ...window, paused: true });
    const { page } = viewer;
    const before = await scene();
    if (size === "phone") await page.getByRole("button", { name: "Parameters" }).click();
    const press = (name) => page.getByRole("button", { name, exact: true }).click();
    const undo = () => page.locator(".notice").getByRole("button", { name: "Undo" }).click();
    const revision = async () => (await client.request("scene.get", {})).revision;
    const open = (title) => page.locator(`.lil-closed > .lil-title:text-is("${title}")`).click();

    assert.equal(
      await page.getByRole("button", { name: "Remove cloth", exact: true }).count(),
      0,
      "the last one stays",
    );
    for (const [name, kind] of [
      ["Sphere", "sphere"],
      ["Box", "box"],
      ["Capsule", "capsule"],
      ["Floor", "plane"],
    ]) {
      const count = (await scene()).colliders.length;
      const was = await revision();
      await press(name);
      const { colliders } = await eventually(`a ${kind}`, scene, (now) => now.colliders.length === count + 1);
      assert.ok(kind in colliders[count]);
      const called = name.toLowerCase();
      assert.equal(
        colliders[count].name,
        colliders.slice(0, count).some((each) => each.name === called) ? `${called}-2` : called,
      );
      assert.equal(await revision(), was + 1);
      if (kind !== "plane")
        await page.locator(".hand-hint", { hasText: `${colliders[count].name}: move it by its handles` }).waitFor();
    }
    await undo();
    await eventually("no floor", scene, ({ colliders }) => !colliders.some((each) => "plane" in each));
    await page.screenshot({ path: join(screenshots, `parts-${size}.png`) });
    const named = (await scene()).colliders.at(-1).name;
    await open(`Collider: ${named}`);
    await press(`Remove ${named}`);
    await eventually("no capsule", scene, ({ colliders }) => !colliders.some(({ name }) => name === named));
    const inside = await page.evaluate(() => document.activeElement.closest("#panel") !== null);
    assert.ok(inside, "the focus stays in the panel");
    await undo();
    await eventually("the capsule again", scene, ({ colliders }) => colliders.some(({ name }) => name === named));

    const pins = before.cloths[0].pins;
    await press("Pin the top edge");
    const edge = (now) => now.cloths[0].pins.some(({ at }) => at === "edge:row:0");
    await eventually("the edge's pin", scene, edge);
    await page.getByRole("button", { name: "Pin the top edge" }).waitFor({ state: "detached" });
    await open("Pin edge:row:0");
    await press("Remove pin edge:row:0");
    await eventually("the pins as before", scene, ({ cloths }) => cloths[0].pins.length === pins.length);
    await open("2 pins");
    await press("Remove these 2 pins");
    await eventually("no pins", scene, ({ cloths }) => cloths[0].pins.length === 0);
    await undo();
    await eventually("the pins again", scene, ({ cloths }) => cloths[0].pins.length === 2);
    assert.deepEqual((await scene()).cloths[0].pins, pins);

    await press("Cloth");
    const two = await eventually("another cloth", scene, ({ cloths }) => cloths.length === 2);
    assert.deepEqual(two.cloths[1].material, two.cloths[0].material);
    await viewer.until(() => window.clothlab.lastFrame.header.vertexCount === 1250);
    await press("Remove cloth");
    await eventually("one cloth", scene, ({ cloths }) => cloths.length === 1);
    await undo();
    assert.deepEqual((await eventually("both", scene, ({ cloths }) => cloths.length === 2)).cloths, two.cloths);
    await client.close();
  });

browserTest("a part that the scene cannot have is refused with the reason, and nothing changes", async () => {
  const { viewer, client, scene } = await both("parts-refused");
  const colliders = Array.from({ length: 64 }, () => ({ sphere: { center: [0, -5, 0], radius: 0.1 } }));
  await client.request("scene.patch", { patch: { colliders } });
  await eventually(
    "the page",
    () => viewer.read("document"),
    (now) => now.colliders.length === 64,
  );
  await viewer.page.getByRole("button", { name: "Sphere", exact: true }).click();
  await viewer.page.locator(".notice", { hasText: "Not done" }).filter({ hasText: "/colliders" }).waitFor();
  assert.equal((await scene()).colliders.length, 64);
});
