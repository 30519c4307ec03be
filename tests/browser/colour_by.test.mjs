// Colour by: the cloth in the colours of a field, and the legend that says what they mean.
import assert from "node:assert/strict";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";

const here = withServer();

/// How much of the cloth's red the picture at rest has [pixels].
async function red(viewer) {
  await viewer.still();
  return (await viewer.cloth()).count;
}
const choice = (viewer) => viewer.page.getByRole("combobox", { name: "Colour by" });
const legend = (viewer) => viewer.page.getByRole("group", { name: "Legend" });
const range = (viewer) => viewer.page.evaluate(() => window.clothlab.lastFrame.header.range);
const subscriptions = (page) => {
  const asked = [];
  page.on("websocket", (socket) =>
    socket.on("framesent", ({ payload }) => {
      if (typeof payload === "string" && payload.includes("stream.subscribe")) asked.push(JSON.parse(payload).params);
    }),
  );
  return asked;
};

for (const [width, height] of [
  [1280, 800],
  [390, 844],
])
  browserTest(
    `at ${width}x${height} the choice colours the cloth, and the legend says what the colours mean`,
    async () => {
      const viewer = await here.open({ sharp: true, session: `colour-by-${width}`, width, height });
      await viewer.until(() => window.clothlab.simTime > 0.9);
      await viewer.pause();
      assert.equal(await legend(viewer).isVisible(), false);
      assert.equal(await range(viewer), 0);
      const before = await red(viewer);
      assert.ok(before > 1000, `${before} red pixels`);

      for (const [field, says] of [
        ["strain", /^Strain\s*0\s*[\d.]+ %$/],
        ["speed", /^Speed\s*0\s*[\d.]+ m\/s$/],
        ["contact", /^Contact\s*free\s*touching$/],
      ]) {
        await choice(viewer).selectOption(field);
        await eventually(
          field,
          () => legend(viewer).textContent(),
          (text) => says.test(text.trim()),
        );
        assert.ok((await range(viewer)) > 0);
        await eventually(
          `red pixels of ${before} with ${field}`,
          () => red(viewer),
          (count) => count < 0.05 * before,
        );
        const [bar, box] = [await viewer.page.locator("#transport").boundingBox(), await legend(viewer).boundingBox()];
        assert.ok(
          box.x >= 0 && box.x + box.width <= width && box.y + box.height <= bar.y,
          "the legend is above the bar",
        );
        assert.ok(bar.x >= 0 && bar.x + bar.width <= width, "the bar is in the window");
        await viewer.page.screenshot({ path: `${screenshots}colour-by-${field}-${width}x${height}.png` });
      }

      await choice(viewer).selectOption("cloth");
      await eventually(
        "no legend",
        () => legend(viewer).isVisible(),
        (visible) => !visible,
      );
      await eventually(
        `red pixels of ${before}, as before`,
        () => red(viewer),
        (count) => count > 0.8 * before,
      );
      assert.equal(await range(viewer), 0);
    },
  );

browserTest("the page asks for a field only with a choice other than cloth, and remembers the choice", async () => {
  const viewer = await here.open({ session: "colour-by-kept" });
  const asked = subscriptions(viewer.page);
  await viewer.page.reload();
  await viewer.until(() => window.clothlab?.framesDrawn > 1);
  assert.deepEqual(asked, [{ encoding: "q16", rate: 60, in_flight: 2 }]);
  await choice(viewer).selectOption("speed");
  await legend(viewer).waitFor();
  assert.equal(asked.at(-1).field, "speed");
  await viewer.page.reload();
  await legend(viewer).waitFor();
  assert.equal(await choice(viewer).inputValue(), "speed");
  assert.equal(asked.length, 3, "a reload asks once");
  assert.equal(asked[2].field, "speed");
  await choice(viewer).selectOption("cloth");
  await eventually(
    "asked for none",
    async () => asked.length,
    (count) => count === 4,
  );
  assert.deepEqual(asked[3], { encoding: "q16", rate: 60, in_flight: 2 });
  await viewer.page.reload();
  await viewer.until(() => window.clothlab?.framesDrawn > 1);
  assert.equal(await choice(viewer).inputValue(), "");
});

browserTest("the choice is made with the keyboard, and a new topology keeps it", async () => {
  const viewer = await here.open({ session: "colour-by-keys" });
  await choice(viewer).focus();
  await viewer.page.keyboard.press("ArrowDown");
  await legend(viewer).waitFor();
  assert.match(await legend(viewer).textContent(), /Strain/);
  await (await viewer.slider("Cloth", "rows")).fill("12");
  await viewer.until(() => window.clothlab.lastFrame.header.vertexCount === 25 * 12);
  assert.ok((await range(viewer)) > 0);
  assert.equal(await legend(viewer).isVisible(), true);
  assert.deepEqual(
    viewer.complaints.filter((text) => !/GPU stall|GL Driver Message/.test(text)),
    [],
  );
});
