// The lab's drawer on the real server, with a cloth small enough to be measured in seconds.
import assert from "node:assert/strict";
import { Server } from "../protocol/harness.mjs";
import { browserTest, bytesOf, eventually, screenshots, withServer } from "./browser.mjs";
import { small } from "./small.mjs";

const here = withServer();

/// A page with the drawer open on the small scene, and a script beside it. The session is paused: the machine only
/// measures, and what one test has measured the cache gives to the next.
async function lab(session, { tab = "Chart", ...options } = {}) {
  const { viewer, client, scene } = await here.both(session, options);
  await client.request("scene.load", { scene: small });
  await client.request("sim.pause");
  await viewer.until(() => window.clothlab.document?.name === "small");
  await viewer.page.keyboard.press("l");
  await viewer.page.getByRole("tab", { name: tab }).click();
  const drawer = viewer.page.locator("#lab");
  const panel = drawer.getByRole("tabpanel");
  return { viewer, page: viewer.page, client, scene, drawer, panel, marks: panel.locator(".lab-picture [data-index]") };
}

const chosen = ["Symplectic Euler", "Verlet"];

/// Charts two methods in seconds, not minutes. How far a chart gets depends on the machine: `most` leaves a slow, busy
/// one time for the points that the tests look for.
async function start(panel, button, { methods = chosen, most = "120", seconds = "0.1" } = {}) {
  const options = panel.getByRole("button", { name: "Options" });
  if ((await options.getAttribute("aria-expanded")) === "false") await options.click();
  for (const box of await panel.locator(".lab-methods input").all()) {
    const name = (await box.locator("xpath=..").innerText()).trim();
    await box.setChecked(methods.includes(name));
  }
  const time = panel.getByLabel("simulate [s]");
  if ((await time.count()) > 0) await time.fill(seconds);
  const budget = panel.getByLabel("take at most");
  if ((await budget.count()) > 0) await budget.selectOption(most);
  await panel.getByRole("button", { name: button }).click();
}

const finished = (panel) =>
  eventually(
    "the measurement",
    () => panel.getAttribute("data-state"),
    (state) => state === "finished",
    500_000,
  );

async function charted(session, options) {
  const all = await lab(session, options);
  await start(all.panel, "Measure the chart");
  await finished(all.panel);
  await eventually(
    "marks",
    () => all.marks.count(),
    (count) => count >= 4,
  );
  return all;
}

/// The time step in the text [s].
function step(text) {
  const [, value, unit] = /dt ([\d.]+)\s(ms|µs)/.exec(text);
  return value * (unit === "µs" ? 1e-6 : 1e-3);
}

const silent = (viewer) =>
  assert.deepEqual(
    viewer.complaints.filter((text) => !/GPU stall|GL Driver Message/.test(text)),
    [],
  );

browserTest(
  "the drawer opens by key and by button beside the panel, and closes by key, button and Escape",
  async () => {
    const { viewer, client } = await here.both("main");
    const { page } = viewer;
    await client.request("sim.pause"); // the main session would play for half a minute beside the next tests
    const drawer = page.locator("#lab");
    assert.ok(await drawer.isHidden());
    await page.getByRole("button", { name: "Lab", exact: true }).click();
    const [box, panel, transport] = await Promise.all(
      [drawer, page.locator("#panel"), page.locator("#transport")].map((part) => part.boundingBox()),
    );
    assert.ok(box.x + box.width + 200 < panel.x, "there is room for the cloth");
    assert.ok(
      transport.x > box.x + box.width && transport.x + transport.width < panel.x,
      "its buttons are in that room",
    );
    await page.keyboard.press("Escape");
    await drawer.waitFor({ state: "hidden" });
    await page.keyboard.press("l");
    await drawer.waitFor();
    await page.keyboard.press("ArrowRight");
    assert.equal(await page.getByRole("tab", { selected: true }).innerText(), "Stability");
    await page.getByRole("button", { name: "Close the lab" }).click();
    await drawer.waitFor({ state: "hidden" });
  },
);

browserTest(
  "a chart is measured and drawn; a point tells its settings, and a click applies them, with a way back",
  async () => {
    const { viewer, page, scene, panel, marks } = await charted("lab-chart");
    const { solver } = await scene();
    const mark = panel.locator('.lab-picture .mark[data-method="verlet"]:not(.blown)').first();
    await mark.hover();
    const tip = page.getByRole("tooltip");
    const told = await tip.innerText();
    assert.match(
      told,
      /^Verlet, dt [\d.]+\s(ms|µs)[^]*position error \d[^]*simulated second[^]*of the stability limit/,
    );
    assert.match(told, /Click: apply\s+C: compare with present$/);
    await mark.click();
    const now = await eventually(
      "the scene",
      async () => (await scene()).solver,
      ({ method }) => method === "verlet",
    );
    assert.ok(Math.abs(now.dt / step(told) - 1) < 0.01, `${now.dt} s applied, ${told}`);
    await eventually(
      "the panel",
      () => page.getByRole("combobox", { name: "method" }).inputValue(),
      (value) => value === "Verlet",
    );
    const notice = page.locator(".notice", { hasText: "Applied: Verlet" });
    const before = await notice.innerText();
    for (const part of ["Before: ", "method was Symplectic Euler", "dt was 0.004"])
      assert.ok(before.includes(part), before);
    await notice.getByRole("button", { name: "Undo" }).click();
    await eventually(
      "the scene as it was",
      async () => (await scene()).solver,
      (back) => back.method === solver.method && back.dt === solver.dt,
    );
    assert.ok((await marks.count()) > 0);
    silent(viewer);
  },
);

browserTest(
  "the points are walked with the arrow keys, and Enter applies one; the table and the files say the same",
  async () => {
    const { page, scene, panel, marks } = await charted("lab-keys");
    const tip = page.getByRole("tooltip");
    await panel.locator('.lab-picture [data-index][tabindex="0"]').focus();
    // Walks from the mark with the focus to the end of its curve, then one back.
    for (let told = await tip.innerText(), before = ""; told !== before; ) {
      before = told;
      await page.keyboard.press("ArrowRight");
      told = await tip.innerText();
    }
    const first = await tip.innerText();
    await page.keyboard.press("ArrowLeft");
    const second = await tip.innerText();
    assert.ok(step(second) < step(first), `along its curve to shorter steps: from ${first} to ${second}`);
    await page.keyboard.press("ArrowDown");
    const other = await tip.innerText();
    assert.notEqual(other.split(",")[0], second.split(",")[0], "another method");
    await page.keyboard.press("Enter");
    await eventually(
      "the scene",
      async () => (await scene()).solver.dt,
      (dt) => Math.abs(dt / step(other) - 1) < 0.01,
    );

    await panel.locator("summary", { hasText: "All points as a table" }).click();
    const rows = panel.locator("tbody tr:not(.blown)");
    const cells = async (row) => (await row.locator("th, td").allInnerTexts()).map((text) => text.trim());
    const milliseconds = ([, , , , cost]) => Number.parseFloat(cost) * (/\ss$/.test(cost) ? 1000 : 1);
    const costs = await Promise.all((await rows.all()).map(async (row) => milliseconds(await cells(row))));
    assert.ok(
      costs.length >= 4 && costs.every((cost, i) => i === 0 || !(cost < costs[i - 1])),
      `by rising cost: ${costs}`,
    );
    const [method, dt] = await cells(rows.last());
    await rows.last().getByRole("button", { name: "Apply" }).click();
    await eventually(
      "the scene",
      async () => (await scene()).solver.dt,
      (now) => Math.abs(now / step(`dt ${dt}`) - 1) < 0.01,
    );
    assert.ok(chosen.includes(method));

    const download = async (format) => {
      const [file] = await Promise.all([
        page.waitForEvent("download"),
        panel.getByRole("button", { name: format, exact: true }).click(),
      ]);
      assert.equal(file.suggestedFilename(), `small-chart.${format.toLowerCase()}`);
      return (await bytesOf(file)).toString();
    };
    const { points } = JSON.parse(await download("JSON"));
    assert.ok(points.length >= (await marks.count()) && points.every(({ patch }) => patch.solver.dt > 0));
    const lines = (await download("CSV")).trim().split(/\r?\n/);
    assert.equal(lines.length, points.length + 1);
    const root = await page.evaluate(
      (text) => new DOMParser().parseFromString(text, "image/svg+xml").documentElement.localName,
      await download("SVG"),
    );
    assert.equal(root, "svg");
  },
);

browserTest("while a chart grows, the point that has the keyboard's focus keeps it, and its tooltip", async () => {
  const { panel, page, marks, drawer } = await lab("lab-focus");
  await start(panel, "Measure the chart", {
    methods: ["Verlet", "XPBD", "VBD", "PBD", "Implicit Euler"],
    most: "600",
    seconds: "5",
  });
  await eventually(
    "a first point",
    () => marks.count(),
    (count) => count >= 1,
    500_000,
  );
  await panel.locator('.lab-picture [data-index][tabindex="0"]').focus();
  const key = await page.evaluate(() => document.activeElement.dataset.index);
  for (let redrawn = 0; redrawn < 2; ++redrawn) {
    await panel.locator(".lab-picture svg").evaluate((drawing) => {
      drawing.dataset.old = "yes";
    });
    await eventually(
      "a new drawing",
      () => panel.locator(".lab-picture svg[data-old]").count(),
      (count) => count === 0,
      500_000,
    );
    assert.equal(await page.evaluate(() => document.activeElement.dataset.index), key);
    assert.ok(await page.getByRole("tooltip").isVisible());
  }
  await drawer.getByRole("button", { name: "Cancel" }).click();
});

browserTest(
  "the present setting's marker moves with the time step, or says that nothing was measured there; another scene makes the chart stale",
  async () => {
    const { client, panel } = await charted("lab-marker");
    const marker = panel.locator(".lab-present circle").first();
    const says = panel.locator(".lab-now");
    const place = async () => [Number(await marker.getAttribute("cx")), Number(await marker.getAttribute("cy"))];
    await panel.locator(".lab-present").waitFor({ state: "attached" });
    assert.match(await says.innerText(), /Now: Symplectic Euler, dt 4\sms: error \S+, \S+\s(ms|s) a simulated second/);
    const [x, y] = await place();
    await client.request("scene.patch", { patch: { solver: { dt: 0.002 } } });
    // Half the step at order 1: half the error. The cost is measured, and in so short a run it may change either way.
    await eventually(
      "the sentence",
      () => says.innerText(),
      (text) => /Now: Symplectic Euler, dt 2\sms: error \S+, \S+\s(ms|s) a simulated second/.test(text),
    );
    await eventually("further left, at another cost", place, ([nowX, nowY]) => nowX < x && nowY !== y);
    await client.request("scene.patch", { patch: { solver: { method: "vbd", iterations: 7 } } });
    await eventually(
      "no place",
      () => says.innerText(),
      (text) => /VBD, dt 2\sms, 7 iterations. Not measured: /.test(text),
    );
    assert.equal(await panel.locator(".lab-present").count(), 0);
    assert.equal(
      await panel.getByText("Measured for an earlier scene").count(),
      0,
      "the chart does not depend on how the scene is stepped",
    );
    // A change of the motion makes the result stale until it is undone.
    await client.request("scene.patch", { patch: { gravity: [0, -3, 0] } });
    const badge = panel.getByText("Measured for an earlier scene");
    await badge.waitFor();
    await client.request("scene.patch", { patch: { gravity: [0, -9.8, 0] } });
    await badge.waitFor({ state: "detached" });
  },
);

browserTest("a measurement is cancelled, and a second one waits for the first", async () => {
  const { panel, drawer, page } = await lab("lab-cancel");
  await start(panel, "Measure the chart", {
    methods: ["Verlet", "XPBD", "VBD", "PBD", "Implicit Euler"],
    most: "600",
    seconds: "5",
  });
  await panel.getByRole("progressbar").waitFor();
  await page.getByRole("tab", { name: "Stability" }).click();
  await drawer.getByRole("button", { name: "Measure the map" }).click();
  await drawer.getByText("Waits for one other measurement").waitFor();
  await drawer.getByRole("button", { name: "Cancel" }).click();
  await panel.getByText("Cancelled before anything was measured").waitFor();
  await page.getByRole("tab", { name: "Chart" }).click();
  await drawer.getByRole("button", { name: "Cancel" }).click();
  await panel
    .locator(".lab-badges")
    .getByText(/^Cancelled/)
    .waitFor();
});

browserTest("when the connection is lost the drawer keeps what it has, and says so", async () => {
  const server = await Server.start();
  const { panel, marks } = await charted("main", { server });
  const count = await marks.count();
  await server.stop();
  await panel.getByText("The connection was lost, and the measurement with it. What had been found is kept").waitFor();
  assert.equal(await marks.count(), count);
});

browserTest(
  "the stability map has a panel a method, and a trial that is clicked becomes the scene's setting",
  async () => {
    const { viewer, page, panel, scene } = await lab("lab-map", { tab: "Stability" });
    await start(panel, "Measure the map", { methods: ["Verlet"] });
    await finished(panel);
    const cells = panel.locator('.panel[data-method="verlet"] [data-cell]');
    await eventually(
      "trials",
      () => cells.count(),
      (count) => count >= 9,
    );
    assert.equal(await panel.locator(".panel").count(), 1);
    await panel.locator('.panel [data-cell][tabindex="0"]').focus();
    const told = await page.getByRole("tooltip").innerText();
    assert.match(told, /^Verlet, dt \S+\s(ms|µs), stiffness × 0.01\n(blew up|held)[^]*theory's limit: /);
    assert.deepEqual(await strayRules(page), []);
    const before = (await scene()).cloths[0].material;
    await page.keyboard.press("Enter");
    const {
      cloths: [{ material }],
    } = await eventually("the scene", scene, ({ solver }) => solver.method === "verlet");
    for (const kind of ["structural", "shear", "bend"])
      assert.ok(Math.abs(material[kind] / before[kind] - 0.01) < 1e-6, `${kind} is ${material[kind]} N/m`);
    await panel.locator("summary", { hasText: "All boundaries as a table (9)" }).click();
    assert.equal(await panel.locator("tbody tr").count(), 9);
    silent(viewer);
  },
);

browserTest(
  "a tolerance is answered with a sentence, a setting to expect an error and a cost of, and a button that applies it",
  async () => {
    const { viewer, page, panel, client, scene } = await lab("lab-choose", { tab: "Choose" });
    await client.request("scene.patch", { patch: { solver: { method: "xpbd" } } }); // which is not asked for
    await panel.getByLabel("Tolerance").fill("200");
    await panel.getByRole("button", { name: "Find the cheapest" }).click();
    await page.getByText(/The tolerance is 200; allowed is/).waitFor();
    await panel.getByRole("button", { name: "1 %", exact: true }).click();
    await panel.getByText("% of the cloth's size = 10 mm").waitFor(); // of 1 m
    await start(panel, "Find the cheapest");
    await finished(panel);
    assert.match(await panel.locator(".lab-answer").innerText(), /^\S.{20,}/);
    const card = panel.locator(".lab-card.chosen");
    const text = await card.innerText();
    const cost = String.raw`\S+\s(?:ms|s)(?: \(\S+\s\S+ … \S+\s\S+\))? a simulated second`; // and its interval
    const expected = String.raw`expected error ([^\s,]+)(?: \(at most (\S+)\))?`;
    const answer = new RegExp(String.raw`\n(Verlet|Symplectic Euler), dt [^]*${expected}, ${cost}`);
    const [, name, error, atMost] = answer.exec(text) ?? assert.fail(text);
    assert.ok(
      Number(error) <= Number(atMost ?? error) && Number(atMost ?? error) <= 1e-2,
      `${error}, at most ${atMost}, is expected`,
    );
    await card.getByRole("button", { name: "Apply" }).click();
    await eventually(
      "the scene",
      async () => (await scene()).solver,
      (solver) => solver.method === name.toLowerCase().replace(" ", "_") && Math.abs(solver.dt / step(text) - 1) < 0.01,
    );
    silent(viewer);
  },
);

browserTest(
  "each part of the scene has a row that says what it is worth, and one of them is taken out by its button",
  async () => {
    const { viewer, page, panel, scene } = await lab("lab-simplify", { tab: "Simplify" });
    await start(panel, "Measure the parts");
    await finished(panel);
    assert.deepEqual(await strayRules(page), []);
    const row = panel.locator("tbody tr", { hasText: "bend" }).first();
    assert.match(
      await row.innerText(),
      /bend springs\s+\S+\s+[+−±]\d+ %\s+(?:[+−±]\d+ % … [+−±]\d+ %\s+)?(keep|drop|within the noise)/,
    );
    await row.getByRole("button", { name: "Apply" }).click();
    await eventually(
      "the scene",
      async () => (await scene()).cloths[0].material.bend,
      (bend) => bend === 0,
    );
    await page.locator(".notice").getByRole("button", { name: "Undo" }).click();
    await eventually(
      "the scene as it was",
      async () => (await scene()).cloths[0].material.bend,
      (bend) => bend === 20,
    );
    silent(viewer);
  },
);

/// Rules of the page's style sheets that are for other parts of it, and hit a part of a drawing: both have a "legend".
/// Rules for another width count, too.
const strayRules = (page) =>
  page.evaluate(() => {
    const parts = [...document.querySelectorAll(".lab-picture svg, .lab-picture svg *")];
    if (parts.length === 0) return ["there is no drawing"];
    const selectors = (rules) =>
      [...rules].flatMap((rule) =>
        [rule.selectorText ?? [], ...(rule.cssRules ? selectors(rule.cssRules) : [])].flat(),
      );
    const meant = /\.lab-(picture|present)\b|\*$/; // one for everything in the lab is meant, too
    return [...document.styleSheets]
      .flatMap(({ cssRules }) => selectors(cssRules))
      .filter((text) => text.includes(".") && !meant.test(text) && parts.some((part) => part.matches(text)));
  });

/// Parts of the drawer that stick out of it or of the window, and cut-off words, those of the drawing, too.
const cutOff = () => {
  const problems = [];
  for (const node of document.querySelectorAll("#lab .lab-picture svg text")) {
    const drawing = node.ownerSVGElement.getBoundingClientRect();
    const { left, right } = node.getBoundingClientRect();
    if (drawing.width > 0 && (left < drawing.left - 1 || right > drawing.right + 1))
      problems.push(`"${node.textContent}" from ${left} to ${right} sticks out of its drawing`);
    if (drawing.width > 0 && getComputedStyle(node).visibility !== "visible")
      problems.push(`"${node.textContent}" is hidden`);
  }
  const drawer = document.getElementById("lab").getBoundingClientRect();
  if (drawer.left < 0 || drawer.right > innerWidth || drawer.bottom > innerHeight + 1)
    problems.push("the drawer sticks out");
  for (const node of document.querySelectorAll(
    "#lab button, #lab p, #lab .lab-picture, #lab select, #lab label, #lab .lab-table",
  )) {
    if (!node.checkVisibility({ visibilityProperty: true, opacityProperty: true })) continue;
    const { left, right } = node.getBoundingClientRect();
    if (left < drawer.left - 1 || right > drawer.right + 1)
      problems.push(`${node.className || node.textContent} from ${left} to ${right}`);
    if (!node.matches("select, .lab-table") && node.scrollWidth > node.clientWidth + 1)
      problems.push(`"${node.textContent}" is cut off`);
  }
  return problems;
};

/// What one presses in the drawer that is smaller than a fingertip, 44 CSS pixels (WCAG 2.5.5). A label is pressed for
/// its box; a mark of the drawing is the nearest one to the finger.
const tooSmall = () =>
  [...document.querySelectorAll("#lab :is(button, select, summary, input)")].flatMap((control) => {
    const target = control.matches("[type=checkbox], [type=radio]") ? control.closest("label") : control;
    if (!target.checkVisibility({ visibilityProperty: true })) return [];
    const { width, height } = target.getBoundingClientRect();
    const small = Math.min(width, height) < 43.5; // a pixel of the test's screen is four
    return small ? [`${target.textContent || target.ariaLabel}: ${width}x${height}`] : [];
  });

browserTest(
  "on a wide window and on a phone, light and dark, nothing of the drawer is cut off, and each tab has its say",
  async () => {
    const { viewer, page, panel } = await charted("lab-looks", { sharp: true });
    assert.deepEqual(await strayRules(page), []);
    for (const [width, height, colorSchemes] of [
      [1280, 800, ["light", "dark"]],
      [900, 700, ["light"]],
      [360, 740, ["dark", "light"]],
    ]) {
      await page.setViewportSize({ width, height });
      for (const colorScheme of colorSchemes) {
        await page.emulateMedia({ colorScheme });
        for (const tab of ["Stability", "Choose", "Simplify", "Chart"]) {
          await page.getByRole("tab", { name: tab }).click();
          await panel.getByRole("button", { name: "Options" }).click();
          assert.deepEqual(await page.evaluate(cutOff), [], `${tab} at ${width}x${height}`);
          if (width === 360) assert.deepEqual(await page.evaluate(tooSmall), [], tab);
          await panel.getByRole("button", { name: "Options" }).click();
        }
        const wider = await panel.locator(".lab-scroller").evaluate((box) => box.scrollWidth > box.clientWidth + 1);
        assert.equal(wider, width === 360);
        assert.equal(await panel.getByText("slide it sideways").isVisible(), wider);
        const names = await panel.locator(".lab-picture .legend text").allTextContents();
        assert.ok(
          chosen.every((name) => names.includes(name)),
          names.join(),
        ); // as in the panel
        await page.screenshot({ path: `${screenshots}lab-${width}x${height}-${colorScheme}.png` });
      }
    }
    silent(viewer);
  },
);
