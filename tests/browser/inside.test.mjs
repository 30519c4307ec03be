// See inside: what is drawn over the cloth, the range of its colours, and the curves, by pointer, finger and key.
import assert from "node:assert/strict";
import { finiteElements } from "../protocol/inspected.mjs";
import { some } from "../thorough.mjs";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";

const here = withServer();

const card = ({ page }) => page.getByRole("region", { name: "See inside" });
const box = (viewer, name) => card(viewer).getByRole("checkbox", { name, exact: true });
const opener = ({ page }) => page.getByRole("button", { name: "See inside", exact: true });
async function open(viewer, press = (locator) => locator.click()) {
  await press(opener(viewer));
  await card(viewer).waitFor();
}
/// The methods that the page asks for.
const asked = (page) => {
  const methods = [];
  page.on("websocket", (socket) =>
    socket.on("framesent", ({ payload }) => {
      if (typeof payload === "string") methods.push(JSON.parse(payload).method);
    }),
  );
  return methods;
};
/// How many pixels of the picture differ from another one.
async function difference(viewer, before, after) {
  const helper = await viewer.page.context().browser().newPage();
  try {
    return await helper.evaluate(
      async (pictures) => {
        const [one, other] = await Promise.all(
          pictures.map(async (png) => {
            const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
            const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
            context.drawImage(image, 0, 0);
            return context.getImageData(0, 0, image.width, image.height).data;
          }),
        );
        let pixels = 0;
        for (let i = 0; i < one.length; i += 4)
          if ([0, 1, 2].some((k) => Math.abs(one[i + k] - other[i + k]) > 24)) pixels++;
        return pixels;
      },
      [before, after].map((png) => png.toString("base64")),
    );
  } finally {
    await helper.close();
  }
}
/// A screenshot of the cloth's part of the window, at rest.
async function picture(viewer, { width, height }) {
  await viewer.still();
  const clip =
    width < 700
      ? { x: 0, y: height * 0.55, width, height: height * 0.25 }
      : { x: width * 0.24, y: height * 0.05, width: width * 0.5, height: height * 0.8 };
  return viewer.page.screenshot({ clip });
}

for (const size of [
  { width: 1440, height: 900 },
  { width: 390, height: 844 },
]) {
  const name = `${size.width}x${size.height}`;
  const touch = size.width < 700;
  const press = (locator) => (touch ? locator.tap() : locator.click());
  browserTest(`at ${name} each overlay is drawn, and goes again, by ${touch ? "touch" : "pointer"}`, async () => {
    const viewer = await here.open({ sharp: true, session: `inside-${name}`, hasTouch: touch, ...size });
    await viewer.until(() => window.clothlab.simTime > 0.7);
    await viewer.pause();
    await open(viewer, press);
    const bare = await picture(viewer, size);
    // a label's text, and the card's, are the springs' alone
    for (const [overlay, least] of some(
      [
        ["Wireframe", 300],
        ["structural", 300],
        ["Normals", 150],
        ["shear", 300],
        ["bend", 300],
      ],
      2,
    )) {
      await press(box(viewer, overlay));
      const label = viewer.page.locator(".inside-label");
      if (overlay === overlay.toLowerCase()) {
        await eventually(
          "a label",
          () => label.textContent(),
          (text) => /^[+−][\d.]+ %$/.test(text),
        );
        assert.match(
          await card(viewer).textContent(),
          new RegExp(`Largest strain: .*, ${overlay} spring \\d+–\\d+\\.`),
        );
      }
      const changed = async () => difference(viewer, bare, await picture(viewer, size));
      await eventually(`pixels of ${overlay}`, changed, (pixels) => pixels > least);
      await viewer.page.screenshot({ path: `${screenshots}inside-${overlay}-${name}.png` });
      await press(box(viewer, overlay));
      await eventually(`pixels left of ${overlay}`, changed, (pixels) => pixels < 20);
      assert.equal(await label.isVisible(), false);
    }
    const [at, bar] = [await card(viewer).boundingBox(), await viewer.page.locator("#transport").boundingBox()];
    assert.ok(at.x >= 0 && at.x + at.width <= size.width && at.y + at.height <= bar.y, "the card is above the bar");
    const forbidden = viewer.complaints.filter((text) => !/GPU stall|GL Driver Message/.test(text));
    assert.deepEqual(forbidden, []);
  });
}

browserTest("the largest strain that the card tells is that of the server, to the rounding that it tells", async () => {
  const { viewer, client } = await here.both("inside-strain", { width: 1440, height: 900 });
  await viewer.until(() => window.clothlab.simTime > 0.9);
  await viewer.pause();
  const { max_strain } = await client.nextNotification("sim.status");
  await open(viewer);
  for (const kind of ["structural", "shear", "bend"]) await box(viewer, kind).click();
  const text = await eventually(
    "told",
    () => card(viewer).textContent(),
    (all) => /Largest strain/.test(all),
  );
  await viewer.page.waitForTimeout(600);
  const [, sign, percent, rounding] = /strain: ([+−])([\d.]+) % \(to ±([\d.]+) %\)/.exec(
    await card(viewer).textContent(),
  );
  const shown = (sign === "−" ? -1 : 1) * Number(percent);
  const bound = Number(rounding) * 1.1 + 0.051; // as it is written, and the last digit
  assert.ok(Math.abs(Math.abs(shown) - 100 * max_strain) <= bound, `${text}: ${100 * max_strain}`);
  await client.close();
});

browserTest("finite elements are offered where the scene has them, springs where it has those", async () => {
  const { viewer, client } = await here.both("inside-fem", { width: 1440, height: 900 });
  await open(viewer);
  await box(viewer, "structural").waitFor();
  assert.equal(await box(viewer, "Elements").isVisible(), false);
  await client.request("scene.patch", {
    patch: finiteElements,
  });
  await box(viewer, "Elements").click();
  await eventually(
    "an element",
    () => card(viewer).textContent(),
    (text) => /Largest strain: .*, element \d+–\d+–\d+\./.test(text),
  );
  assert.equal(await box(viewer, "structural").isVisible(), false);
  await client.close();
});

browserTest(
  "contact pairs are asked for only while they are shown, follow the session, and are of the present alone",
  async () => {
    const { viewer, client } = await here.both("inside-contacts", { width: 1440, height: 900, sharp: true });
    const methods = asked(viewer.page);
    await client.request("scene.load", { preset: "drape" });
    await viewer.page.reload();
    await viewer.until(() => window.clothlab?.simTime > 1);
    await open(viewer);
    const count = (method) => methods.filter((each) => each === method).length;
    assert.deepEqual([count("inspect.contacts"), count("inspect.springs")], [0, 0], "nothing is asked for");
    await box(viewer, "Contact pairs").click();
    await eventually(
      "pairs",
      () => card(viewer).textContent(),
      (text) => /\d+ pairs[:,].*on solids/.test(text),
    );
    await eventually(
      "goes on asking",
      async () => count("inspect.contacts"),
      (asks) => asks >= 4,
    );
    await viewer.page.screenshot({ path: `${screenshots}inside-contacts-1440x900.png` });
    await viewer.page.getByRole("button", { name: "Timeline" }).click();
    await viewer.page.waitForTimeout(600);
    await viewer.page.keyboard.press(",");
    await eventually(
      "looks back",
      () => card(viewer).textContent(),
      (text) => /Of the present alone/.test(text),
    );
    await viewer.page.getByRole("button", { name: "Live" }).click();
    await eventually(
      "live again",
      () => card(viewer).textContent(),
      (text) => /\d+ pairs/.test(text),
    );
    await box(viewer, "Contact pairs").click();
    await viewer.page.waitForTimeout(700);
    const before = count("inspect.contacts");
    await viewer.page.waitForTimeout(1500);
    assert.equal(count("inspect.contacts"), before, "asks no longer");
    await client.close();
  },
);

browserTest("the overlays are where a frame of the timeline has the cloth", async () => {
  const viewer = await here.open({ session: "inside-past", width: 1440, height: 900 });
  await open(viewer);
  await box(viewer, "structural").click();
  await viewer.until(() => window.clothlab.simTime > 1.2);
  await viewer.page.getByRole("button", { name: "Timeline" }).click();
  const slider = viewer.page.getByRole("slider", { name: "Moment of the last minute" });
  await slider.focus();
  await viewer.page.keyboard.press("Home");
  await viewer.until(() => window.clothlab.simTime < 0.5);
  await viewer.page.waitForTimeout(500);
  // The label's place against the positions that the frame has: one of them is at both ends' middle.
  const off = await viewer.page.evaluate(() => {
    const { stage } = window.clothlab;
    const label = new DOMMatrix(getComputedStyle(document.querySelector(".inside-label")).transform);
    const [, a, b] = /spring (\d+)–(\d+)/.exec(document.querySelector("#inside").textContent).map(Number);
    const { header, buffer } = window.clothlab.lastFrame;
    const words = new Uint16Array(buffer, 64, header.vertexCount * 4);
    const at = (vertex) =>
      [0, 1, 2].map((k) => header.boxMinimum[k] + (header.boxExtent[k] * words[4 * vertex + k]) / 65535);
    const middle = stage.camera.position
      .clone()
      .set(...at(a).map((x, k) => (x + at(b)[k]) / 2))
      .project(stage.camera);
    const { clientWidth: width, clientHeight: height } = stage.canvas;
    return Math.hypot(label.e - (0.5 + 0.5 * middle.x) * width, label.f - (0.5 - 0.5 * middle.y) * height);
  });
  assert.ok(off < 1, `${off} pixels off`);
});

browserTest("the range of the colours is fixed and automatic again, is kept, and a wrong one is refused", async () => {
  const viewer = await here.open({ session: "inside-range", width: 1440, height: 900 });
  const { page } = viewer;
  const most = page.locator("#legend-most");
  await open(viewer);
  await page.getByRole("combobox", { name: "Colour by" }).selectOption("speed");
  const typed = card(viewer).getByRole("textbox", { name: "Largest speed [m/s]" });
  await typed.fill("4,5");
  await typed.press("Enter");
  await eventually(
    "fixed",
    () => most.textContent(),
    (text) => text === "≥ 4.5 m/s",
  );
  assert.equal(await card(viewer).getByRole("radio", { name: "0 to" }).isChecked(), true);
  await typed.fill("fast");
  await typed.press("Enter");
  await eventually(
    "refused",
    () => card(viewer).textContent(),
    (text) => text.includes("“fast” is no range"),
  );
  assert.equal(await most.textContent(), "≥ 4.5 m/s");
  await page.reload();
  await viewer.until(() => window.clothlab?.framesDrawn > 2);
  await eventually(
    "kept",
    () => most.textContent(),
    (text) => text === "≥ 4.5 m/s",
  );
  await viewer.pause();
  await open(viewer);
  await card(viewer).getByRole("radio", { name: "automatic" }).check();
  await eventually(
    "automatic",
    () => most.textContent(),
    (text) => /^[\d.]+ m\/s$/.test(text),
  );
  await page.getByRole("combobox", { name: "Colour by" }).selectOption("contact");
  await eventually(
    "no range",
    () => card(viewer).getByRole("radio").count(),
    (radios) => radios === 0,
  );
});

browserTest("the curves show the last minute with their numbers, and each energy can be taken out", async () => {
  const viewer = await here.open({ session: "inside-curves", width: 1440, height: 900 });
  const { page } = viewer;
  await viewer.until(() => window.clothlab.simTime > 1.5);
  await open(viewer);
  const energy = card(viewer).getByRole("table", { name: "Energy in the last minute" });
  await eventually(
    "numbers",
    () => energy.textContent(),
    (text) => /kinetic[\d.−]+ [nmµk]?J/.test(text),
  );
  assert.match(
    await card(viewer).getByRole("table", { name: "Largest strain in the last minute" }).textContent(),
    /strain[\d.]+ %/,
  );
  const drawn = () =>
    page.evaluate(() => {
      const canvas = document.querySelector(".inside-chart canvas");
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return data.reduce((sum, value, i) => sum + (i % 4 === 3 && value > 0 ? 1 : 0), 0);
    });
  assert.ok((await drawn()) > 100);
  const kinetic = card(viewer).getByRole("button", { name: "kinetic" });
  await kinetic.focus();
  await page.keyboard.press("Enter");
  assert.equal(await kinetic.getAttribute("aria-pressed"), "false");
  await page.getByRole("button", { name: "Reset" }).click();
  await page.waitForTimeout(600);
  assert.ok((await drawn()) > 100);
});

browserTest(
  "I opens the card, its choices are made by key and kept, Escape closes it; nothing is loaded before",
  async () => {
    const viewer = await here.open({ session: "inside-keys", width: 1440, height: 900 });
    const { page } = viewer;
    const loaded = () =>
      page.evaluate(() =>
        performance.getEntriesByType("resource").some(({ name }) => /inside[^/]*\.(js|css)$/.test(name)),
      );
    assert.equal(await loaded(), false);
    await page.keyboard.press("i");
    await card(viewer).waitFor();
    assert.equal(await loaded(), true);
    await page.waitForFunction(() => document.activeElement?.closest("#inside"));
    await page.keyboard.press(" ");
    assert.equal(await box(viewer, "Wireframe").isChecked(), true);
    await page.keyboard.press("Escape");
    await card(viewer).waitFor({ state: "hidden" });
    assert.equal(await page.evaluate(() => document.activeElement?.id), "inside-open");
    await page.reload();
    await viewer.until(() => window.clothlab?.framesDrawn > 2);
    await eventually("loaded for the wireframe", loaded, (is) => is);
    assert.equal(await card(viewer).isVisible(), false, "what was chosen is drawn without the card");
    await page.keyboard.press("i");
    await card(viewer).waitFor();
    assert.equal(await box(viewer, "Wireframe").isChecked(), true);
  },
);
