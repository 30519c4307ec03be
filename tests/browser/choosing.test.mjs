// Choosing in the panel is safe: a fabric, or other rows and columns, brings what it needs in the same step of undo.
import assert from "node:assert/strict";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { thorough } from "../thorough.mjs";

const { both } = withServer();
const diverged = (client) => client.messages.filter(({ method }) => method === "sim.diverged");

browserTest(
  "each of these fabrics, chosen on the seed, holds and moves; one undo takes fabric and solver back",
  async () => {
    const { viewer, client, scene } = await both("chosen", { width: 1440, height: 900, sharp: thorough });
    const before = await scene();
    const menu = viewer.page.getByLabel("fabric", { exact: true });
    // the stiffest; a soft one; a heavy one
    for (const fabric of ["canvas", "rib", "wool"]) {
      await menu.selectOption(fabric);
      const now = await eventually(fabric, scene, ({ cloths }) => cloths[0].material.fabric === fabric);
      assert.deepEqual([now.solver.method, now.solver.dt], ["implicit_euler", 1 / 60], "once it holds, it stays");
      const named = viewer.page.locator(".notice", { hasText: "Stepped by Implicit Euler, 1/60 s" });
      if (fabric === "canvas") {
        await named.waitFor();
        await viewer.page.screenshot({ path: `${screenshots}choosing-fabric.png` });
      }
      // Changes of one value within a second are one step of undo.
      const { time: chosen } = await client.nextNotification("sim.status");
      await client.nextNotification("sim.status", ({ time }) => time > chosen + 1.2);
    }
    assert.deepEqual(diverged(client), []);
    for (const fabric of ["rib", "canvas", undefined]) {
      await viewer.page.keyboard.press("Control+z");
      await eventually(`${fabric} again`, scene, ({ cloths }) => cloths[0].material.fabric === fabric);
    }
    assert.deepEqual(await scene(), before, "the solver went back with it");
    await client.close();
  },
);

browserTest(
  "each method, chosen on the seed, stays chosen and holds, and one undo takes it and its step back",
  async () => {
    const { viewer, client, scene } = await both("methods", { width: 1440, height: 900 });
    const before = await scene();
    const menu = viewer.page.getByRole("combobox", { name: "method" });
    const { methods } = await client.notification("hello");
    for (const [i, method] of methods.entries()) {
      // A step of a frame, which explicit methods cannot take: each has to bring its own.
      await client.request("scene.patch", { patch: { solver: { method: "implicit_euler", dt: 1 / 60 } } });
      await viewer.until(() => window.clothlab.document.solver.method === "implicit_euler");
      if (method === "implicit_euler" || method === "auto") continue; // the lab chooses for the latter
      const label = await menu.locator("option").nth(i).innerText();
      await menu.selectOption({ label });
      const { solver } = await eventually(method, scene, (now) => now.solver.method === method);
      const { time: chosen } = await client.nextNotification("sim.status");
      await client.nextNotification("sim.status", ({ time }) => time > chosen + 0.3);
      assert.deepEqual(diverged(client), [], `${method} with ${solver.dt} s`);
      await viewer.page.keyboard.press("Control+z");
      await eventually("the solver before", scene, (now) => now.solver.method === "implicit_euler");
      assert.equal((await scene()).solver.dt, 1 / 60);
    }
    assert.deepEqual({ ...(await scene()), solver: before.solver }, before);
    await client.close();
  },
);

browserTest("a finer grid keeps its corners pinned and its mass as a whole, and does not blow up", async () => {
  const { viewer, client, scene } = await both("finer", { width: 1440, height: 900, sharp: thorough });
  const { page } = viewer;
  await viewer.until(() => document.querySelector(".differences") !== null);
  const cloth = async () => (await scene()).cloths[0];
  const set = async (name, value, done) => {
    const field = viewer.number("Cloth", name);
    await field.fill(String(value));
    await field.press("Enter");
    return eventually(name, cloth, done);
  };
  const finer = await set("columns", 49, ({ mesh }) => mesh.grid.columns === 49);
  assert.deepEqual(
    finer.pins.map(({ at }) => at),
    ["corner:0,0", "corner:48,0"],
  );
  assert.equal(finer.mass.per_vertex, 0.0510204);
  await page.locator(".notice", { hasText: "The cloth keeps its 62.5 kg" }).waitFor();
  await page.screenshot({ path: `${screenshots}choosing-mass.png` });
  await client.nextNotification("sim.status", ({ time }) => time > 0.3);
  assert.deepEqual(diverged(client), []);
  const coarser = await set("columns", 13, ({ mesh }) => mesh.grid.columns === 13);
  assert.deepEqual([coarser.pins[1].at, coarser.mass.per_vertex], ["corner:12,0", 0.192308]);

  // what the user has said stays, with an offer
  await set("mass", 0.3, ({ mass }) => mass.per_vertex === 0.3);
  const own = await set("rows", 13, ({ mesh }) => mesh.grid.rows === 13);
  assert.equal(own.mass.per_vertex, 0.3);
  await page.locator(".notice", { hasText: "Each vertex keeps its 0.3 kg" }).waitFor();
  await page.getByRole("button", { name: "97.5 kg in all instead" }).click();
  await eventually("the offer", cloth, ({ mass }) => mass.per_vertex === 0.576923);
  await client.close();
});
