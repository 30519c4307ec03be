// The menu of fabrics: names for the numbers of a cloth, its model, and numbers of the cloth's own.
import assert from "node:assert/strict";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { thorough } from "../thorough.mjs";

const { both } = withServer();

browserTest("a fabric from the menu, a number of the cloth's own, and back", async () => {
  const { viewer, client, scene } = await both("fabric", { sharp: thorough, paused: true });
  const menu = viewer.page.getByLabel("fabric", { exact: true });
  const material = async () => (await scene()).cloths[0].material;
  assert.equal(await menu.inputValue(), "custom");
  await menu.selectOption("interlock");
  await eventually(
    "material",
    material,
    ({ fabric, structural }) => fabric === "interlock" && structural === undefined,
  );
  assert.equal("mass" in (await scene()).cloths[0], false);

  // The page has no table: what it shows are the server's numbers.
  const shown = () => viewer.number("Cloth", "shear").inputValue();
  await eventually("shear", shown, (text) => text === "37");
  await viewer.page.getByLabel("model", { exact: true }).selectOption("finite elements");
  await eventually("model", material, ({ model }) => model === "fem");
  await eventually(
    "warp",
    () => viewer.number("Cloth", "warp").inputValue(),
    (text) => text === "34",
  );
  assert.match(await viewer.page.locator("p.note", { hasText: "T-shirt" }).textContent(), /T-shirt/);
  await viewer.page.screenshot({ path: `${screenshots}/fabric-menu.png` });

  const bending = await viewer.slider("Cloth", "bending, warp");
  await bending.focus();
  await viewer.page.keyboard.press("ArrowRight");
  await eventually("bending", material, ({ bending: own }) => own?.warp > 23e-6 && own.weft === 14e-6);
  const offer = viewer.page.getByRole("button", { name: "All of interlock" });
  await offer.waitFor();
  await viewer.page.screenshot({ path: `${screenshots}/fabric-own-number.png` });
  await offer.click();
  await eventually("bending", material, (now) => now.bending === undefined && now.fabric === "interlock");

  await menu.selectOption("custom");
  const own = await eventually("numbers", material, ({ fabric }) => fabric === undefined);
  assert.deepEqual([own.warp, own.weft, own.shear], [34, 68, 37]);
  assert.deepEqual((await scene()).cloths[0].mass, { area_density: 0.187 });
  assert.deepEqual(
    viewer.complaints.filter((text) => !text.includes("ReadPixels")), // of the pictures taken here
    [],
  );
  await client.close();
});

browserTest(
  "a fabric too stiff for the preset's time step brings a step that holds, told with a way back",
  async () => {
    const { viewer, client, scene } = await both("fabric-drape");
    await client.request("scene.load", { preset: "drape" });
    await viewer.until(() => window.clothlab.document?.name === "drape");
    const { solver } = await scene();
    const menu = viewer.page.getByLabel("fabric", { exact: true });
    await menu.selectOption("cotton");
    const told = viewer.page.locator(".notice", { hasText: "Stepped by Implicit Euler, 1/60 s" });
    await told.getByRole("button", { name: "Undo" }).dispatchEvent("click"); // while it is there, however busy all is
    await eventually("as it was", scene, (now) => now.solver.dt === solver.dt && now.solver.method === solver.method);
    assert.equal((await scene()).cloths[0].material.fabric, undefined);
    for (const fabric of ["cotton", "silk", "denim", "tango"]) {
      await menu.selectOption(fabric);
      await eventually(
        "fabric",
        async () => (await scene()).cloths[0].material.fabric,
        (now) => now === fabric,
      );
      await client.statuses(3);
    }
    assert.deepEqual(
      client.messages.filter(({ method }) => method === "sim.diverged"),
      [],
    );
    assert.equal((await scene()).solver.method, "implicit_euler");
    await client.close();
  },
);
