// Compare: two settings of the scene stepped together, side by side or as a ghost, from the panel, from a point of the
// lab's chart, and by a link; what it says is what the command line computes.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { small } from "./small.mjs";

const here = withServer();
const sizes = [
  ["desktop", { width: 1440, height: 900, hasTouch: false }],
  ["phone", { width: 390, height: 844, hasTouch: true }],
];
const silent = (viewer) =>
  assert.deepEqual(
    viewer.complaints.filter((text) => !/GPU stall|GL Driver Message/.test(text)),
    [],
  );

/// A page on the small scene, which stands still, a script beside it, and the drawer.
async function open(session, options = {}, scene = small) {
  const { viewer, client } = await here.both(session, options);
  const { page } = viewer;
  await client.request("sim.pause");
  await client.request("scene.load", { scene });
  await viewer.until((name) => window.clothlab.document?.name === name, scene.name);
  const drawer = page.locator("#compare");
  return {
    viewer,
    page,
    client,
    drawer,
    press: (locator) => (options.hasTouch ? locator.tap() : locator.click()),
    at: (label) =>
      drawer.locator(".lab-field", { has: page.locator(`span:text-is("${label}")`) }).locator("input, select"),
    button: (name) => drawer.getByRole("button", { name, exact: true }),
  };
}
/// Starts, waits for the end, and stands still at the last moment.
async function compared({ drawer, press, page }) {
  await press(drawer.getByRole("button", { name: /^Start/ }));
  await ended(drawer);
  await drawer.getByRole("slider", { name: "Moment" }).focus();
  await page.keyboard.press("End");
}
async function ended(drawer) {
  await drawer.getByText(/^Up to /).waitFor({ timeout: 240_000 });
}
/// The rows of the table: [time s, rms mm, largest mm].
async function table(drawer) {
  const texts = await drawer
    .locator(".compare-table tbody tr")
    .evaluateAll((rows) => rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
  const number = (text) => Number.parseFloat(text) * (text.endsWith("µm") ? 1e-3 : 1);
  return texts.map((row) => row.map(number));
}
/// RMS distances [mm] of the positions that `clothlab run` writes every 40 ms for two settings.
function distances(scene, time, settings) {
  const folder = mkdtempSync(join(tmpdir(), "clothlab-compare-"));
  const runs = settings.map((sets) => {
    writeFileSync(join(folder, "scene.json"), JSON.stringify(scene));
    execFileSync(
      process.env.CLOTHLAB,
      [
        "run",
        join(folder, "scene.json"),
        "--time",
        `${time}`,
        "--every",
        "0.04",
        "--out",
        join(folder, "a.pc2"),
      ].concat(sets.flatMap((set) => ["--set", set])),
      { stdio: "ignore" },
    );
    const bytes = readFileSync(join(folder, "a.pc2"));
    const size = 3 * bytes.readInt32LE(16);
    return Array.from({ length: bytes.readInt32LE(28) }, (_, k) =>
      Array.from({ length: size }, (_, i) => bytes.readFloatLE(32 + 4 * (k * size + i))),
    );
  });
  rmSync(folder, { recursive: true });
  return runs[0].map((a, k) => {
    const squares = a.reduce((sum, x, i) => sum + (x - runs[1][k][i]) ** 2, 0);
    return 1000 * Math.sqrt((3 * squares) / a.length);
  });
}

for (const [size, window] of sizes)
  browserTest(
    `${size}: from the panel; equal settings are exactly 0 apart and look the same, side by side`,
    async () => {
      const all = await open(`same-${size}`, { ...window, sharp: true });
      const { viewer, page, drawer, press, at, client } = all;
      if (size === "phone") await press(page.getByRole("button", { name: "Parameters" }));
      await press(page.getByRole("button", { name: "Compare", exact: true }));
      await drawer.waitFor();
      assert.equal(await at("method").inputValue(), "symplectic_euler");
      assert.equal(await at("dt [ms]").inputValue(), "4");
      await at("simulate [s]").fill("1");
      await compared(all);
      assert.match(await drawer.locator(".compare-present").textContent(), /^At 1\.00 s: A and B are the same/);
      assert.match(await drawer.getByText(/^Up to /).textContent(), /Up to 1\.00 s A and B never differ/);
      const rows = await table(drawer);
      assert.equal(rows.length, 26);
      assert.ok(rows.every(([, rms, most]) => rms === 0 && most === 0));
      // both labels and both pictures, apart from each other
      const [a, b] = await Promise.all(["a", "b"].map((side) => page.locator(`.compare-label.${side}`).boundingBox()));
      assert.ok(a && b && (a.x + a.width <= b.x || a.y + a.height <= b.y), JSON.stringify([a, b]));
      assert.equal(await page.locator("#panel").isVisible(), false, "the panel gives its room");
      const right = await page.evaluate(() => window.clothlab.stage.area.left + window.clothlab.stage.area.width);
      assert.equal(right, window.width);
      const shots = await halves(viewer);
      assert.ok(
        shots.every((count) => count > 150),
        `the cloth is in both halves: ${shots}`,
      );
      // the same pixels but for those that the cut between two pixels moves
      assert.ok(Math.abs(shots[0] - shots[1]) <= 0.04 * Math.max(...shots), `the same cloth: ${shots}`);
      await page.screenshot({ path: join(screenshots, `compare-side-${size}.png`) });
      // another camera shows both otherwise, and alike
      await page.locator("#view").focus();
      for (let i = 0; i < 4; ++i) await page.keyboard.press("ArrowLeft");
      await page.waitForTimeout(600);
      const turned = await halves(viewer);
      assert.notDeepEqual(turned, shots);
      assert.ok(Math.abs(turned[0] - turned[1]) <= 0.04 * Math.max(...turned), `the same camera: ${turned}`);
      // one cannot pull at a comparison
      const grabbed = await page.evaluate(() => document.querySelector(".hands .mine") !== null);
      assert.equal(grabbed, false);
      await page.keyboard.press("Escape");
      await drawer.waitFor({ state: "hidden" });
      assert.equal(await page.locator(".compare-label").count(), 0);
      await viewer.until(() => document.body.classList.contains("comparing") === false);
      assert.equal(await here.server.metric("clothlab_lab_running"), 0);
      await client.request("sim.play");
      const drawn = await viewer.read("framesDrawn");
      await viewer.until((before) => window.clothlab.framesDrawn > before + 3, drawn);
      silent(viewer);
    },
  );

/// The red pixels of the cloth in both parts of the picture.
async function halves(viewer) {
  const png = (await viewer.page.screenshot()).toString("base64");
  const box = (selector) => viewer.page.locator(selector).boundingBox();
  const [line, a, b] = await Promise.all([".compare-line", ".compare-label.a", ".compare-label.b"].map(box));
  const { width } = viewer.page.viewportSize();
  const below = (label) => label.y + label.height + 4;
  let parts;
  if (line.height > line.width) {
    const half = Math.min(line.x, width - line.x);
    const top = Math.max(below(a), below(b));
    const high = line.y + line.height - top;
    parts = [
      [line.x - half, top, half - 1, high],
      [line.x + 1, top, half - 1, high],
    ];
  } else {
    const high = line.y - below(a) - 2;
    parts = [
      [line.x, below(a), line.width, high],
      [line.x, below(b), line.width, high],
    ];
  }
  const helper = await viewer.page.context().browser().newPage();
  try {
    return await helper.evaluate(
      async ({ png, parts }) => {
        const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
        const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
        context.drawImage(image, 0, 0);
        return parts.map((part) => {
          const { data } = context.getImageData(...part.map(Math.round));
          let found = 0;
          for (let i = 0; i < data.length; i += 4)
            if (data[i] > 60 && data[i] > 1.6 * data[i + 1] && data[i] > 1.6 * data[i + 2]) ++found;
          return found;
        });
      },
      { png, parts },
    );
  } finally {
    await helper.close();
  }
}

for (const [size, window] of sizes)
  browserTest(`${size}: another step is as far away as the command line computes, and it grows`, async () => {
    const all = await open(`other-${size}`, window);
    const { viewer, page, drawer, press, at, button, client } = all;
    const { document } = await client.request("scene.get");
    await page.keyboard.press("c");
    await at("method").selectOption("verlet");
    await at("dt [ms]").fill("2");
    await at("simulate [s]").fill("1");
    await compared(all);
    const rows = await table(drawer);
    const computed = distances(document, 1, [[], ["/solver/method=verlet", "/solver/dt=0.002"]]);
    assert.equal(rows.length, 26);
    for (const [k, [time, rms]] of rows.entries()) {
      assert.equal(time, Number((0.04 * k).toFixed(2)));
      // the page writes three digits: half of the last one
      assert.ok(Math.abs(rms - computed[k]) <= 0.005001 * computed[k], `${time} s: ${rms} is not ${computed[k]}`);
    }
    // for half a swing; then it comes back
    assert.ok(rows[10][1] > rows[5][1] && rows[5][1] > rows[1][1], `${rows.map(([, rms]) => rms)}`);
    assert.equal(await page.locator(".compare-label.b").textContent(), "B: Verlet, dt 2\u00a0ms");

    // keys: a moment back, play, pause, from the start
    const where = drawer.locator(".compare-where");
    await page.locator("#view").focus();
    await page.keyboard.press(",");
    assert.equal(await where.textContent(), "0.96 of 1.00 s");
    await page.keyboard.press(".");
    assert.equal(await where.textContent(), "1.00 of 1.00 s");
    await page.keyboard.press("r");
    await page.keyboard.press(" ");
    await button("Play").waitFor();
    const stood = await where.textContent();
    assert.match(stood, /^0\.\d\d of/);
    await page.waitForTimeout(300);
    assert.equal(await where.textContent(), stood, "both stand still");
    // a press on the curve goes to that moment
    const box = await drawer.locator(".compare-curve .u-over").boundingBox();
    const [x, y] = [box.x + 0.5 * box.width, box.y + box.height / 2];
    await drawer.locator(".compare-curve").scrollIntoViewIfNeeded();
    const placed = await drawer.locator(".compare-curve .u-over").boundingBox();
    await (window.hasTouch
      ? page.touchscreen.tap(x, placed.y + placed.height / 2)
      : page.mouse.click(x, placed.y + placed.height / 2));
    assert.match(await where.textContent(), /^0\.(48|52) of/, `${y}`);
    // the ghost, swapped, and back
    await press(drawer.getByText("Ghost", { exact: true }));
    await page.locator(".compare-label.b.ghost").waitFor();
    await press(button("Swap"));
    await page.locator(".compare-label.a.ghost").waitFor();
    await page.screenshot({ path: join(screenshots, `compare-ghost-${size}.png`) });

    // use B: the session's scene has it, and it can be undone
    await press(button("Use B"));
    await drawer.waitFor({ state: "hidden" });
    await eventually(
      "B in use",
      async () => (await client.request("scene.get")).document.solver,
      ({ method, dt }) => method === "verlet" && dt === 0.002,
    );
    await press(page.locator(".notice").getByRole("button", { name: "Undo" }));
    await eventually(
      "A again",
      async () => (await client.request("scene.get")).document.solver.dt,
      (dt) => dt === 0.004,
    );
    silent(viewer);
  });

browserTest("from a point of the lab's chart, by key and by its button in the table: it with the present", async () => {
  const { viewer, page, drawer } = await open("lab", { width: 1440, height: 900 });
  await page.keyboard.press("l");
  const panel = page.locator("#lab").getByRole("tabpanel");
  await panel.getByRole("button", { name: "Options" }).click();
  for (const box of await panel.locator(".lab-methods input").all())
    await box.setChecked((await box.locator("xpath=..").innerText()).trim() === "Verlet");
  await panel.getByLabel("simulate [s]").fill("0.1");
  await panel.getByLabel("take at most").selectOption("20");
  await panel.getByRole("button", { name: "Measure the chart" }).click();
  await eventually(
    "the chart",
    () => panel.getAttribute("data-state"),
    (state) => state === "finished",
    500_000,
  );
  const mark = panel.locator(".lab-picture [data-index]").first();
  const name = await mark.getAttribute("aria-label");
  const [, step] = /dt ([\d.]+)\sms/.exec(name);
  await panel.locator(".lab-picture [data-index][tabindex='0']").focus();
  await mark.focus();
  await page.keyboard.press("c");
  await drawer.waitFor();
  await page.locator("#lab").waitFor({ state: "hidden" });
  await page
    .locator(".compare-label.b")
    .filter({ hasText: `B: Verlet, dt ${step}\u00a0ms` })
    .waitFor();
  assert.equal(await page.locator(".compare-label.a").textContent(), "A: Symplectic Euler, dt 4\u00a0ms");
  await page.keyboard.press("Escape");
  await page.keyboard.press("l");
  await panel.locator("summary", { hasText: "All points as a table" }).click();
  await panel
    .getByRole("button", { name: /^Compare Verlet, dt .* with present$/ })
    .first()
    .click();
  await page.locator(".compare-label.b").filter({ hasText: "B: Verlet" }).waitFor();
  silent(viewer);
});

browserTest("the truth in A's place, and where there is none the lab's reason", async () => {
  const all = await open("truth", { width: 1280, height: 800 });
  const { page, drawer, at, client, viewer, press } = all;
  await page.keyboard.press("c");
  await at("A is").selectOption("truth");
  await at("simulate [s]").fill("0.4");
  await compared(all);
  assert.equal(await page.locator(".compare-label.a").textContent(), "A: the truth, in double precision");
  const rows = await table(drawer);
  assert.equal(rows[0][1], 0);
  assert.ok(rows.at(-1)[1] > 0.1, "symplectic Euler at 4 ms is not exact");
  assert.ok((await drawer.locator(".lab-list li").count()) > 0, "the horizon is told");
  const stiff = structuredClone(small);
  stiff.name = "stiff";
  stiff.cloths[0].material.structural = 1e9;
  stiff.cloths[0].mass.per_vertex = 0.01;
  await client.request("scene.load", { scene: stiff });
  await viewer.until(() => window.clothlab.document?.name === "stiff");
  await at("simulate [s]").fill("60");
  await press(drawer.getByRole("button", { name: /^Start/ }));
  const alert = drawer.getByRole("alert");
  await alert.filter({ hasText: "No truth: there is none for this scene" }).waitFor({ timeout: 120_000 });
  assert.match(await alert.textContent(), /compare with the present settings instead/i);
  silent(viewer);
});

browserTest("what cannot be compared, and what is mistyped, is told, and nothing is lost", async () => {
  const all = await open("refusals", { width: 1280, height: 800 });
  const { page, drawer, at, press, viewer, client, button } = all;
  await page.keyboard.press("c");
  const start = drawer.getByRole("button", { name: /^Start/ });
  const alert = drawer.getByRole("alert");
  const refused = async (text) => {
    await press(start);
    await alert.filter({ hasText: text }).waitFor();
  };
  await at("dt [ms]").fill("-1");
  await refused("dt [ms] is -1; allowed is a number above 0");
  await at("dt [ms]").fill("4");
  await at("simulate [s]").fill("90");
  await refused("allowed is 0.01 to 60");
  await at("simulate [s]").fill("0.4");
  await drawer.getByText("More changes, as a JSON patch").click();
  const more = drawer.getByLabel("More changes of B, as a JSON patch");
  await more.fill('{"wind": ');
  await refused("The patch, line 1");
  await more.fill('{"cloths": [{"mesh": {"grid": {"columns": 9, "rows": 9}}}]}');
  await refused(/81 vertices, A's 49.*leaves the cloths' meshes as they are/i);
  await more.fill('{"air_drag": -3}');
  await refused("/air_drag");
  await more.fill('{"gravity": [0, -5, 0]}');
  await compared(all);
  assert.ok((await alert.isHidden()) && (await table(drawer)).at(-1)[1] > 1);
  // the scene changes meanwhile: it says so, and the comparison stays
  await client.request("scene.patch", { patch: { air_drag: 0.5 } });
  await drawer.getByText(/The scene has changed since/).waitFor();
  assert.equal(await more.inputValue(), '{"gravity": [0, -5, 0]}');
  // cancelled: what there is stays
  await at("simulate [s]").fill("60");
  await at("dt [ms]").fill("0.05");
  await press(button("Start again"));
  await page.locator(".compare-label").first().waitFor();
  await press(button("Cancel"));
  await button("Start again").waitFor();
  await drawer.getByText(/^Up to /).waitFor();
  silent(viewer);
});

browserTest("a link carries the scene and the comparison, and opens both in a session of its own", async () => {
  const all = await open("link-from", { width: 1280, height: 800 });
  const { page, drawer, at, press, button, viewer } = all;
  await page.keyboard.press("c");
  await at("method").selectOption("xpbd");
  await at("iterations").fill("3");
  await at("simulate [s]").fill("0.4");
  await compared(all);
  await press(drawer.getByText("Ghost", { exact: true }));
  await press(button("Copy link"));
  const link = await drawer.getByLabel("Copied link").inputValue();
  assert.match(link, /\/#scene=[\w-]+&compare=[\w-]+$/);
  silent(viewer);
  await page.context().close();
  const other = await here.open({ session: "link-to", width: 1280, height: 800 });
  await other.page.goto(link.replace("/#", "/?session=link-to#"));
  await other.page.reload(); // only the fragment differed
  const dialog = other.page.getByRole("dialog", { name: "A scene by link" });
  await dialog.waitFor();
  assert.equal(await other.page.locator("#compare").count(), 0, "nothing before one has chosen");
  await dialog.getByRole("button", { name: "Open it in a session of its own" }).click();
  const label = other.page.locator(".compare-label.b.ghost");
  // A link starts no job of the lab: that is left to who has opened it.
  const begin = async () => {
    await other.page.getByText("Nothing runs until you start it").waitFor();
    assert.equal(await here.server.metric("clothlab_lab_running"), 0);
    await other.page.getByRole("button", { name: /^Start/ }).click();
  };
  await begin();
  await label.filter({ hasText: "B: XPBD, dt 4\u00a0ms, 3 iterations" }).waitFor();
  await other.until(() => window.clothlab.document?.name === "small");
  assert.equal(new URL(other.page.url()).hash, "");
  await ended(other.page.locator("#compare"));
  silent(other);
  // without a scene: with the one that the session has
  await other.page.keyboard.press("Escape");
  await label.waitFor({ state: "detached" });
  await other.page.evaluate((hash) => (location.hash = hash), link.split("&")[1]);
  await begin();
  await label.filter({ hasText: "B: XPBD" }).waitFor();
  // declined: neither
  await other.page.keyboard.press("Escape");
  await other.page.locator("#compare").waitFor({ state: "hidden" });
  await other.page.evaluate((hash) => (location.hash = hash), `#${link.split("#")[1]}`);
  await dialog.getByRole("button", { name: "Do not load it" }).click();
  await dialog.waitFor({ state: "detached" });
  assert.equal(new URL(other.page.url()).hash, "");
  assert.ok(await other.page.locator("#compare").isHidden());
  // damaged
  await other.page.evaluate(() => (location.hash = "#compare=abc"));
  await other.page.locator(".notice", { hasText: "The link is damaged" }).waitFor();
});

browserTest("closing leaves nothing at the server: no session, no job", async () => {
  const sessions = await here.server.metric("clothlab_sessions");
  const all = await open("leaves", { width: 1280, height: 800 });
  const { page, drawer, at, press } = all;
  assert.equal(await here.server.metric("clothlab_sessions"), sessions + 1);
  await page.keyboard.press("c");
  await at("simulate [s]").fill("60");
  await at("dt [ms]").fill("0.05");
  await press(drawer.getByRole("button", { name: /^Start/ }));
  await page.locator(".compare-label").first().waitFor();
  assert.equal(await here.server.metric("clothlab_lab_running"), 1);
  assert.equal(await here.server.metric("clothlab_sessions"), sessions + 1);
  await drawer.getByRole("button", { name: "Close the comparison" }).click();
  await eventually(
    "the job's end",
    () => here.server.metric("clothlab_lab_running"),
    (count) => count === 0,
  );
  assert.equal(await here.server.metric("clothlab_sessions"), sessions + 1);
});

browserTest("it is loaded when it is opened, not with the page", async () => {
  const { page } = await here.open({ session: "late" });
  const loaded = () =>
    page.evaluate(() =>
      performance
        .getEntriesByType("resource")
        .map(({ name }) => new URL(name).pathname)
        .filter((path) => /comparison|compare/.test(path)),
    );
  assert.deepEqual(await loaded(), []);
  await page.keyboard.press("c");
  await page.locator("#compare").waitFor();
  assert.equal((await loaded()).length, 2);
});
