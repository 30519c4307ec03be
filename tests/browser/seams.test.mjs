// A mesh whose file has other numbers of vertices than frames do, as along the seams of a texture: pins that the hand
// sets in the page, and the markers of pins.
import assert from "node:assert/strict";
import { seamed } from "../protocol/seamed.mjs";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { complaints, distance, handsOf, hint, near, placeOf, seen, still } from "./hands.mjs";
import { drag } from "./opening.mjs";

const { both } = withServer();

const columns = 13;
const sheet = seamed(columns);
const inFrame = (column, row) => sheet.inFrames[sheet.numberAt(column, row)];

/// Drops the sheet on the page, held at its upper edge.
async function dropped(session) {
  const opened = await both(session, { width: 1440, height: 900 });
  const { page } = opened.viewer;
  await drag(page, ["dragenter", "dragover", "drop"], [["sheet.gltf", sheet.gltf]]);
  const dialog = page.getByRole("dialog", { name: "Open sheet.gltf" });
  await dialog.waitFor();
  await dialog.getByRole("combobox", { name: "unit" }).selectOption("m");
  await dialog.getByLabel("held at").selectOption("top");
  await dialog.getByRole("button", { name: "Open", exact: true }).click();
  const shown = (more) =>
    eventually(
      "the sheet",
      () => page.evaluate(() => [window.clothlab.lastFrame?.header.vertexCount, window.clothlab.step]),
      ([vertices, step]) => vertices === sheet.vertices && step >= more,
    );
  await shown(0);
  await shown(4);
  await opened.client.request("stream.subscribe", { encoding: "f32", rate: 30 });
  return opened;
}
/// The vertices in frames that have the marker of a pin.
const markers = (viewer) =>
  viewer.page.evaluate(() => [...(window.clothlab.stage.cloth.markers?.geometry.index.array ?? [])]);
const sorted = (list) => [...list].sort((a, b) => a - b);
const upperEdge = Array.from({ length: columns }, (_, column) => inFrame(column, 0));

browserTest(
  "P pins the vertex that is held by its number in the file, and markers stand at their vertices",
  async () => {
    const { viewer, client, scene } = await dropped("seam");
    const { mouse, keyboard } = viewer.page;
    await eventually(
      "markers along the upper edge",
      () => markers(viewer),
      (at) => `${sorted(at)}` === `${sorted(upperEdge)}`,
    );
    const pins = (await scene()).cloths[0].pins.length;
    const wanted = inFrame(9, 8);
    await still(viewer, wanted);
    const from = await seen(viewer, wanted);
    await mouse.move(from.x, from.y);
    await mouse.down();
    const held = (await handsOf(client, (all) => all.length === 1)).hands[0].vertex;
    const number = sheet.inFrames.indexOf(held);
    assert.notEqual(number, held, "in the second panel the file has other numbers");
    const goal = { x: from.x + 40, y: from.y - 60 };
    await mouse.move(goal.x, goal.y, { steps: 6 });
    await near(viewer, held, goal, "the vertex follows");
    await keyboard.press("p");
    const now = await eventually("the pins", scene, ({ cloths }) => cloths[0].pins.length === pins + 1);
    await mouse.up();
    await handsOf(client, (all) => all.length === 0);
    const pin = now.cloths[0].pins[pins];
    assert.equal(pin.at, `vertex:${number}`);
    const { time } = await client.nextFrame();
    for (let i = 0; i < 10; ++i) assert.ok(distance(await placeOf(client, held), pin.place) < 1e-4, "it stays");
    assert.ok((await client.nextFrame()).time > time, "time goes on");
    await eventually(
      "a marker there, too",
      () => markers(viewer),
      (at) => `${sorted(at)}` === `${sorted([...upperEdge, held])}`,
    );
    await viewer.page.screenshot({ path: `${screenshots}seams-pin.png` });
    const marker = await seen(viewer, held);
    await mouse.click(marker.x, marker.y);
    assert.match(await hint(viewer).innerText(), /Delete or P takes it off/);
    await keyboard.press("Delete");
    const after = await eventually("the pins", scene, ({ cloths }) => cloths[0].pins.length === pins);
    assert.ok(
      after.cloths[0].pins.every(({ at }) => at !== pin.at),
      "the one that was chosen is off",
    );
    assert.deepEqual(complaints(viewer), []);
    await client.close();
  },
);
