// The camera shows the whole scene in the part of the window that no card covers: at the start, while the cloth moves,
// when another preset is loaded, when a phone is turned, and on F.
import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { hiddenPoints } from "./hidden_points.mjs";

const here = withServer();
const sizes = [
  [390, 844],
  [844, 390],
  [1280, 720],
  [1920, 1080],
  [3840, 2160],
  [320, 568],
];
const pictures = !!process.env.FRAMING_PICTURES; // take pictures of all, for people to look at
const moments = pictures ? [0.4, 0.8, 1.4, 2.2, 3] : [0.5, 1.4]; // [s] simulated
const margin = 4; // [CSS pixels] between the cloth and an edge or a card

/// Turns drawing off: the tests read places only, and a software renderer would take most of the time.
const onlyPlace = () => {
  const { stage } = window.clothlab;
  stage.renderer.render = stage.groundShadow.draw = () => undefined;
};

async function check(viewer, moment, found = []) {
  for (const [width, height] of moment === "start" ? sizes : sizes.filter(([width]) => width < 1920)) {
    await viewer.page.setViewportSize({ width, height });
    // The layout changes at once; a sliding sheet or camera arrives a little later.
    const seen = await eventually(
      `${moment} at ${width}x${height}`,
      async () => {
        await viewer.page.waitForTimeout(60);
        return viewer.page.evaluate(hiddenPoints, margin);
      },
      ({ hidden, cut }) => hidden === 0 && cut === "",
    ).catch(async () => viewer.page.evaluate(hiddenPoints, margin));
    if (pictures)
      await viewer.page.screenshot({ path: `${screenshots}framing-${seen.scene}-${moment}-${width}x${height}.png` });
    if (seen.hidden)
      found.push(
        `${seen.scene} ${moment} at ${width}x${height}: ${seen.hidden} of ${seen.of} vertices, ` +
          `up to ${seen.worst} px into ${seen.where}; cloth ${seen.box}`,
      );
    else if (seen.cut) found.push(`at ${width}x${height} ${seen.cut} is cut off`);
    else if (seen.fill < 0.1)
      found.push(`${seen.scene} ${moment} at ${width}x${height}: it fills ${seen.fill.toFixed(2)} of the window only`);
  }
  return found;
}

/// Steps the paused session to a simulated time, and waits until the page shows it.
async function stepTo(viewer, client, dt, time) {
  const now = await viewer.read("simTime");
  await client.request("sim.step", { steps: Math.max(1, Math.round((time - now) / dt)) });
  await eventually(
    `the page at ${time} s`,
    () => viewer.read("simTime"),
    (shown) => shown > time - dt,
  );
}

const folder = new URL("../../server/scene/presets/", import.meta.url);
const presets = readdirSync(folder)
  .filter((file) => file.endsWith(".json"))
  .map((file) => file.slice(0, -".json".length))
  .filter((name) => name !== "blowup"); // it flies off on purpose
for (const preset of presets) {
  browserTest(
    `all of the cloth of ${preset} is seen on phones and screens, at the start and while it moves`,
    async () => {
      // One session for all, for a server keeps few. The test before has paused it: one frame comes.
      const { viewer, client, scene } = await here.both("framing", {
        width: 390,
        height: 844,
        drawn: 1,
        sharp: pictures,
      });
      await client.request("sim.pause", {});
      await client.request("scene.load", { preset });
      await client.request("sim.pause", {});
      await client.request("sim.reset", {});
      await viewer.until((name) => window.clothlab.document?.name === name && window.clothlab.simTime === 0, preset);
      if (!pictures) await viewer.page.evaluate(onlyPlace);
      const found = await check(viewer, "start");
      const { dt } = (await scene()).solver;
      for (const time of moments) {
        await stepTo(viewer, client, dt, time);
        await check(viewer, `${time} s`, found);
      }
      assert.deepEqual(found, []);
    },
  );
}

browserTest("a page that opens on a wide scene shows all of it beside the panel, which fills later", async () => {
  const session = "framing-open";
  const { client } = await here.both(session);
  await client.request("scene.load", { preset: "fabrics" });
  await client.request("sim.pause", {});
  const viewer = await here.open({ session, width: 1280, height: 800, drawn: 1 });
  await viewer.until(() => window.clothlab.document?.name === "fabrics");
  await eventually(
    "all in view",
    () => viewer.page.evaluate(hiddenPoints, margin),
    ({ hidden }) => hidden === 0,
  );
});

browserTest(
  "a camera that somebody moved stays when the phone is turned, and F brings all of the cloth back",
  async () => {
    const { viewer, client } = await here.both("framing-moved", { width: 390, height: 844 });
    await client.request("sim.pause", {});
    await client.request("sim.reset", {});
    await viewer.until(() => window.clothlab.simTime === 0);
    const stand = () => viewer.page.evaluate(() => window.clothlab.stage.camera.position.toArray());
    await viewer.page.mouse.move(195, 400);
    await viewer.page.mouse.wheel(0, -1200);
    await viewer.page.mouse.down();
    await viewer.page.mouse.move(320, 430, { steps: 4 });
    await viewer.page.mouse.up();
    const apart = (a, b) => Math.hypot(...a.map((value, axis) => value - b[axis]));
    // A drag swings out over some frames.
    let last = await stand();
    await eventually(
      "the camera at rest",
      async () => {
        await viewer.page.waitForTimeout(300);
        const before = last;
        last = await stand();
        return apart(last, before);
      },
      (way) => way < 1e-3,
    );
    const moved = last;
    await viewer.page.setViewportSize({ width: 844, height: 390 });
    await viewer.page.waitForTimeout(300);
    const turned = await stand();
    assert.ok(apart(turned, moved) < 0.02, `${moved} became ${turned}`);
    await viewer.page.keyboard.press("f");
    await eventually(
      "all in view after F",
      () => viewer.page.evaluate(hiddenPoints, margin),
      ({ hidden }) => hidden === 0,
    );
  },
);
