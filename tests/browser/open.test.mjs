// Files of the user's own, opened by the button or dropped: what is asked, and what becomes of them.
import assert from "node:assert/strict";
import { patience } from "../protocol/harness.mjs";
import { thorough } from "../thorough.mjs";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { dressed, figure, tube } from "./garment.mjs";
import { choose, drag } from "./opening.mjs";

const { both } = withServer();

// Wider than the body where it begins, narrower than its hips: it comes to rest there.
const poncho = { radius: 0.18, from: 1.35, to: 1.62 };

const notices = (page) => page.locator("#notices .notice").allTextContents();
const told = (page, what) =>
  eventually(
    `a notice of ${what}`,
    () => notices(page),
    (all) => all.some((each) => what.test(each)),
  );
const radio = (dialog, group, name) => dialog.getByRole("radiogroup", { name: group }).getByRole("radio", { name });
const status = (page) => page.evaluate(() => [window.clothlab.lastFrame.header.vertexCount, window.clothlab.step]);

browserTest("a shirt and a body in millimetres: opened by the button, put on, and moving", async () => {
  const { viewer, client, scene } = await both("put-on", { width: 1440, height: 900, sharp: thorough });
  const { page } = viewer;
  const dialog = await choose(page, [
    ["shirt.obj", tube(poncho)],
    ["figure.obj", figure()],
  ]);
  assert.ok(await radio(dialog, "shirt.obj is", "Cloth").isChecked());
  assert.ok(await radio(dialog, "figure.obj is", "Body").isChecked());
  assert.equal(await dialog.getByRole("combobox", { name: "unit" }).inputValue(), "mm");
  assert.match(await dialog.locator(".open-size").textContent(), /^1\.7 m tall, 40 cm wide/);
  await page.screenshot({ path: `${screenshots}open-dialog.png` });
  await dialog.getByRole("button", { name: "Open", exact: true }).click();
  await told(page, /Opened shirt\.obj and figure\.obj.*1\.7 m tall.*Surfaces keep 2\.\d+ mm apart/);
  const { cloths, colliders, self_collision, solver, name } = await scene();
  assert.equal(name, "shirt");
  assert.deepEqual([cloths.length, colliders.length], [1, 1]);
  assert.equal(cloths[0].material.fabric, "cotton");
  assert.equal(cloths[0].mass, undefined, "cotton has its density");
  assert.deepEqual(cloths[0].pins, []);
  for (const { transform } of [cloths[0], colliders[0]])
    assert.deepEqual(transform, { translate: [0, 0, 0], rotate: [0, 0, 0], scale: 0.001 });
  const { thickness, ...contact } = self_collision;
  assert.deepEqual(contact, { kind: "surface", friction: 0.3 });
  // edges along are 11 mm long, those around 21 to 28, the others between: a tenth of their mean
  assert.ok(thickness > 0.0011 && thickness < 0.0028, `${thickness} m`);
  assert.equal(solver.method, "implicit_euler");
  // Each step is a solve with contact, beside which the page is drawn: a busy machine takes seconds for it.
  const [vertices] = await eventually(
    "steps",
    () => status(page),
    ([count, step]) => count === 1000 && step > (thorough ? 20 : 8),
    4 * patience,
  );
  assert.equal(vertices, 25 * 40);
  const heights = (await viewer.positions()).map(([, y]) => y);
  assert.ok(Math.min(...heights) > 0.7, `the body carries it: its lowest vertex is at ${Math.min(...heights)} m`);
  await page.screenshot({ path: `${screenshots}open-put-on.png` });
  // one step of undo
  await page.keyboard.press("Control+z");
  await eventually("the scene before", scene, (now) => now.name === "seed" && now.cloths.length === 1);
  assert.deepEqual(
    viewer.complaints.filter((text) => !text.includes("ReadPixels")), // of the pictures taken here
    [],
  );
  await client.close();
});

browserTest("by touch on a phone", async () => {
  const { viewer, client, scene } = await both("touch", { width: 390, height: 844, hasTouch: true, sharp: thorough });
  const { page } = viewer;
  const open = page.getByRole("button", { name: "Open files" });
  if (!(await open.isVisible())) await page.locator("#sheet-handle").tap();
  await open.waitFor();
  const dialog = await choose(
    page,
    [
      ["shirt.obj", tube()],
      ["figure.obj", figure()],
    ],
    (button) => button.tap(),
  );
  await page.screenshot({ path: `${screenshots}open-phone.png` });
  const box = await dialog.boundingBox();
  assert.ok(box.x >= 0 && box.x + box.width <= 390 && box.y >= 0 && box.y + box.height <= 844, JSON.stringify(box));
  const wide = await dialog.evaluate((element) => element.scrollWidth - element.clientWidth);
  assert.equal(wide, 0, "nothing is cut off at its side");
  await dialog.getByRole("button", { name: "Open", exact: true }).tap();
  await eventually("the shirt", scene, ({ cloths, colliders }) => cloths[0].name === "shirt" && colliders.length === 1);
  await eventually(
    "steps",
    () => status(page),
    ([count, step]) => count === 1000 && step > 5,
  );
  await page.screenshot({ path: `${screenshots}open-phone-put-on.png` });
  await client.close();
});

browserTest("a garment that nothing holds is paused, and is held by the waist at a click", async () => {
  const { viewer, client, scene } = await both("hold", { width: 1440, height: 900, sharp: thorough });
  const { page } = viewer;
  await drag(page, ["dragenter", "dragover"], [["skirt.obj", tube()]]);
  await page.locator(".drop-picture").waitFor();
  await drag(page, ["drop"], [["skirt.obj", tube()]]);
  const dialog = page.getByRole("dialog", { name: "Open skirt.obj" });
  await dialog.waitFor();
  assert.equal(await page.locator(".drop-picture").count(), 0);
  const held = dialog.getByLabel("held at");
  assert.equal(await held.inputValue(), "waist", "what no body carries is held where it hangs");
  await held.selectOption("");
  await dialog.getByRole("button", { name: "Open", exact: true }).click();
  await told(page, /nothing holds it: paused/i);
  await page.screenshot({ path: `${screenshots}open-hold.png` });
  await eventually(
    "the skirt",
    () => status(page),
    ([count, step]) => count === 1000 && step === 0,
  );
  await page.getByRole("button", { name: "Hold the waist" }).click();
  await eventually(
    "its motion",
    () => status(page),
    ([, step]) => step > 3,
  );
  const { pins } = (await scene()).cloths[0];
  assert.deepEqual(
    pins.map(({ at }) => Number(at.slice("vertex:".length))).sort((a, b) => a - b),
    [...Array.from({ length: 40 }, (_, i) => 960 + i)],
  );
  const heights = (await viewer.positions()).map(([, y]) => y);
  assert.ok(Math.max(...heights) > 1.4, "it hangs by its waist");
  // a body that comes later is added, in the unit and the place of the shirt
  await drag(page, ["drop"], [["figure.obj", figure()]]);
  const second = page.getByRole("dialog", { name: "Open figure.obj" });
  await second.waitFor();
  assert.ok(await radio(second, "where", /Added/).isChecked());
  await second.getByRole("button", { name: "Open", exact: true }).click();
  const added = await eventually("the body", scene, ({ colliders }) => colliders.length === 1);
  assert.equal(added.cloths[0].mesh.file, "skirt.obj");
  assert.equal(added.self_collision.kind, "surface");
  await client.close();
});

browserTest("the parts of a file are taken apart", async () => {
  const { viewer, client, scene } = await both("apart");
  const dialog = await choose(viewer.page, [["dressed.obj", dressed()]]);
  await dialog.getByRole("button", { name: "Take apart: 2 parts" }).click();
  assert.ok(await radio(dialog, "shirt is", "Cloth").isChecked());
  assert.ok(await radio(dialog, "figure is", "Body").isChecked());
  await dialog.getByRole("button", { name: "Open", exact: true }).click();
  const { cloths, colliders } = await eventually("both", scene, (now) => now.colliders.length === 1);
  assert.deepEqual([cloths[0].mesh.file, cloths[0].mesh.node], ["dressed.obj", "shirt"]);
  assert.deepEqual([colliders[0].mesh.file, colliders[0].mesh.node], ["dressed.obj", "figure"]);
  await client.close();
});

browserTest("cloth that would go through the body stands beside it, with the words of the refusal", async () => {
  const { viewer, client, scene } = await both("through", { width: 1440, height: 900, sharp: thorough });
  const { page } = viewer;
  const narrow = { radius: 0.15 };
  const dialog = await choose(page, [
    ["tight.obj", tube(narrow)],
    ["figure.obj", figure()],
  ]);
  await dialog.getByRole("button", { name: "Open", exact: true }).click();
  await told(page, /passing through a body, in \d+ places/);
  await page.screenshot({ path: `${screenshots}open-aside.png` });
  const { cloths, colliders } = await scene();
  assert.equal(colliders.length, 1);
  assert.ok(cloths[0].transform.translate[0] > 0.3, "beside it");
  // higher than the body, it comes back over its head
  await client.request("scene.patch", {
    patch: [
      { op: "replace", path: "/cloths/0/transform/scale", value: 0.0012 },
      { op: "replace", path: "/cloths/0/transform/translate", value: [cloths[0].transform.translate[0], 1, 0] },
    ],
  });
  await page.getByRole("button", { name: "Put it back" }).click();
  await eventually("it is put on", scene, (now) => now.cloths[0].transform.translate[0] === 0);
  const { translate, scale } = (await scene()).cloths[0].transform;
  assert.deepEqual([translate, scale], [[0, 1, 0], 0.0012], "as it was scaled and raised meanwhile");
  await client.close();
});

browserTest("cloth that would go through the body is led out of it, by one button", async () => {
  const { viewer, client, scene } = await both("led-out", { width: 1440, height: 900 });
  const { page } = viewer;
  const dialog = await choose(page, [
    ["tight.obj", tube({ radius: 0.19 })],
    ["figure.obj", figure()],
  ]);
  await dialog.getByRole("button", { name: "Open", exact: true }).click();
  await told(page, /passing through a body, in \d+ places/);
  await page.getByRole("button", { name: "Lead it out" }).click();
  const [cloth] = (await eventually("it is put on", scene, (now) => now.cloths[0]?.start)).cloths;
  assert.deepEqual([cloth.start, cloth.transform.translate], [{ dress: 1 }, [0, 0, 0]]);
  await client.close();
});

browserTest("what is no mesh is refused by its line; a cancelled file changes nothing", async () => {
  const { viewer, client, scene } = await both("refused");
  const { page } = viewer;
  await drag(page, ["drop"], [["bad.obj", "v 0 0 0\nv nan 0 0\n"]]);
  await told(page, /bad\.obj was refused.*line 2: "nan" as x/i);
  await drag(page, ["drop"], [["photo.jpg", "x"]]);
  await told(page, /photo\.jpg is no mesh/i);
  const before = await scene();
  const dialog = await choose(page, [["shirt.obj", tube()]]);
  await dialog.getByRole("button", { name: "Cancel" }).click();
  await dialog.waitFor({ state: "detached" });
  assert.deepEqual(await scene(), before);
  await client.close();
});
