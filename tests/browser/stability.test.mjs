import assert from "node:assert/strict";
import { Client } from "../protocol/harness.mjs";
import { browserTest, eventually, withServer } from "./browser.mjs";

const here = withServer();

/// A page and a script on the same session, and a function that reads the page's gauge.
async function both(session, options) {
  const { viewer, client, scene } = await here.both(session, options);
  const meter = viewer.page.getByRole("meter");
  const gauge = async () => ({
    value: Number(await meter.getAttribute("aria-valuenow")),
    says: await meter.getAttribute("aria-valuetext"),
    verdict: await viewer.page.locator(".gauge").getAttribute("data-verdict"),
    text: await viewer.page.locator(".gauge").innerText(),
  });
  const solver = async () => (await scene()).solver;
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

browserTest(
  "a time step beyond the limit is told by word, sign and colour, and a click on the limit takes it to 0.8 of it",
  async () => {
    const { viewer, client, gauge, solver } = await both("limit");
    const {
      stability: { dt_limit: limit },
    } = await client.notification("sim.status", (status) => status.time > 0.2);
    await viewer.page.keyboard.press(" "); // paused: nothing blows up
    await client.notification("sim.status", ({ playing }) => !playing);
    const number = viewer.number("Solver", "time step");
    const colors = new Set();
    for (const [share, verdict, word, sign] of [
      [0.5, "good", "Stable", "✓"],
      [0.95, "near", "Marginal", "!"],
      [1.2, "beyond", "Unstable", "✕"],
    ]) {
      await number.fill(String(Number((share * limit).toPrecision(4))));
      await number.press("Enter");
      // On a busy machine a bound replaces the sharp limit for a moment.
      const percent = `${Math.round(100 * share)} %`;
      const shown = await eventually(
        word,
        gauge,
        (now) => now.verdict === verdict && now.says === `${word}: ${percent} of the limit`,
      );
      assert.match(shown.text, new RegExp(`\\${sign}\\s*${word}\\s*${percent}`));
      colors.add(
        await viewer.page.locator(".gauge .gauge-fill").evaluate((fill) => getComputedStyle(fill).backgroundColor),
      );
    }
    assert.equal(colors.size, 3);
    await viewer.page.getByRole("button", { name: "set the time step to 0.8" }).click();
    await eventually(
      "the time step",
      async () => (await solver()).dt / limit,
      (share) => Math.abs(share - 0.8) < 0.005,
    );
    await eventually(
      "the gauge",
      gauge,
      ({ verdict, says }) => verdict === "good" && says === "Stable: 80 % of the limit",
    );
    await client.close();
  },
);

browserTest("another method is chosen from the panel, says what to expect of it, and has its own limit", async () => {
  const { viewer, client, gauge, solver } = await both("method");
  const { methods } = await client.notification("hello");
  const choice = viewer.page.getByRole("combobox", { name: "method" });
  const offered = await choice.locator("option").allInnerTexts();
  assert.equal(offered.length, methods.length);
  const before = await eventually("the gauge", gauge, ({ value }) => value > 0);
  const note = viewer.page.locator(".note:visible").filter({ hasNotText: "Thinner than" });
  const notes = new Set([await note.innerText()]);
  await choice.selectOption("Runge–Kutta 4");
  await eventually(
    "the method",
    async () => (await solver()).method,
    (method) => method === "rk4",
  );
  notes.add(await note.innerText());
  assert.equal(notes.size, 2);
  // 2.828 / omega instead of 2 / omega without damping; the seed's damping leaves it above 1.2.
  await eventually("the gauge", gauge, ({ value }) => value < before.value / 1.2);
  assert.equal(
    await viewer.input("range", "Solver", "iterations").count(),
    0,
    "a method that does not iterate has no iterations",
  );
  await choice.selectOption("Implicit Euler");
  await eventually(
    "no limit",
    gauge,
    ({ says, text }) => says === "Stable at any time step" && !text.includes("limit"),
  );
  for (const label of ["iterations", "tolerance"])
    await (await viewer.slider("Solver", label)).waitFor({ state: "visible" });
  await viewer.page.getByRole("button", { name: "Use 1/60 s, 1 iteration" }).click();
  await eventually(
    "the offer taken",
    solver,
    ({ dt, iterations }) => Math.abs(60 * dt - 1) < 1e-12 && iterations === 1,
  );
  await viewer.page.getByRole("button", { name: "Use 1/60 s" }).waitFor({ state: "detached" });
  const step = await viewer.read("step");
  await viewer.until((at) => window.clothlab.step > at + 10, step);
  await client.close();
});

browserTest(
  "PBD, XPBD and VBD have no limit and no tolerance, say what iterations are good for, and PBD what its stiffness is",
  async () => {
    const { viewer, client, gauge, solver } = await both("sweeps");
    const choice = viewer.page.getByRole("combobox", { name: "method" });
    const notes = () => viewer.page.locator(".note:visible").filter({ hasNotText: "Thinner than" }).allInnerTexts();
    const trades = new Set();
    for (const name of ["VBD", "XPBD", "PBD"]) {
      await choice.selectOption(name);
      await eventually(
        name,
        async () => (await solver()).method,
        (method) => method === name.toLowerCase(),
      );
      await eventually(
        "no limit",
        gauge,
        ({ says, text }) => says === "Stable at any time step" && !text.includes("limit"),
      );
      await viewer.slider("Solver", "iterations");
      assert.equal(await viewer.input("range", "Solver", "tolerance").count(), 0, `${name} has no tolerance`);
      trades.add((await eventually("its own trade", notes, ([, trade]) => trade && !trades.has(trade)))[1]);
    }
    // The server computes the figures: they follow the iterations and the stiffness.
    const told = async () => (await eventually("the note", notes, (texts) => texts.length === 3))[2];
    const percent = (share) => `${Number((100 * share).toPrecision(2))}\u00a0%`;
    // Both are read anew at each try: an edit may still be on its way.
    const shown = async () => {
      const { structural } = await eventually(
        "the server's figures",
        async () => {
          const [share] = (await client.nextNotification("sim.status")).solver.pbd_stiffness;
          return { ...share, text: await told() };
        },
        ({ structural, shear, bend, text }) =>
          text.includes(
            `structural\u00a0${percent(structural)}, shear\u00a0${percent(shear)}, bend\u00a0${percent(bend)}`,
          ),
      );
      return structural;
    };
    const ten = await shown();
    await viewer.page.getByRole("button", { name: "Use 0.001 s, 1 iteration" }).click();
    await client.nextNotification("sim.status", (status) => status.solver.pbd_stiffness[0].structural > 5 * ten);
    const one = await shown();
    await press(viewer, "Cloth", "structural", "PageDown", 2);
    await client.nextNotification("sim.status", (status) => status.solver.pbd_stiffness[0].structural < 0.9 * one);
    await shown();
    await choice.selectOption("Symplectic Euler");
    await eventually("N/m again", notes, (texts) => texts.length === 1);
    await client.close();
  },
);

for (const [name, section, label] of [
  ["time step", "Solver", "time step"],
  ["stiffness", "Cloth", "structural"],
]) {
  browserTest(
    `the ${name}'s slider pushed past the limit: a notice says why, and its button makes the cloth hang again`,
    async () => {
      const { viewer, client, gauge, solver } = await both(`remedy-${section}`);
      await client.notification("sim.status", (status) => status.time > 0.3);
      const slider = await viewer.slider(section, label);
      await slider.focus();
      const notice = viewer.page.locator(".notice.error");
      await eventually(
        "beyond the limit",
        async () => {
          const now = await gauge();
          if (now.value < 1.2) await viewer.page.keyboard.press("PageUp");
          return now;
        },
        ({ verdict, value }) => verdict === "beyond" && value >= 1.2,
      );
      await notice.waitFor();
      const text = await notice.innerText();
      assert.match(text, /blew up[^]*(\d J|finite)[^]*t = \d[^]*the longest stable step[^]*Remedy: set dt to /);

      // Meanwhile the page shows the last good state.
      // (Each press of a key was an edit, after which the simulation ran until it blew up again.)
      const lastStatus = () => client.messages.findLast(({ method }) => method === "sim.status").params;
      await eventually(
        "the last good frame",
        async () => [await viewer.read("step"), lastStatus().step, lastStatus().diverged],
        ([shown, step, diverged]) => diverged && shown === step,
      );
      const stopped = lastStatus();
      assert.ok(stopped.time > 0.3, `the last good state is of ${stopped.time} s`);
      inOnePiece(await viewer.positions());
      const { dt } = await solver();

      await notice.getByRole("button", { name: "Apply the remedy" }).click();
      await notice.waitFor({ state: "detached" });
      await eventually(
        "a shorter step",
        async () => (await solver()).dt,
        (now) => now < dt,
      );
      await eventually("the gauge", gauge, ({ verdict }) => verdict === "good");
      // It goes on from there, and has time to swing through.
      const shown = [];
      await eventually(
        "a second of motion",
        async () => {
          shown.push(await viewer.read("simTime"));
          return shown.at(-1);
        },
        (time) => time > stopped.time + 1,
      );
      assert.ok(
        shown.every((time) => time >= stopped.time),
        `time went back: ${shown.slice(0, 5)}`,
      );
      const positions = await viewer.positions();
      inOnePiece(positions);
      const heights = positions.map(([, y]) => y);
      assert.ok(
        Math.max(...heights) < 1.2 && Math.min(...heights) < 0.6,
        `from ${Math.min(...heights)} to ${Math.max(...heights)} m`,
      );
      assert.ok(heights.reduce((sum, y) => sum + y) / heights.length < 0.85, "below its pins, which are at 1 m");
      assert.ok((await viewer.cloth()).share > 0.02, "and it is to be seen");
      await client.close();
    },
  );
}

browserTest(
  "a self-collision too thin for the mesh says so below its thickness, and one click sets what holds",
  async () => {
    const client = await Client.connect(here.server, { session: "thin" });
    const viewer = await here.open({ session: "thin", drawn: 1 });
    const note = viewer.page.locator(".note:visible").filter({ hasText: "Thinner than" });
    await note.getByRole("button").click();
    await note.waitFor({ state: "detached" });
    const { document } = await client.request("scene.get");
    assert.equal(document.self_collision.thickness, 0.0354); // 0.85 of the spacing, 1 m / 24
    await client.close();
  },
);

browserTest(
  "a page opened on a session that has blown up says so, and no page does once somebody has seen to it",
  async () => {
    const client = await Client.connect(here.server, { session: "late" });
    await client.request("scene.patch", { patch: { solver: { dt: 0.004 } } });
    await client.notification("sim.diverged");
    const viewer = await here.open({ session: "late", drawn: 1 });
    const notice = viewer.page.locator(".notice.error");
    await notice.waitFor();
    assert.match(await notice.innerText(), /blew up[^]*before this page was opened[^]*Remedy: set dt to 0\.001/);
    await client.request("scene.patch", { patch: { solver: { dt: 0.001 } } });
    await notice.waitFor({ state: "detached" });
    await client.close();
  },
);

/// True if the seed's 25 x 25 vertices, 1/24 m apart at rest, are all there and no cell has more than doubled.
function inOnePiece(positions) {
  assert.equal(positions.length, 625);
  positions.forEach((at, i) => {
    assert.ok(at.every(Number.isFinite), `vertex ${i} at ${at}`);
    const next = positions[i + 1];
    if (i % 25 !== 24)
      assert.ok(Math.hypot(...at.map((x, axis) => x - next[axis])) < 2 / 24, `between vertices ${i} and ${i + 1}`);
  });
}
