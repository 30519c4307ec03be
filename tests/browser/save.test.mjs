// What is on screen, saved as a picture and as a video.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { browserTest, bytesOf, eventually, screenshots, withServer } from "./browser.mjs";

const here = withServer();

/// The file that a press saves.
async function saved({ page }, press) {
  const [download] = await Promise.all([page.waitForEvent("download"), press()]);
  return { name: download.suggestedFilename(), bytes: await bytesOf(download) };
}

/// Presses Picture; what is in the file: its size, the box of what is no background, and how much of it is white.
async function picture(viewer) {
  const { page } = viewer;
  const { name, bytes } = await saved(viewer, () => page.getByRole("button", { name: "Picture" }).click());
  const helper = await page.context().browser().newPage();
  const seen = await helper.evaluate(async (png) => {
    const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
    const { width, height } = image;
    const context = new OffscreenCanvas(width, height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    const found = { width, height, clear: 0, white: 0, left: width, right: 0, top: height, bottom: 0 };
    for (let i = 0; i < data.length; i += 4) {
      const [x, y] = [(i / 4) % width, Math.floor(i / 4 / width)];
      if (data[i + 3] < 255) {
        found.clear++;
        continue;
      }
      if (Math.min(data[i], data[i + 1], data[i + 2]) > 250) found.white++;
      [found.left, found.right] = [Math.min(found.left, x), Math.max(found.right, x)];
      [found.top, found.bottom] = [Math.min(found.top, y), Math.max(found.bottom, y)];
    }
    return found;
  }, bytes.toString("base64"));
  await helper.close();
  return { name, bytes, ...seen };
}
const screenPlace = (viewer) => viewer.page.evaluate(() => window.clothlab.stage.camera.matrixWorld.toArray());

browserTest("a picture has the size that is chosen, its subject in the middle, and no marks", async () => {
  const viewer = await here.open({ session: "save-picture", width: 1280, height: 800, sharp: true });
  const { page } = viewer;
  await viewer.until(() => window.clothlab.simTime > 0.5);
  await viewer.pause(); // before the card of figures has the focus, whose key Space is then
  await viewer.figures();
  const time = await viewer.read("simTime");
  const onPage = await picture(viewer);
  assert.equal(onPage.name, `seed-${time.toFixed(2)}s.png`);
  assert.deepEqual([onPage.width, onPage.height, onPage.clear], [1280, 800, 0], "opaque, as large as the window");
  writeFileSync(`${screenshots}save-window.png`, onPage.bytes);
  const before = await screenPlace(viewer);
  await page.getByRole("checkbox", { name: "Clear" }).check();
  for (const [label, width, height] of [
    ["1080p", 1920, 1080],
    ["Square", 1080, 1080],
    ["4K", 3840, 2160],
  ]) {
    await page.getByRole("combobox", { name: "Size of pictures and videos" }).selectOption({ label });
    const seen = await picture(viewer);
    writeFileSync(`${screenshots}save-${label}.png`, seen.bytes);
    assert.deepEqual([seen.width, seen.height], [width, height]);
    assert.ok(seen.clear > 0.3 * width * height, "beside the scene it is transparent");
    assert.equal(seen.white, 0, "the white dots of the pins are not there");
    // The camera fits both to the same margin: to a twentieth, as perspective makes the near side larger.
    const [wide, high] = [(seen.right - seen.left) / width, (seen.bottom - seen.top) / height];
    assert.ok(Math.max(wide, high) > 0.85 && Math.max(wide, high) < 1, `it fills ${[wide, high]} of the picture`);
    assert.ok(Math.abs((seen.left + seen.right) / 2 / width - 0.5) < 0.03, JSON.stringify({ ...seen, bytes: 0 }));
    assert.ok(Math.abs((seen.top + seen.bottom) / 2 / height - 0.5) < 0.03, JSON.stringify({ ...seen, bytes: 0 }));
  }
  assert.deepEqual(await screenPlace(viewer), before, "the camera is where it was");
  await viewer.still();
  const shown = await viewer.cloth();
  assert.ok(shown.share > 0.03, "the window shows its own picture again");
});

browserTest("a picture from the user's own camera has what the cards leave free in its middle", async () => {
  const viewer = await here.open({ session: "save-camera", width: 1280, height: 800, sharp: true });
  const { page } = viewer;
  await viewer.until(() => window.clothlab.simTime > 0.5);
  await viewer.pause();
  await viewer.figures();
  const { left, top, width, height } = await page.evaluate(() => window.clothlab.stage.area);
  const [x, y] = [left + width / 2, top + height / 2];
  await page.mouse.move(x, y - 0.45 * height);
  await page.mouse.wheel(0, 300); // farther
  await viewer.until(() => !window.clothlab.stage.fitted);
  await viewer.still();
  await page.getByRole("checkbox", { name: "Clear" }).check();
  const seen = await picture(viewer);
  writeFileSync(`${screenshots}save-camera.png`, seen.bytes);
  const wide = (seen.right - seen.left) / seen.width;
  const high = (seen.bottom - seen.top) / seen.height;
  assert.ok(Math.max(wide, high) < 0.85, "it is as far as the user went");
  assert.ok(Math.abs((seen.left + seen.right) / 2 / seen.width - 0.5) < 0.1, JSON.stringify({ ...seen, bytes: 0 }));
});

browserTest("a model is the cloths as binary glTF", async () => {
  const viewer = await here.open({ session: "save-model", width: 1280, height: 800 });
  await viewer.figures();
  const { name, bytes } = await saved(viewer, () => viewer.page.getByRole("button", { name: "Model" }).click());
  assert.match(name, /^seed-\d+\.\d\ds\.glb$/);
  assert.equal(bytes.subarray(0, 4).toString(), "glTF");
  assert.equal(bytes.readUInt32LE(8), bytes.length);
});

browserTest("a video is a WebM that plays, with the motion that was on screen", async () => {
  const viewer = await here.open({ session: "save-video", width: 900, height: 600 });
  const { page } = viewer;
  await viewer.figures();
  await page.getByRole("combobox", { name: "Size of pictures and videos" }).selectOption({ label: "Square" });
  const video = page.locator("#save-video");
  await video.click();
  await eventually(
    "recording",
    () => video.textContent(),
    (text) => /^Stop video \([2-9] s\)$/.test(text),
  );
  await page.screenshot({ path: `${screenshots}save-video-900x600.png` });
  const drawn = await page.evaluate(() => [window.clothlab.stage.canvas.width, window.clothlab.stage.canvas.height]);
  assert.ok(Math.min(...drawn) >= 1080, `a film of 1080 x 1080 is drawn with ${drawn.join(" x ")} pixels`);
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
    let length = null;
    const canvas = new OffscreenCanvas(90, 60).getContext("2d", { willReadFrequently: true });
    await new Promise((resolve, reject) => {
      player.onerror = () => reject(new Error(player.error.message));
      player.onended = resolve;
      player.onloadedmetadata = () => (length = player.duration);
      player.ontimeupdate = () => {
        canvas.drawImage(player, 0, 0, 90, 60);
        pictures.push(canvas.getImageData(0, 0, 90, 60).data);
      };
      player.play().catch(reject);
    });
    const [first, last] = [pictures[0], pictures.at(-1)];
    const moved = first.filter((value, i) => Math.abs(value - last[i]) > 20).length;
    const { videoWidth: width, videoHeight: height, currentTime } = player;
    return { width, height, pictures: pictures.length, moved, length, currentTime };
  }, bytes.toString("base64"));
  await helper.close();
  assert.ok(played.width === 1080 && played.height === 1080, JSON.stringify(played));
  assert.ok(Math.abs(played.length - played.currentTime) < 0.1 && played.length > 1.5, JSON.stringify(played));
  assert.ok(played.pictures > 2 && played.moved > 20, JSON.stringify(played));
});

browserTest("a browser without MediaRecorder says so, and offers what it can", async () => {
  const viewer = await here.open({ session: "save-none", width: 900, height: 600 });
  await viewer.page.evaluate(() => delete window.MediaRecorder);
  await viewer.figures();
  await viewer.page.locator("#save-video").click();
  await viewer.page.getByText("This browser records no video").waitFor();
  assert.equal(await viewer.page.locator("#save-video").textContent(), "Video");
});
