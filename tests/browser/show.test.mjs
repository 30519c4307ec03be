// A blow-up as a show: in view, slowly, with the mode that grows, the energy and the reason; then the remedy.
import assert from "node:assert/strict";
import { violations } from "./axe.mjs";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { small } from "./small.mjs";

const here = withServer();
const show = (page) => page.getByRole("region", { name: "How it blows up" });
const again = (page) => show(page).getByRole("button", { name: "Again, at a tenth of the speed" });
const moment = (page) => show(page).getByRole("slider", { name: "Moment of the blow-up" });
const chart = (page) => show(page).getByRole("img");
const blowUp = (page) => page.getByRole("button", { name: "Make it blow up" }).click();

/// A newcomer's page on the small scene, or another, and a script beside it.
async function opened(session, { scene = small, ...options } = {}) {
  const all = await here.both(session, { newcomer: true, width: 1440, height: 900, ...options });
  await all.client.request("scene.load", { scene });
  await all.viewer.until((name) => window.clothlab.document?.name === name, scene.name);
  await all.client.notification("sim.status", ({ stability }) => stability !== undefined);
  return { ...all, page: all.viewer.page };
}

/// The energies that the chart says: where it ends, and the most that a run that holds has [J].
async function energies(page) {
  const says = await chart(page).getAttribute("aria-label");
  const [, end, allowed] = /ends at (\S+) J.*holds has: (\S+) J/.exec(says) ?? [];
  return { end: Number(end), allowed: Number(allowed) };
}

/// Each vertex's colour on screen, as a byte.
const colours = (page) =>
  page.evaluate(() => {
    const { field, header, buffer } = window.clothlab.stage.frame;
    return field === "growth" ? [...new Uint8Array(buffer, 64 + 8 * header.vertexCount)] : null;
  });

browserTest("step 2 lets the scene blow up in view, says why, and after the remedy the same scene stands", async () => {
  const { viewer, page, scene } = await opened("show");
  const before = await scene();
  await blowUp(page);
  await again(page).waitFor();
  const { solver } = await scene();
  assert.ok(solver.dt > before.solver.dt && solver.method === before.solver.method, JSON.stringify(solver));
  assert.match(await show(page).innerText(), /energy of motion.*grew from.*longest stable step of Symplectic Euler/s);
  const { end, allowed } = await energies(page);
  assert.ok(allowed > 0 && end > allowed, `${end} J, of ${allowed}`);
  const last = Number(await moment(page).getAttribute("max"));
  assert.ok(last >= 3, `${last} moments`); // a mode is told from three
  await eventually(
    "the last moment",
    () => moment(page).inputValue(),
    (now) => Number(now) === last,
  );
  const seen = await colours(page);
  assert.ok(Math.max(...seen) === 255 && Math.min(...seen) < 255, String(seen));
  const steps = [];
  for (const key of ["Home", "ArrowRight"]) {
    await moment(page).press(key);
    const step = Number((await moment(page).getAttribute("aria-valuetext")).replace("step ", ""));
    await eventually(
      `step ${step} on screen`,
      () => viewer.read("step"),
      (now) => now === step,
    );
    steps.push(step);
  }
  assert.ok(steps[1] > steps[0], `steps ${steps}`);
  assert.deepEqual(await violations(viewer, "show"), []);
  await page.screenshot({ path: `${screenshots}show-1440x900.png` });
  await show(page).getByRole("button", { name: "Apply the remedy" }).click();
  await show(page).waitFor({ state: "detached" });
  const mended = await eventually("the remedy", scene, ({ solver: { dt } }) => dt < solver.dt);
  assert.deepEqual({ ...mended, solver: null }, { ...before, solver: null });
  const time = await viewer.read("simTime");
  await eventually(
    "the cloth moves",
    () => viewer.read("simTime"),
    (now) => now > time + 0.05,
  );
  assert.equal(await colours(page), null);
  await page.locator("#first-steps li.done", { hasText: "Make it blow up" }).waitFor();
});

for (const method of ["explicit_euler", "verlet", "rk4"])
  browserTest(`${method} fails in view, too`, async () => {
    const { page, scene, client } = await opened(`show-${method}`);
    await client.request("scene.patch", { patch: { solver: { method, dt: 1e-4 } } });
    await page.waitForFunction((name) => window.clothlab.document.solver.method === name, method);
    await client.nextNotification("sim.status", ({ stability }) => stability?.dt_limit > 0);
    await blowUp(page);
    await again(page).waitFor();
    const { end, allowed } = await energies(page);
    assert.ok(end > allowed, `${end} J, of ${allowed}`);
    await show(page).getByRole("button", { name: "Apply the remedy" }).click();
    await show(page).waitFor({ state: "detached" });
    assert.equal((await scene()).name, "small");
  });

browserTest("a method that holds at any step is not swapped without a word", async () => {
  const { page, scene, client } = await opened("show-holds");
  await client.request("scene.patch", { patch: { solver: { method: "vbd" } } });
  await page.waitForFunction(() => window.clothlab.document.solver.method === "vbd");
  await client.nextNotification("sim.status", ({ stability }) => stability?.dt_limit === null);
  const before = await scene();
  await blowUp(page);
  const word = page.locator(".notice", { hasText: "VBD holds at any time step" });
  await word.waitFor();
  assert.deepEqual(await scene(), before);
  await word.getByRole("button", { name: "Go on with Symplectic Euler" }).click();
  await again(page).waitFor();
  const now = await scene();
  assert.equal(now.solver.method, "symplectic_euler");
  assert.deepEqual({ ...now, solver: null }, { ...before, solver: null });
});

browserTest("the preset blowup is the same show", async () => {
  const { page, scene } = await opened("show-preset", { newcomer: false });
  await page.getByRole("button", { name: "Gallery" }).click();
  await page.getByRole("dialog", { name: "Presets" }).getByRole("button", { name: "blowup" }).click();
  await again(page).waitFor();
  const { end, allowed } = await energies(page);
  assert.ok(end > allowed);
  await show(page).getByRole("button", { name: "Apply the remedy" }).click();
  await show(page).waitFor({ state: "detached" });
  assert.equal((await scene()).name, "blowup");
});

browserTest("who wishes less motion sees the last moment at once, and steps through by hand", async () => {
  const { viewer, page } = await opened("show-calm", { reducedMotion: "reduce" });
  await page.evaluate(() => {
    window.shown = new Set();
    const { stage } = window.clothlab;
    const { onShow } = stage;
    stage.onShow = () => {
      if (stage.frame.field === "growth") window.shown.add(stage.frame.header.step);
      onShow();
    };
  });
  await blowUp(page);
  await again(page).waitFor();
  await eventually(
    "the last moment",
    () => page.evaluate(() => window.shown.size),
    (size) => size > 0,
  );
  await viewer.still();
  assert.equal(await page.evaluate(() => window.shown.size), 1);
  assert.equal(await moment(page).inputValue(), await moment(page).getAttribute("max"));
});

browserTest(
  "a blow-up that somebody else has made is told, and shown on a press; closing it tells it again",
  async () => {
    const { page, client, scene } = await opened("show-other");
    const told = client.nextNotification("sim.diverged");
    await client.request("scene.patch", { patch: { solver: { dt: 0.02 } } });
    await told;
    const failed = await scene();
    await page.locator(".notice", { hasText: "blew up" }).getByRole("button", { name: "Show how" }).click();
    await again(page).waitFor();
    assert.deepEqual(await scene(), failed);
    await page.getByRole("button", { name: "Close the blow-up" }).click();
    await page.locator(".notice", { hasText: "blew up" }).getByRole("button", { name: "Apply the remedy" }).waitFor();
  },
);

browserTest("a red cell of the stability map shows that failure; a held one is applied", async () => {
  const { page, client, scene } = await opened("show-cell", { newcomer: false });
  await client.request("sim.pause");
  await page.keyboard.press("l");
  await page.getByRole("tab", { name: "Stability" }).click();
  const panel = page.locator("#lab").getByRole("tabpanel");
  await panel.getByRole("button", { name: "Options" }).click();
  for (const box of await panel.locator(".lab-methods input").all())
    await box.setChecked((await box.locator("xpath=..").innerText()).trim() === "Symplectic Euler");
  await panel.getByLabel("values").selectOption("5");
  await panel.getByRole("button", { name: "Measure the map" }).click();
  await eventually(
    "the map",
    () => panel.getAttribute("data-state"),
    (state) => state === "finished",
    500_000,
  );
  // The drawing comes after the state. The middle of the five columns is of the scene's own stiffness.
  const cells = panel.locator('.panel[data-method="symplectic_euler"] [data-cell]');
  await eventually(
    "the last column",
    () => cells.evaluateAll((all) => all.at(-1)?.dataset.column),
    (column) => column === "4",
  );
  const red = await cells.evaluateAll((all) => all.findIndex((cell) => cell.matches('[data-column="2"].blown')));
  assert.ok(red >= 0, "there is a red cell");
  await cells.nth(red).focus();
  const told = await page.getByRole("tooltip").innerText();
  assert.match(told, /stiffness × 1\nblew up/);
  await page.keyboard.press("Enter");
  await again(page).waitFor();
  const { end, allowed } = await energies(page);
  assert.ok(end > allowed, `${end} J, of ${allowed}`);
  assert.equal(await page.locator("#lab").isVisible(), false);
  assert.equal((await scene()).name, "small");
});
