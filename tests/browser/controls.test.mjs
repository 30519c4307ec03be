import assert from "node:assert/strict";
import { browserTest, eventually, withServer } from "./browser.mjs";

const here = withServer();
const { both } = here;

browserTest(
  "a slider dragged by mouse changes the server's scene; the last value arrives, few messages are sent",
  async () => {
    const { viewer, client, scene } = await both("slider");
    const slider = await viewer.slider("Cloth", "structural");
    const box = await slider.boundingBox();
    const at = (share) => [box.x + box.width * share, box.y + box.height / 2];
    const started = Date.now();
    await viewer.page.mouse.move(...at(0.75));
    await viewer.page.mouse.down();
    for (let i = 0; i < 30; ++i) await viewer.page.mouse.move(...at(0.75 - i * 0.01));
    await viewer.page.mouse.up();
    const seconds = (Date.now() - started) / 1000;
    const shown = Number(await viewer.number("Cloth", "structural").inputValue());
    assert.ok(shown < 20000, `the number beside the slider is ${shown}`);
    await eventually(
      "structural on the server",
      async () => (await scene()).cloths[0].material.structural,
      (value) => value === shown,
    );
    const sent = client.messages.filter((message) => message.method === "scene.changed").length;
    assert.ok(sent >= 1 && sent <= 20 * seconds + 3, `${sent} patches in ${seconds} s`);
    await client.close();
  },
);

browserTest("a slider moved by keyboard changes the server's scene", async () => {
  const { viewer, client, scene } = await both("keyboard");
  const before = (await scene()).cloths[0].material.damping;
  const slider = await viewer.slider("Cloth", "damping");
  await slider.focus();
  for (let i = 0; i < 5; ++i) await viewer.page.keyboard.press("ArrowRight");
  await eventually(
    "damping",
    async () => (await scene()).cloths[0].material.damping,
    (value) => value > before,
  );
  await client.close();
});

browserTest("wind is switched on and off, and its strength follows a slider while it blows", async () => {
  const { viewer, client, scene } = await both("wind");
  const wind = async () => (await scene()).wind;
  const box = viewer.page.locator('.lil-gui:has(> .lil-title:text-is("Wind")) input[type=checkbox]').first();
  await box.check();
  await eventually("wind", wind, (value) => value?.drag === 1 && value.gust === 0.3);
  const drag = await viewer.slider("Wind", "drag");
  // The panel is made anew when the page hears of the wind: a key before that is lost.
  const pressed = async () => {
    await drag.press("ArrowRight");
    return wind();
  };
  await eventually("drag", pressed, (value) => value.drag > 1);
  await box.uncheck();
  await eventually("no wind", wind, (value) => value === null);
  await client.close();
});

browserTest("both pins are edited together, and the sphere by its own fields", async () => {
  const { viewer, client, scene } = await both("members");
  const amplitude = await viewer.slider("2 pins", "amplitude");
  await amplitude.focus();
  await viewer.page.keyboard.press("Home");
  await eventually(
    "amplitudes",
    async () => (await scene()).cloths[0].pins.map((pin) => pin.motion.oscillate.amplitude),
    (all) => all.every((value) => value === 0),
  );
  const radius = await viewer.slider("Collider: ball", "radius");
  await radius.focus();
  await viewer.page.keyboard.press("ArrowRight");
  await eventually(
    "radius",
    async () => (await scene()).colliders[0].sphere.radius,
    (value) => value > 0.25,
  );
  await client.close();
});

browserTest("a capsule's and a box's fields change them", async () => {
  const { viewer, client, scene } = await both("bodies");
  await client.request("scene.patch", {
    patch: {
      colliders: [
        { name: "arm", capsule: { a: [0, 0, 0], b: [0, 0.5, 0], radius: 0.1 } },
        { name: "table", box: { center: [0, -0.5, 0], half: [0.3, 0.1, 0.2] } },
      ],
    },
  });
  await viewer.until(() => window.clothlab.document?.colliders.length === 2);
  for (const [section, label, value] of [
    ["Collider: arm", "to x", (of) => of[0].capsule.b[0] > 0],
    ["Collider: arm", "radius", (of) => of[0].capsule.radius > 0.1],
    ["Collider: table", "half y", (of) => of[1].box.half[1] > 0.1],
    ["Collider: table", "turned about z", (of) => of[1].box.rotate[2] > 0],
  ]) {
    const slider = await viewer.slider(section, label);
    await slider.focus();
    await viewer.page.keyboard.press("ArrowRight");
    await eventually(label, async () => (await scene()).colliders, value);
  }
  await client.close();
});

browserTest("self-collision is switched off and on", async () => {
  const { viewer, client, scene } = await both("toggle");
  const box = viewer.page.locator('.lil-gui:has(> .lil-title:text-is("Self-collision")) input[type=checkbox]').first();
  await box.uncheck();
  await eventually(
    "self_collision",
    async () => (await scene()).self_collision,
    (value) => value === null,
  );
  await box.check();
  await eventually(
    "self_collision",
    async () => (await scene()).self_collision,
    (value) => value?.thickness > 0,
  );
  await client.close();
});

browserTest("the passes say what they take on the GPU, and those left out say why", async () => {
  const { viewer, client } = await both("passes");
  await viewer.figures();
  await viewer.page.locator(".passes summary").click();
  const time = (pass) => viewer.page.locator(`.passes li:has-text("${pass}") b`).textContent();
  for (const pass of ["neighbour search", "symplectic euler"])
    await eventually(
      pass,
      () => time(pass),
      (text) => /^[\d.]+ (µs|ms)$/.test(text),
    );
  assert.equal(await viewer.page.locator('.passes li.term:has-text("structural springs") b').count(), 0);
  await client.request("scene.patch", { patch: { self_collision: null } });
  await eventually(
    "why",
    () => viewer.page.locator('.passes li.skipped:has-text("neighbour search") span').allTextContents(),
    (texts) => texts.length === 1 && /self_collision is null/.test(texts[0]),
  );
  await client.close();
});

browserTest("a strain limit is set in percent, and its slider's left end takes it away", async () => {
  const { viewer, client, scene } = await both("strain-limit");
  const limit = async () => (await scene()).cloths[0].material.strain_limit;
  const slider = await viewer.slider("Cloth", "strain limit");
  const number = viewer.number("Cloth", "strain limit");
  assert.equal(await number.inputValue(), "off");
  await number.fill("7");
  await number.press("Enter");
  await eventually("strain_limit", limit, (value) => value === 0.07);
  await client.notification("sim.status", ({ passes }) => passes.includes("strain_limit"));
  await slider.focus();
  await viewer.page.keyboard.press("Home");
  await eventually("strain_limit", limit, (value) => value === null);
  await eventually(
    "the number",
    () => number.inputValue(),
    (text) => text === "off",
  );
  await client.close();
});

browserTest("another viewer's edit moves the panel", async () => {
  const { viewer, client } = await both("other");
  await viewer.slider("Cloth", "bend");
  await client.request("scene.patch", { patch: [{ op: "replace", path: "/cloths/0/material/bend", value: 777 }] });
  await eventually(
    "the number in the panel",
    () => viewer.number("Cloth", "bend").inputValue(),
    (text) => text === "777",
  );
  await client.request("scene.patch", { patch: { gravity: [0, -3.5, 0], solver: { dt: 0.0005 } } });
  await eventually(
    "gravity in the panel",
    () => viewer.number("World", "gravity y").inputValue(),
    (text) => text === "-3.5",
  );
  await eventually(
    "dt in the panel",
    () => viewer.number("Solver", "time step").inputValue(),
    (text) => text === "0.0005",
  );
  // No echo: the panel sends nothing back.
  const { revision } = await client.request("scene.get", {});
  await viewer.page.waitForTimeout(500);
  assert.equal((await client.request("scene.get", {})).revision, revision);
  await client.close();
});

browserTest("a refused edit is explained by a notice, and the control goes back", async () => {
  const { viewer, client, scene } = await both("refused");
  await viewer.slider("Solver", "time step");
  const number = viewer.number("Solver", "time step");
  const before = await number.inputValue();
  await number.fill("-4");
  await number.press("Enter");
  const notice = viewer.page.locator(".notice.error");
  await notice.waitFor();
  const text = await notice.innerText();
  for (const part of ["/solver/dt", "-4"]) assert.ok(text.includes(part), `the notice says ${JSON.stringify(text)}`);
  assert.match(text, /allowed: \S/);
  await eventually(
    "the control",
    () => number.inputValue(),
    (value) => value === before,
  );
  assert.equal(String((await scene()).solver.dt), before);
  await client.close();
});

browserTest("a text that is no number stays to be mended, beside what was found and what is allowed", async () => {
  const { viewer, client, scene } = await both("no-number");
  const before = await scene();
  const step = viewer.number("Solver", "time step");
  const told = viewer.page.getByRole("alert").filter({ hasText: "not a" });
  await step.fill("fast");
  await step.press("Enter");
  assert.match(
    await told.innerText(),
    /^“fast” is not a number\. Allowed is a number, such as \S+ or \S+: 1e-9 to 1 s\.$/,
  );
  await client.statuses(2);
  assert.equal(await step.inputValue(), "fast");
  assert.deepEqual(await scene(), before);
  await step.fill("0.0008");
  await step.press("Enter");
  await eventually(
    "the time step",
    async () => (await scene()).solver.dt,
    (dt) => dt === 0.0008,
  );
  assert.equal(await told.count(), 0);
  // no part of a row is taken for a whole one
  const columns = viewer.number("Cloth", "columns");
  await columns.fill("12.5");
  await columns.press("Enter");
  assert.match(await told.innerText(), /^“12\.5” is not a whole number\. Allowed is a whole number: 2 to 1024\.$/);
  assert.equal(await columns.inputValue(), "12.5");
  await columns.press("Escape"); // closes its explanation
  await columns.press("Escape");
  assert.deepEqual([await columns.inputValue(), await told.count()], ["25", 0]);
  await client.close();
});

browserTest(
  "a cloth's pins stay at its corners when it gets other columns and rows, and when it gets them back",
  async () => {
    const { viewer, client, scene } = await both("resized");
    const cloth = async () => (await scene()).cloths[0];
    const set = async (name, value) => {
      const field = viewer.number("Cloth", name);
      await field.fill(String(value));
      await field.press("Enter");
      return eventually(name, cloth, ({ mesh }) => mesh.grid[name] === value);
    };
    const places = ({ pins }) => pins.map(({ at }) => at);
    assert.deepEqual(places(await set("columns", 13)), ["corner:0,0", "corner:12,0"]);
    assert.deepEqual(places(await set("columns", 49)), ["corner:0,0", "corner:48,0"]);
    await set("rows", 9);
    await viewer.page.getByRole("button", { name: "Reset all" }).click();
    const back = await eventually("both back", cloth, ({ mesh }) => mesh.grid.columns === 25 && mesh.grid.rows === 25);
    assert.deepEqual(places(back), ["corner:0,0", "corner:24,0"]);
    await client.close();
  },
);

browserTest("pause pauses, step steps once, reset goes back to 0, and keys do the same", async () => {
  const { viewer, client } = await both("transport");
  const { page } = viewer;
  // The page shows the step at which the server stopped, however late it draws its last frame.
  const stopped = async () => {
    const { step } = await client.nextNotification("sim.status", (status) => status.playing === false);
    await eventually(
      "the last frame",
      () => viewer.read("step"),
      (shown) => shown === step,
    );
    return step;
  };
  await page.getByRole("button", { name: "Pause" }).click();
  await page.getByRole("button", { name: "Play" }).waitFor();
  const at = await stopped();
  await page.getByRole("button", { name: "Step", exact: true }).click();
  await eventually(
    "one step",
    () => viewer.read("step"),
    (step) => step === at + 1,
  );
  await page.locator("#view").click({ position: { x: 640, y: 300 } });
  await page.keyboard.press(".");
  await eventually(
    "another step",
    () => viewer.read("step"),
    (step) => step === at + 2,
  );
  await page.keyboard.press("r");
  await eventually(
    "reset",
    () => viewer.read("step"),
    (step) => step === 0,
  );
  await page.keyboard.press(" ");
  await eventually(
    "playing",
    () => viewer.read("step"),
    (step) => step > 10,
  );
  await page.keyboard.press(" ");
  await stopped();
  await client.close();
});

browserTest("a status from before the server has heard of a pause does not turn the button back", async () => {
  const { viewer, client } = await both("late-status");
  let held = null;
  let statuses = 0;
  const late = await (await viewer.page.context().browser().newContext()).newPage();
  await late.routeWebSocket(/\/ws/, (socket) => {
    const server = socket.connectToServer();
    socket.onMessage((message) => {
      if (String(message).includes("sim.pause")) held = () => server.send(message);
      else server.send(message);
    });
    server.onMessage((message) => {
      if (typeof message === "string" && message.includes("sim.status")) statuses += 1;
      socket.send(message);
    });
  });
  await late.goto(`http://${here.server.host}/?session=late-status`);
  await late.getByRole("button", { name: "Pause" }).click();
  await eventually(
    "the pause is on its way",
    async () => held,
    (send) => send !== null,
  );
  const before = statuses;
  await eventually(
    "statuses of a cloth that plays",
    async () => statuses,
    (count) => count > before + 10, // of ten a second: what the page waited for by the clock was 0.4 s
  );
  assert.equal(await late.locator("#play").getAttribute("aria-label"), "Play");
  held();
  await client.nextNotification("sim.status", (status) => status.playing === false);
  assert.equal(await late.locator("#play").getAttribute("aria-label"), "Play");
  await client.close();
});

browserTest("who pauses while a preset is being loaded has it paused", async () => {
  const { viewer, client } = await both("pause-in-load");
  const page = await (await viewer.page.context().browser().newContext()).newPage();
  let answer = null;
  await page.routeWebSocket(/\/ws/, (socket) => {
    const server = socket.connectToServer();
    let load = null;
    socket.onMessage((message) => {
      const { id, method } = JSON.parse(message);
      if (method === "scene.load") load = id;
      server.send(message);
    });
    server.onMessage((message) => {
      if (typeof message === "string" && load !== null && JSON.parse(message).id === load)
        answer = () => socket.send(message);
      else socket.send(message);
    });
  });
  await page.goto(`http://${here.server.host}/?session=pause-in-load`);
  await page.getByLabel("preset", { exact: true }).selectOption("cantilever");
  await eventually(
    "the answer, which is held back",
    async () => answer,
    (send) => send !== null,
  );
  await page.getByRole("button", { name: "Pause", exact: true }).click();
  await client.nextNotification("sim.status", ({ playing }) => !playing);
  answer();
  await client.statuses(3);
  await client.nextNotification("sim.status", ({ playing }) => !playing);
  assert.equal(await page.locator("#play").getAttribute("aria-label"), "Play");
  await client.close();
});

browserTest("speed, help, fit and hiding: the remaining controls do what they say", async () => {
  const { viewer, client } = await both("keys");
  const { page } = viewer;
  await page.getByRole("combobox", { name: "Speed" }).selectOption("0.25");
  await client.notification("sim.status", (params) => params.speed === 0.25);
  await page.keyboard.press("Escape");
  await page.locator("#view").click({ position: { x: 640, y: 300 } });
  await page.keyboard.press("?");
  await page.getByRole("dialog").waitFor();
  await page.getByRole("button", { name: "Close" }).click();
  await page.keyboard.press("h");
  await page.locator("#panel").waitFor({ state: "hidden" });
  await page.keyboard.press("h");
  await page.locator("#panel").waitFor({ state: "visible" });
  // The direction of the view only: the distance depends on where the cloth is (framing.test.mjs).
  const camera = () =>
    page.evaluate(() => {
      const { object, target } = window.clothlab.stage.controls;
      return object.position
        .clone()
        .sub(target)
        .normalize()
        .toArray()
        .map((v) => v.toFixed(3))
        .join();
    });
  const home = await camera();
  await page.keyboard.down("Alt"); // orbits on the cloth, too, wherever it is by now
  await page.mouse.move(500, 400);
  await page.mouse.down();
  await page.mouse.move(620, 380, { steps: 5 });
  await page.mouse.up();
  await page.keyboard.up("Alt");
  await eventually("the orbited camera", camera, (now) => now !== home);
  await page.waitForTimeout(600); // the swing of the damped controls ends
  await page.keyboard.press("f");
  await eventually("the fitted camera", camera, (now) => now === home);
  await client.close();
});

browserTest("a preset is loaded from the panel, and a divergence is told with its remedy", async () => {
  const { viewer, client, scene } = await both("preset");
  const preset = viewer.page.locator('.lil-controller:has(.lil-name:text-is("preset")) select');
  await viewer.pause();
  await preset.selectOption("drape");
  await eventually(
    "the scene's name",
    async () => (await scene()).name,
    (name) => name === "drape",
  );
  await eventually(
    "the page's name",
    () => viewer.page.locator("#scene-name").innerText(),
    (name) => name === "drape",
  );
  const time = () => viewer.page.evaluate(() => window.clothlab.lastFrame.header.time);
  await eventually("a scene that was chosen moves, though the one before was paused", time, (now) => now > 0.05);
  await preset.selectOption("blowup");
  const notice = viewer.page.locator(".notice.error");
  await notice.waitFor();
  assert.match(await notice.innerText(), /blew up/);
  const { dt } = (await scene()).solver;
  await notice.getByRole("button", { name: "Apply the remedy" }).click();
  await eventually(
    "the time step",
    async () => (await scene()).solver.dt,
    (value) => value < dt,
  );
  await client.close();
});
