// A cloth is moved, turned and scaled at its start: by handles, by keys, by numbers; copied, removed, undone.
import assert from "node:assert/strict";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { thorough } from "../thorough.mjs";
import { small } from "./small.mjs";

const { both } = withServer();

/// A page on a small cloth, and the cloth as the server has it.
async function opened(session, options) {
  const all = await both(session, { width: 1440, height: 900, sharp: thorough, ...options });
  await all.client.request("scene.load", { scene: small });
  await all.viewer.until(() => window.clothlab.document?.name === "small");
  return { ...all, cloth: async (index = 0) => (await all.scene()).cloths[index] };
}
const hint = ({ page }) => page.locator('.hand-hint[data-of="body"]');
const near = (found, wanted, most) => {
  for (const [axis, value] of wanted.entries())
    assert.ok(Math.abs(found[axis] - value) <= most, `${found} is not within ${most} of ${wanted}`);
};
async function chosen(viewer) {
  await viewer.page.getByRole("button", { name: "Move by handles" }).click();
  await hint(viewer).filter({ hasText: "cloth: move it" }).waitFor();
  await viewer.until(() => window.clothlab.step === 0);
  await viewer.still();
}
/// The middle of a box of places.
const middleOf = (places) =>
  [0, 1, 2].map((axis) => {
    const along = places.map((place) => place[axis]);
    return (Math.min(...along) + Math.max(...along)) / 2;
  });

browserTest(
  "the button brings the start and handles; a drag moves the cloth there, and one undo brings it back",
  async () => {
    const { viewer, client, cloth } = await opened("drag");
    const { page } = viewer;
    await chosen(viewer);
    // where the handle along y is: its arrow begins at the cloth's middle
    const start = await viewer.positions();
    const at = await page.evaluate((middle) => {
      const { camera, canvas } = window.clothlab.stage;
      const seen = (place) => {
        const point = window.clothlab.stage.controls.target.clone().fromArray(place).project(camera);
        return [((point.x + 1) / 2) * canvas.clientWidth, ((1 - point.y) / 2) * canvas.clientHeight];
      };
      return [seen(middle), seen([middle[0], middle[1] + 0.1, middle[2]])];
    }, middleOf(start));
    const [[x, y], [, up]] = at;
    const length = y - up; // of 0.1 m on the screen
    await page.mouse.move(x, y - 0.6 * length);
    await page.screenshot({ path: `${screenshots}cloth-handles.png` });
    await page.mouse.down();
    await page.mouse.move(x, y - 1.6 * length, { steps: 5 });
    await page.screenshot({ path: `${screenshots}cloth-handles-dragged.png` });
    await page.mouse.up();
    const moved = await eventually("moved", cloth, ({ transform }) => transform.translate[1] > 1.05);
    near(moved.transform.translate, [0, 1.1, 0], 0.03);
    assert.deepEqual([moved.transform.rotate, moved.transform.scale], [[0, 0, 0], 1]);
    await eventually("the picture", viewer.positions.bind(viewer), (now) => now[0][1] > start[0][1] + 0.05);
    await page.keyboard.press("Control+z");
    await eventually("back", cloth, ({ transform }) => transform.translate[1] === 1);
    await client.close();
  },
);

browserTest("by keys it moves, turns and grows about its middle", async () => {
  const { viewer, client, cloth } = await opened("keys");
  const { page } = viewer;
  await chosen(viewer);
  const before = middleOf(await viewer.positions());
  await page.keyboard.press("t");
  await hint(viewer).filter({ hasText: "turn it" }).waitFor();
  await page.keyboard.press("ArrowRight");
  const turned = await eventually("turned", cloth, ({ transform }) => transform.rotate.some((angle) => angle !== 0));
  await page.keyboard.press("t");
  await hint(viewer).filter({ hasText: "scale it" }).waitFor();
  await page.keyboard.press("ArrowUp");
  const grown = await eventually("grown", cloth, ({ transform }) => transform.scale !== 1);
  assert.equal(grown.transform.scale, 1.05);
  assert.deepEqual(grown.transform.rotate, turned.transform.rotate);
  // the mesh's middle is at (0, 0, 0.5): it has stayed where it was, as far as frames and the document tell
  const places = await eventually(
    "the picture",
    viewer.positions.bind(viewer),
    (now) => Math.hypot(...[0, 1, 2].map((axis) => now[48][axis] - now[0][axis])) > 1.04 * Math.SQRT2,
  );
  near(middleOf(places), before, 2e-3);
  await page.keyboard.press("Escape");
  await hint(viewer).waitFor({ state: "hidden" });
  await client.close();
});

browserTest("at its start a click on the cloth gives it handles; while it moves, a click does not", async () => {
  const { viewer, client } = await opened("click");
  const { page } = viewer;
  await page.getByRole("button", { name: "Pause", exact: true }).click();
  await page.getByRole("button", { name: "Reset", exact: true }).click();
  await viewer.until(() => window.clothlab.step === 0);
  await viewer.still();
  const [x, y] = await page.evaluate(
    (middle) => {
      const { camera, canvas, controls } = window.clothlab.stage;
      const point = controls.target.clone().fromArray(middle).project(camera);
      return [((point.x + 1) / 2) * canvas.clientWidth, ((1 - point.y) / 2) * canvas.clientHeight];
    },
    middleOf(await viewer.positions()),
  );
  await page.mouse.click(x, y);
  await hint(viewer).filter({ hasText: "cloth: move it" }).waitFor();
  await page.keyboard.press("Escape");
  await client.request("sim.step", { steps: 1 });
  await viewer.until(() => window.clothlab.step === 1);
  await page.mouse.click(x, y);
  await client.statuses(3);
  assert.ok(await hint(viewer).isHidden());
  await client.close();
});

browserTest("numbers in the panel, a copy beside it with its pins, its removal, and undo", async () => {
  const { viewer, client, scene, cloth } = await opened("numbers");
  const { page } = viewer;
  await client.request("sim.pause", {});
  await viewer.slider("Place", "scale");
  const height = viewer.number("Place", "place y");
  await height.fill("1.4");
  await height.press("Enter");
  await eventually("the number", cloth, ({ transform }) => transform.translate[1] === 1.4);
  await page.getByRole("button", { name: "Copy cloth", exact: true }).click();
  const { cloths } = await eventually("the copy", scene, (now) => now.cloths.length === 2);
  assert.equal(cloths[1].name, "cloth-2");
  assert.deepEqual(cloths[1].pins, cloths[0].pins);
  const [x, y] = cloths[1].transform.translate;
  assert.ok(x >= 1.1 && y === 1.4, `beside it: ${x}`);
  await page.screenshot({ path: `${screenshots}cloth-copied.png` });
  await page.getByRole("button", { name: "Remove cloth-2" }).click();
  await eventually("it is gone", scene, (now) => now.cloths.length === 1);
  await page.keyboard.press("Control+z");
  await eventually("it is there again", scene, (now) => now.cloths.length === 2);
  await client.close();
});
