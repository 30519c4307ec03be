// What is on screen, saved as a picture and as a video.
import assert from "node:assert/strict";
import { browserTest, bytesOf, countRed, eventually, screenshots, withServer } from "./browser.mjs";

const here = withServer();

/// The file that a press saves.
async function saved({ page }, press) {
  const [download] = await Promise.all([page.waitForEvent("download"), press()]);
  return { name: download.suggestedFilename(), bytes: await bytesOf(download) };
}

browserTest("a picture is a PNG of the canvas at full resolution, on the page's backdrop", async () => {
  const viewer = await here.open({ session: "save-picture", width: 1280, height: 800, sharp: true });
  const { page } = viewer;
  await viewer.until(() => window.clothlab.simTime > 0.5);
  await viewer.pause();
  const { name, bytes } = await saved(viewer, () => page.getByRole("button", { name: "Picture" }).click());
  const time = await viewer.read("simTime");
  assert.equal(name, `seed-${time.toFixed(2)}s.png`);
  const size = await page.evaluate(() => {
    const { canvas } = window.clothlab.stage;
    return [canvas.width, canvas.height];
  });
  assert.ok(size[0] >= 1280);
  const helper = await page.context().browser().newPage();
  const seen = await helper.evaluate(async (png) => {
    const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    let clear = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] < 255) clear++;
    return { size: [image.width, image.height], clear };
  }, bytes.toString("base64"));
  const saw = await helper.evaluate(countRed, bytes.toString("base64"));
  await helper.close();
  const onScreen = await viewer.cloth();
  assert.deepEqual(seen.size, size);
  // How large the cloth is depends on the moment. Labels that float over the canvas may hide a little of it.
  assert.ok(onScreen.count > 0 && Math.abs(saw.share / onScreen.share - 1) < 0.1, JSON.stringify([saw, onScreen]));
  assert.equal(seen.clear, 0, "nothing is transparent");
});

browserTest("a model is the cloths as binary glTF", async () => {
  const viewer = await here.open({ session: "save-model", width: 1280, height: 800 });
  const { name, bytes } = await saved(viewer, () => viewer.page.getByRole("button", { name: "Model" }).click());
  assert.match(name, /^seed-\d+\.\d\ds\.glb$/);
  assert.equal(bytes.subarray(0, 4).toString(), "glTF");
  assert.equal(bytes.readUInt32LE(8), bytes.length);
});

browserTest("a video is a WebM that plays, with the motion that was on screen", async () => {
  const viewer = await here.open({ session: "save-video", width: 900, height: 600, sharp: true });
  const { page } = viewer;
  const video = page.locator("#save-video");
  await video.click();
  await eventually(
    "recording",
    () => video.textContent(),
    (text) => /^Stop video \([2-9] s\)$/.test(text),
  );
  await page.screenshot({ path: `${screenshots}save-video-900x600.png` });
  const { name, bytes } = await saved(viewer, () => video.click());
  assert.match(name, /^seed-\d+\.\d\ds\.webm$/);
  assert.deepEqual([...bytes.subarray(0, 4)], [0x1a, 0x45, 0xdf, 0xa3], "EBML");
  await eventually(
    "ended",
    () => video.textContent(),
    (text) => text === "Video",
  );
  const helper = await page.context().browser().newPage();
  const played = await helper.evaluate(async (webm) => {
    const player = document.createElement("video");
    player.muted = true;
    player.src = `data:video/webm;base64,${webm}`;
    const pictures = [];
    const canvas = new OffscreenCanvas(90, 60).getContext("2d", { willReadFrequently: true });
    await new Promise((resolve, reject) => {
      player.onerror = () => reject(new Error(player.error.message));
      player.onended = resolve;
      player.ontimeupdate = () => {
        canvas.drawImage(player, 0, 0, 90, 60);
        pictures.push(canvas.getImageData(0, 0, 90, 60).data);
      };
      player.play().catch(reject);
    });
    const [first, last] = [pictures[0], pictures.at(-1)];
    const moved = first.filter((value, i) => Math.abs(value - last[i]) > 20).length;
    return { width: player.videoWidth, height: player.videoHeight, pictures: pictures.length, moved };
  }, bytes.toString("base64"));
  await helper.close();
  assert.ok(played.width >= 500 && Math.abs(played.width / played.height - 1.5) < 0.02, JSON.stringify(played));
  assert.ok(played.pictures > 2 && played.moved > 20, JSON.stringify(played));
});

browserTest("a browser without MediaRecorder says so, and offers what it can", async () => {
  const viewer = await here.open({ session: "save-none", width: 900, height: 600 });
  await viewer.page.evaluate(() => delete window.MediaRecorder);
  await viewer.page.locator("#save-video").click();
  await viewer.page.getByText("This browser records no video").waitFor();
  assert.equal(await viewer.page.locator("#save-video").textContent(), "Video");
});
