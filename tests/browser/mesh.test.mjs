import assert from "node:assert/strict";
import { browserTest, eventually, withServer } from "./browser.mjs";

const { both } = withServer();

/// Drops a file on the page, as a file manager would.
const drop = (page, name, text) =>
  page.evaluate(
    ({ name, text }) => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([text], name));
      for (const kind of ["dragover", "drop"])
        document.body.dispatchEvent(new DragEvent(kind, { dataTransfer, bubbles: true, cancelable: true }));
    },
    { name, text },
  );
const notices = (page) => page.locator("#notices .notice").allTextContents();

browserTest("a mesh dropped on the page hangs and moves; what is no mesh is refused by its line", async () => {
  const { viewer, client, scene } = await both("drop");
  // A strip of ten squares, upright, in centimetres.
  let text = "";
  for (let row = 0; row <= 10; ++row) text += `v 0 ${10 * row} 0\nv 10 ${10 * row} 0\n`;
  for (let row = 0; row < 10; ++row) text += `f ${2 * row + 1} ${2 * row + 2} ${2 * row + 4} ${2 * row + 3}\n`;
  await drop(viewer.page, "strip.obj", text);
  await eventually(
    "the cloth's mesh",
    async () => (await scene()).cloths[0].mesh,
    (mesh) => mesh.file === "strip.obj",
  );
  const drawn = () => viewer.page.evaluate(() => [window.clothlab.lastFrame.header.vertexCount, window.clothlab.step]);
  const [, step] = await eventually("the strip's frames", drawn, ([vertices]) => vertices === 22);
  await eventually("its motion", drawn, ([, now]) => now > step);
  assert.equal((await scene()).cloths[0].transform.scale, 0.01);
  await eventually(
    "a notice",
    () => notices(viewer.page),
    (all) => all.some((notice) => /strip\.obj hangs/i.test(notice)),
  );

  await drop(viewer.page, "bad.obj", "v 0 0 0\nv nan 0 0\n");
  await eventually(
    "the refusal",
    () => notices(viewer.page),
    (all) => all.some((notice) => /bad\.obj was refused/i.test(notice) && notice.includes('line 2: "nan" as x')),
  );
  await drop(viewer.page, "photo.jpg", "x");
  await eventually(
    "the other refusal",
    () => notices(viewer.page),
    (all) => all.some((notice) => /photo\.jpg is no mesh/i.test(notice)),
  );
  assert.equal((await scene()).cloths[0].mesh.file, "strip.obj");
  await client.close();
});
