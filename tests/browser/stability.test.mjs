import assert from "node:assert/strict";
import { after, before } from "node:test";
import { Client, Server } from "../protocol/harness.mjs";
import { browserTest, eventually, launch, Viewer } from "./browser.mjs";

let server, browser;
before(async () => {
  server = await Server.start("--max-sessions", "16");
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.stop();
});

/// A page and a script on the same session, and what the page's gauge says.
async function both(session, options) {
  const viewer = await Viewer.open(browser, server, { session, width: 1280, height: 800, ...options });
  const client = await Client.connect(server, { session });
  const meter = viewer.page.getByRole("meter");
  const gauge = async () => ({
    value: Number(await meter.getAttribute("aria-valuenow")),
    says: await meter.getAttribute("aria-valuetext"),
    verdict: await viewer.page.locator(".gauge").getAttribute("data-verdict"),
    text: await viewer.page.locator(".gauge").innerText(),
  });
  const solver = async () => (await client.request("scene.get", {})).document.solver;
  return { viewer, client, gauge, solver };
}

async function press(viewer, section, label, key, times) {
  const slider = await viewer.slider(section, label);
  await slider.focus();
  for (let i = 0; i < times; ++i) await viewer.page.keyboard.press(key);
}

browserTest("the gauge shows the server's margin, and follows the stiffness, the mass and the time step", async () => {
  const { viewer, client, gauge } = await both("gauge");
  const { stability } = await client.notification("sim.status", (status) => status.stability?.dt_limit > 0);
  const start = await eventually("the gauge", gauge, ({ value }) => Math.abs(value - stability.margin) < 0.001);
  assert.equal(start.verdict, "good");
  assert.match(start.text, /Stable/);
  assert.match(start.text, new RegExp(`limit ${Number(stability.dt_limit.toPrecision(3))} s`));
  await press(viewer, "Cloth", "structural", "PageUp", 2);
  const stiffer = await eventually("after stiffening", gauge, ({ value }) => value > 1.05 * start.value);
  await press(viewer, "Cloth", "mass", "PageUp", 3);
  const heavier = await eventually("after adding mass", gauge, ({ value }) => value < 0.9 * stiffer.value);
  await press(viewer, "Solver", "time step", "PageDown", 2);
  await eventually("after a shorter step", gauge, ({ value }) => value < 0.8 * heavier.value);
  await client.close();
});

browserTest("a time step beyond the limit is told by word, sign and colour, and a click on the limit takes it to 0.8 of it", async () => {
  const { viewer, client, gauge, solver } = await both("limit");
  await viewer.page.keyboard.press(" ");  // paused: nothing blows up
  const { stability: { dt_limit: limit } } = await client.notification("sim.status", (status) => status.stability?.dt_limit > 0);
  const number = viewer.number("Solver", "time step");
  const colors = new Set();
  for (const [share, verdict, word, sign] of [[0.5, "good", "Stable", "✓"], [0.95, "near", "Marginal", "!"], [1.2, "beyond", "Unstable", "✕"]]) {
    await number.fill(String(Number((share * limit).toPrecision(4))));
    await number.press("Enter");
    const shown = await eventually(word, gauge, (now) => now.verdict === verdict);
    assert.match(shown.text, new RegExp(`\\${sign}\\s*${word}\\s*${Math.round(100 * share)} %`));
    assert.equal(shown.says, `${word}: ${Math.round(100 * share)} % of the limit`);
    colors.add(await viewer.page.locator(".gauge-fill").evaluate((fill) => getComputedStyle(fill).backgroundColor));
  }
  assert.equal(colors.size, 3);
  await viewer.page.getByRole("button", { name: "set the time step to 0.8" }).click();
  await eventually("the time step", async () => (await solver()).dt / limit, (share) => Math.abs(share - 0.8) < 0.005);
  await eventually("the gauge", gauge, ({ verdict, says }) => verdict === "good" && says === "Stable: 80 % of the limit");
  await client.close();
});

browserTest("another method is chosen from the panel, says what to expect of it, and has its own limit", async () => {
  const { viewer, client, gauge, solver } = await both("method");
  const { methods } = await client.notification("hello");
  const choice = viewer.page.getByRole("combobox", { name: "method" });
  const offered = await choice.locator("option").allInnerTexts();
  assert.equal(offered.length, methods.length);
  const before = await eventually("the gauge", gauge, ({ value }) => value > 0);
  const notes = new Set([await viewer.page.locator(".note").innerText()]);
  await choice.selectOption("Runge–Kutta 4");
  await eventually("the method", async () => (await solver()).method, (method) => method === "rk4");
  notes.add(await viewer.page.locator(".note").innerText());
  assert.equal(notes.size, 2);
  // 2.828 / omega instead of 2 / omega without damping; the seed's damping leaves it above 1.2.
  await eventually("the gauge", gauge, ({ value }) => value < before.value / 1.2);
  assert.equal(await viewer.input("range", "Solver", "iterations").count(), 0, "a method that does not iterate has no iterations");
  await choice.selectOption("Implicit Euler");
  await eventually("no limit", gauge, ({ says, text }) => says === "Stable at any time step" && !text.includes("limit"));
  for (const label of ["iterations", "tolerance"]) await (await viewer.slider("Solver", label)).waitFor({ state: "visible" });
  const step = await viewer.read("step");
  await viewer.until((at) => window.clothlab.step > at + 10, step);
  await client.close();
});
