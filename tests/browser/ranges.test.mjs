// Each slider of the panel at both ends of its range: no end is refused, and none blows up without its remedy.
import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { thorough } from "../thorough.mjs";
import { browserTest, eventually, withServer } from "./browser.mjs";

const { both } = withServer();
const diverged = -32004; // the code of the answer where the scene has blown up

/// The panel's sliders, each as the titles of its sections with its name; closed sections are opened first.
async function slidersOf(page) {
  for (;;) {
    const closed = page.locator("#panel-body .lil-closed > .lil-title");
    if ((await closed.count()) === 0) break;
    await closed.first().click();
  }
  return page.evaluate(named);
}

const named = () =>
  [...document.querySelectorAll("#panel-body input[type=range]")].map((slider) => {
    const titles = [];
    for (let at = slider.closest(".lil-gui"); at; at = at.parentElement?.closest(".lil-gui"))
      titles.unshift(at.querySelector(":scope > .lil-title").textContent);
    return [...titles.slice(1), slider.ariaLabel].join(" / ");
  });

/// Gives the slider of this name the focus; false: the scene has none.
async function focused(page, name) {
  const index = (await page.evaluate(named)).indexOf(name);
  if (index < 0) return false;
  await page.locator("#panel-body input[type=range]").nth(index).focus();
  return true;
}

/// Moves every slider that `chosen` takes to both ends by its keys, each time from the preset as it is.
async function tryEnds(session, preset, chosen = () => true) {
  const { viewer, client } = await both(session, { width: 1280, height: 900 });
  const { page } = viewer;
  const load = async () => {
    const { revision } = await client.request("scene.load", { preset });
    await client.request("sim.play").catch((error) => assert.equal(error.code, diverged)); // `blowup` has, perhaps
    await eventually(
      "the preset",
      () => page.evaluate(() => window.clothlab.document.name),
      (of) => of === preset,
    );
    return revision;
  };
  await load();
  await eventually(
    "the panel",
    () => page.locator("#panel-body select").count(),
    (count) => count > 2,
  );
  const names = (await slidersOf(page)).filter(chosen);
  assert.ok(names.length > 0, preset);
  let moved = 0;
  for (const name of names)
    for (const key of ["Home", "End"]) {
      const what = `${preset}: ${name} at ${key}`;
      const before = await load();
      await page.evaluate(() => document.getElementById("notices").replaceChildren());
      if (!(await focused(page, name))) continue;
      const was = await value(page);
      await page.keyboard.press(key);
      if ((await value(page)) === was) continue; // it is at this end as the preset ships
      const answer = async () => ({
        revision: (await client.request("scene.get", {})).revision,
        told: await page.locator("#notices .notice.error").allInnerTexts(),
      });
      const { told } = await eventually(what, answer, (now) => now.revision > before || now.told.length > 0);
      const refusals = told.filter((text) => !/blew up/.test(text));
      assert.deepEqual(refusals, [], what);
      moved += 1;
      await client.statuses(6);
      if (!(await status(client)).diverged) continue;
      const remedy = page.getByRole("button", { name: "Apply the remedy" });
      await remedy.waitFor();
      await remedy.click();
      await eventually(
        `${what}: stands again`,
        () => status(client),
        ({ diverged }) => !diverged,
      );
    }
  assert.ok(moved >= names.length, `${moved} of ${2 * names.length} ends are new values of ${preset}`);
  await client.close();
}

const status = (client) => client.nextNotification("sim.status");
const value = (page) => page.evaluate(() => document.activeElement.value);

browserTest("the seed's stiffnesses, gravity and time step, at both ends of their sliders", () =>
  tryEnds("ends", "seed", (name) => /structural|gravity|time step/.test(name)),
);

const presets = readdirSync(new URL("../../server/scene/presets/", import.meta.url))
  .filter((name) => name.endsWith(".json"))
  .map((name) => name.slice(0, -".json".length));
if (thorough)
  for (const preset of presets)
    browserTest(`${preset}: every slider at both ends of its range`, () => tryEnds(`ends-${preset}`, preset));
