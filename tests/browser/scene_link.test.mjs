// A scene in a link: asked about, loaded here or in a session of its own, and refused if it is damaged.
import assert from "node:assert/strict";
import { join } from "node:path";
import { deflateRawSync } from "node:zlib";
import { Server } from "../protocol/harness.mjs";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";

const here = withServer();
const { both } = here;
const base64url = (bytes) => Buffer.from(bytes).toString("base64url");
const linked = (text) => `#scene=${base64url(deflateRawSync(text))}`;
const scene = { version: 1, name: "linked", cloths: [{ mesh: { grid: { columns: 5, rows: 5 } } }] };
const sizes = [
  ["desktop", { width: 1440, height: 900 }],
  ["phone", { width: 390, height: 844, hasTouch: true }],
  ["narrow", { width: 320, height: 640 }],
];

/// The page's dialog, after its address has got this fragment.
async function offered(page, fragment) {
  await page.evaluate((hash) => (location.hash = hash), fragment);
  const dialog = page.getByRole("dialog", { name: "A scene by link" });
  await dialog.waitFor();
  return dialog;
}

for (const [size, window] of sizes)
  browserTest(`${size}: a copied link opens as a question, and then in a session of its own`, async () => {
    const { viewer, client } = await both(`from-${size}`, window);
    await client.request("scene.load", { scene });
    const shared = (await client.request("scene.get", {})).document;
    await viewer.until(() => window.clothlab.document.name === "linked");
    await viewer.page.keyboard.press("j");
    await viewer.page.getByRole("button", { name: "link", exact: true }).click();
    const copied = viewer.page.getByLabel("Copied text");
    await copied.waitFor();
    const link = await copied.inputValue();
    assert.match(link, /^http:\/\/127\.0\.0\.1:\d+\/#scene=[\w-]+$/);
    await viewer.page.context().close();

    const other = await here.open({ session: `to-${size}`, ...window });
    const { page } = other;
    await page.goto(link.replace("/#", `/?session=to-${size}#`));
    await page.reload(); // only the fragment differed
    const dialog = page.getByRole("dialog", { name: "A scene by link" });
    await dialog.filter({ hasText: "“linked”: 1 cloth and 0 bodies." }).waitFor();
    await page.screenshot({ path: join(screenshots, `link-${size}.png`) });
    const box = await dialog.boundingBox();
    assert.ok(box.x >= 0 && box.x + box.width <= window.width && box.y + box.height <= window.height);
    await other.until(() => window.clothlab.document?.name === "seed", "asked first");
    assert.equal(await page.evaluate(() => document.activeElement.textContent), "Open it in a session of its own");
    await page.keyboard.press("Enter");
    await page.waitForURL(/session=scene-\w+$/);
    await other.until(() => window.clothlab?.document?.name === "linked");
    const session = new URL(page.url()).searchParams.get("session");
    const loaded = JSON.parse((await here.server.get(`/api/scene?session=${session}`)).body);
    assert.deepEqual(loaded, shared);
    assert.equal(JSON.parse((await here.server.get(`/api/scene?session=to-${size}`)).body).name, "seed");
    await page.reload();
    await other.until(() => window.clothlab?.framesDrawn > 3);
    assert.equal(await page.getByRole("dialog").count(), 0, "a reload asks nothing and loads nothing");
  });

browserTest("it is loaded here only if one says so, and Escape loads nothing", async () => {
  const { viewer, client, scene: now } = await both("here");
  const { page } = viewer;
  const { revision } = await client.request("scene.get", {});
  await offered(page, linked(JSON.stringify(scene)));
  await page.keyboard.press("Escape");
  await page.getByRole("dialog").waitFor({ state: "detached" });
  assert.equal(new URL(page.url()).hash, "");
  assert.equal((await client.request("scene.get", {})).revision, revision);
  const dialog = await offered(page, linked(JSON.stringify(scene)));
  await dialog.getByRole("button", { name: "Load it in “here”, for everybody there" }).click();
  await eventually("the scene", now, ({ name }) => name === "linked");
  await page.locator(".notice", { hasText: "Linked is loaded" }).waitFor();
  // The server checks it as any other scene.
  const wrong = await offered(page, linked(JSON.stringify({ ...scene, gravity: 7 })));
  await wrong.getByRole("button", { name: /^Load it in/ }).click();
  await page
    .locator(".notice", { hasText: "The scene of the link was refused" })
    .filter({ hasText: "/gravity" })
    .waitFor();
  assert.equal((await now()).name, "linked");
});

browserTest("a damaged link, one that is too large and one that is no scene are refused in words", async () => {
  const { viewer, scene: now } = await both("damaged");
  const { page } = viewer;
  const whole = linked(JSON.stringify(scene));
  for (const [fragment, says] of [
    [whole.slice(0, -12), /damaged/],
    [`${whole}!`, /damaged/],
    ["#scene=", /damaged/],
    [linked("{"), /damaged/],
    [linked('{"version": 1}'), /it has no cloths/],
    [linked("[1]"), /it has no cloths/],
    [linked(" ".repeat(200_000_000)), /more than the 65536 bytes/],
  ]) {
    await page.evaluate((hash) => (location.hash = hash), fragment);
    const notice = page.locator(".notice", { hasText: "No scene in this link" });
    await notice.filter({ hasText: says }).waitFor();
    assert.equal(new URL(page.url()).hash, "", "it is not read again");
    await notice.getByRole("button", { name: "Dismiss" }).click();
  }
  assert.equal(await page.getByRole("dialog").count(), 0);
  assert.equal((await now()).name, "seed");
});

browserTest("a viewer of a session may only open it apart", async () => {
  const guarded = await Server.start("--token", "secret", "--view-token", "public");
  try {
    const viewer = await here.open({ server: guarded, drawn: 0 });
    await viewer.page.locator("#auth-token").fill("public");
    await viewer.page.keyboard.press("Enter");
    await viewer.until(() => window.clothlab?.framesDrawn > 2);
    const dialog = await offered(viewer.page, linked(JSON.stringify(scene)));
    assert.equal(await dialog.getByRole("button").count(), 2);
    assert.equal(await dialog.getByRole("button", { name: /^Load it in/ }).count(), 0);
  } finally {
    await guarded.stop();
  }
});
