// Keys on the page: a press keys what a slider shows, and the timeline has marks of the keyframes.
import assert from "node:assert/strict";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { thorough } from "../thorough.mjs";

const here = withServer();

browserTest("a button beside a slider keys its value at the present time, and the timeline marks it", async () => {
  const { viewer, client, scene } = await here.both("keys", { sharp: thorough });
  const { page } = viewer;
  await viewer.pause();
  const time = () => page.evaluate(() => window.clothlab.lastFrame.header.time);
  const first = await time();
  const key = page.locator('button.key[aria-label^="Key gravity y"]');
  assert.equal(await key.getAttribute("aria-label"), "Key gravity y at the present time");
  await key.click();
  const keys = async () => (await scene()).keys;
  const [one] = await eventually("a key", keys, (all) => all.length === 1);
  assert.deepEqual(one.of, "/gravity");
  assert.equal(one.ease, "linear");
  assert.equal(one.at.length, 1);
  assert.ok(Math.abs(one.at[0][0] - first) < 1e-6, `${one.at[0][0]} s, at ${first} s`);
  assert.deepEqual(one.at[0][1], [0, -9.8, 0]);
  await page.locator("button.key.keyed").first().waitFor();

  // a time later, another value
  await client.request("sim.step", { steps: 300 });
  await viewer.until((then) => window.clothlab.lastFrame.header.time > then + 0.2, first);
  await client.request("scene.patch", { patch: [{ op: "replace", path: "/gravity/1", value: -2 }] });
  await eventually(
    "the slider",
    () => viewer.number("World", "gravity y").inputValue(),
    (value) => Number(value) === -2,
  );
  await key.click();
  const [both] = await eventually("a second keyframe", keys, ([of]) => of.at.length === 2);
  assert.deepEqual(both.at[1][1], [0, -2, 0]);
  await eventually(
    "both times in the title",
    () => key.getAttribute("title"),
    (title) => /has keys at .+ s, .+ s$/.test(title),
  );

  await page.getByRole("button", { name: "Timeline" }).click();
  const marks = page.locator(".timeline-keys span");
  await eventually(
    "marks",
    () => marks.count(),
    (count) => count === 2,
  );
  assert.match(await marks.nth(1).getAttribute("title"), /^\/gravity at .+ s$/);
  const [bar, mark] = [await page.locator("#timeline").boundingBox(), await marks.nth(1).boundingBox()];
  assert.ok(mark.x >= bar.x && mark.x <= bar.x + bar.width, JSON.stringify({ bar, mark }));
  // what has no key of its own has no button
  assert.equal(await page.locator('button.key[aria-label^="Key time step"]').count(), 0);
  // Of software WebGL are those about the time that pictures take.
  assert.deepEqual(
    viewer.complaints.filter((text) => !text.includes("GL Driver Message")),
    [],
  );
  await page.screenshot({ path: `${screenshots}keys.png` });
  await client.close();
});
