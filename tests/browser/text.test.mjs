// The scene as text: edited, saved, dropped, and copied as something to run.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { isDeepStrictEqual } from "node:util";
import { Server } from "../protocol/harness.mjs";
import { browserTest, bytesOf, eventually, screenshots, withServer } from "./browser.mjs";

const { both, open } = withServer();
const sizes = { desktop: { width: 1440, height: 900 }, phone: { width: 390, height: 844, hasTouch: true } };

const area = (page) => page.getByLabel("The scene as JSON");
const wrong = (page) => page.locator("#text-wrong");

/// Opens the text, by the button of the panel or by its key.
async function opened(page, byKey = true) {
  if (byKey) await page.keyboard.press("j");
  else await page.getByRole("button", { name: "Edit as text, save, share" }).click();
  await area(page).waitFor();
}

/// Puts the caret before `text` and types: as many Deletes as `gone` has characters, then `typed`.
async function retype(page, gone, typed) {
  await area(page).evaluate((field, text) => {
    const at = field.value.indexOf(text);
    if (at < 0) throw new Error(`the text has no ${text}`);
    field.focus();
    field.setSelectionRange(at, at + text.length);
  }, gone);
  await page.keyboard.insertText(typed);
}

/// Drops files on the page, as a file manager would.
const drop = (page, files) =>
  page.evaluate((all) => {
    const dataTransfer = new DataTransfer();
    for (const [name, text] of Object.entries(all)) dataTransfer.items.add(new File([text], name));
    for (const kind of ["dragover", "drop"])
      document.body.dispatchEvent(new DragEvent(kind, { dataTransfer, bubbles: true, cancelable: true }));
  }, files);
const notice = (page, text) => page.locator("#notices .notice").filter({ hasText: text });

for (const [size, window] of Object.entries(sizes))
  browserTest(
    `${size}: an edited text is one change; what is wrong is told at its line, and nothing is lost`,
    async () => {
      const { viewer, client, scene } = await both(`edit-${size}`, window);
      const { page } = viewer;
      const before = await scene();
      if (size === "phone") await page.getByRole("button", { name: "Parameters" }).click();
      await opened(page, size !== "phone");
      assert.deepEqual(JSON.parse(await area(page).inputValue()), before);
      const apply = page.getByRole("button", { name: "Apply", exact: true });
      assert.ok(await apply.isDisabled(), "nothing is changed yet");

      await retype(page, '"dt": 0.001', '"dt": -1');
      await retype(page, '"air_drag": 0', '"air_drag": 0.5');
      const text = await area(page).inputValue();
      await page.keyboard.press("Control+Enter");
      const line = text.split("\n").findIndex((each) => each.includes('"dt": -1')) + 1;
      await wrong(page)
        .filter({ hasText: new RegExp(`^Line ${line}: /solver/dt is -1; allowed: a number from`) })
        .waitFor();
      assert.deepEqual(await scene(), before);
      assert.equal(await area(page).inputValue(), text);
      assert.equal(await area(page).getAttribute("aria-invalid"), "true");
      const selected = await area(page).evaluate((f) => f.value.slice(f.selectionStart, f.selectionEnd));
      assert.match(selected, /"dt": -1/, "the line is selected");
      const band = await page.locator(".text-band").boundingBox();
      const editor = await page.locator(".text-editor").boundingBox();
      assert.ok(band.y > editor.y && band.y + band.height < editor.y + editor.height, "and seen");
      await page.screenshot({ path: join(screenshots, `text-${size}.png`) });

      await retype(page, '"dt": -1,', '"dt": 0.0005');
      await apply.click();
      await wrong(page)
        .filter({ hasText: `Line ${line}, column` })
        .waitFor(); // the comma is gone
      assert.match(await wrong(page).textContent(), /where “,” or “}” belongs/);
      await retype(page, '"dt": 0.0005', '"dt": 0.0005,');
      const { revision } = await client.request("scene.get", {});
      await apply.click();
      await eventually("the change", scene, ({ solver }) => solver.dt === 0.0005);
      const after = await client.request("scene.get", {});
      assert.equal(after.revision, revision + 1, "one change");
      assert.deepEqual(after.document, { ...before, air_drag: 0.5, solver: { ...before.solver, dt: 0.0005 } });
      await eventually("the text is the scene's", () => apply.isDisabled(), Boolean);

      await page.keyboard.press("Escape");
      await area(page).waitFor({ state: "hidden" });
      const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert.ok(overflow <= 0);
      assert.deepEqual(
        viewer.complaints.filter((each) => !/GPU stall/.test(each)),
        [],
      );
    },
  );

browserTest(
  "a text that nobody touched follows the scene; one that is edited is applied on top, if one says so",
  async () => {
    const { viewer, client, scene } = await both("together");
    const { page } = viewer;
    await opened(page);
    await client.request("scene.patch", { patch: { air_drag: 0.25 } });
    await eventually(
      "the text",
      () => area(page).inputValue(),
      (text) => text.includes('"air_drag": 0.25'),
    );
    await retype(page, '"dt": 0.001', '"dt": 0.0005');
    await client.request("scene.patch", { patch: { gravity: [0, -1, 0] } });
    await viewer.until(() => window.clothlab.document.gravity[1] === -1);
    assert.match(await area(page).inputValue(), /-9\.8/, "the edited text stays as it is");
    await page.keyboard.press("Control+Enter");
    await wrong(page).filter({ hasText: "Somebody has changed the scene" }).waitFor();
    assert.equal((await scene()).solver.dt, 0.001);
    await page.getByRole("button", { name: "Apply mine on top" }).click();
    await eventually("both changes", scene, ({ solver, gravity }) => solver.dt === 0.0005 && gravity[1] === -1);
    await retype(page, '"dt": 0.0005', '"dt": 0.0007');
    await page.keyboard.press("Escape");
    await opened(page);
    assert.match(await area(page).inputValue(), /0\.0007/, "closing loses nothing");
    await page.getByRole("button", { name: "Take the scene's" }).click();
    assert.match(await area(page).inputValue(), /"dt": 0\.0005/);
  },
);

browserTest("a saved scene can be dropped again, with the meshes it names; the way back is offered", async () => {
  const { viewer, scene } = await both("files");
  const { page } = viewer;
  await opened(page);
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name: "Save as file" }).click(),
  ]);
  assert.equal(download.suggestedFilename(), "seed.json");
  const saved = JSON.parse((await bytesOf(download)).toString());
  const before = await scene();
  assert.deepEqual(saved, before);
  await page.keyboard.press("Escape");

  const mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n";
  const named = { ...saved, name: "mine", cloths: [{ mesh: { obj: "mine.obj" } }] };
  await drop(page, { "mine.json": JSON.stringify(named), "mine.obj": mesh });
  await notice(page, "Mine is loaded").waitFor();
  assert.equal((await scene()).cloths[0].mesh.obj, "mine.obj");
  await page.getByRole("button", { name: "Back to the scene before" }).click();
  await eventually("the scene before", scene, ({ name }) => name === "seed");
  assert.deepEqual(await scene(), before);
});

browserTest("what is wrong in a dropped file is told with its place, and the file is shown there", async () => {
  const { viewer, scene } = await both("wrong-files");
  const { page } = viewer;
  const before = await scene();
  await drop(page, { "bad.json": '{\n  "version": 1,\n  "cloths": [\n}' });
  await notice(page, "bad.json is no JSON").filter({ hasText: "Line 4, column 1" }).waitFor();
  await wrong(page).filter({ hasText: "Line 4, column 1: “}” where a value belongs." }).waitFor();
  assert.match(await area(page).inputValue(), /^\{\n {2}"version": 1/);
  await page.getByRole("button", { name: "Take the scene's" }).click();

  const cloth = '{ "mesh": { "grid": { "columns": 1,\n"rows": 5 } } }';
  await drop(page, { "small.json": `{ "version": 1,\n"cloths": [\n${cloth}\n] }` });
  await notice(page, "small.json was refused: line 3").filter({ hasText: "columns" }).waitFor();
  await wrong(page)
    .filter({ hasText: /^Line 3: \/cloths\/0\/mesh\/grid\/columns is 1; allowed/ })
    .waitFor();
  await retype(page, "5", "6");
  await drop(page, { "other.json": "{" });
  await notice(page, "other.json is no JSON").waitFor();
  assert.match(await area(page).inputValue(), /"rows": 6/, "a text that is edited stays");
  const large = { version: 1, name: "large", cloths: [{ mesh: { grid: {} } }], note: "x".repeat(70000) };
  await drop(page, { "large.json": JSON.stringify(large) });
  await notice(page, "large.json was refused").filter({ hasText: "a message may have 65536" }).waitFor();
  await drop(page, { "a.json": "{}", "b.json": "{}" });
  await notice(page, "Two scenes at once").waitFor();
  await drop(page, { "c.json": "{}", "c.obj": "v 0 0\n" });
  await notice(page, "c.obj was refused").filter({ hasText: "line 1" }).waitFor();
  assert.deepEqual(await scene(), before);
});

const changes = {
  "a few numbers": { gravity: [0, -1.6, 0], air_drag: 0.5, wind: { velocity: [1, 0, 0] }, name: "seed" },
  "another cloth and no body": {
    cloths: [{ name: "it's", mesh: { grid: { columns: 7, rows: 9 } }, pins: [{ at: "corner:6,0" }] }],
    colliders: [],
  },
  "a scene of one's own": { name: 'own "scene"', air_drag: 1 },
};
browserTest("what is copied as a command line, as Python and as JavaScript makes the same scene", async () => {
  const folder = mkdtempSync(join(dirname(fileURLToPath(import.meta.url)), "copied-"));
  try {
    const { viewer, client, scene } = await both("copy");
    const { page } = viewer;
    await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
    const server = `http://${new URL(page.url()).host}`;
    for (const name of ["clothlab.py", "clothlab.mjs"])
      writeFileSync(join(folder, name), await (await fetch(`${server}/${name}`)).text());
    await opened(page);
    // Loaded, a scene comes whole: of a patch the page has what was sent, without the defaults of what is new.
    const load = async (params) => {
      await client.request("scene.load", params);
      const loaded = await scene();
      await eventually(
        `the text of ${loaded.name}`,
        async () => JSON.parse(await area(page).inputValue()),
        (shown) => isDeepStrictEqual(shown, loaded),
      );
    };
    for (const [what, patch] of Object.entries(changes)) {
      await client.request("scene.load", { preset: "seed" });
      await client.request("scene.patch", { patch });
      const wanted = await scene();
      await load({ scene: wanted });
      for (const [kind, file, run] of [
        ["Python", "copied.py", "python3"],
        ["JavaScript", "copied.mjs", process.execPath],
      ]) {
        await page.getByRole("button", { name: kind }).click();
        const code = await page.getByLabel("Copied text").inputValue();
        await eventually(
          `${what} as ${kind}, copied`,
          () => page.evaluate(() => navigator.clipboard.readText()),
          (copied) => copied === code,
        );
        await load({ preset: "blowup" });
        writeFileSync(join(folder, file), code);
        const { status, stderr } = spawnSync(run, [join(folder, file)], { encoding: "utf8" });
        assert.equal(status, 0, `${code}\n${stderr}`);
        assert.deepEqual(await scene(), wanted, `${what} as ${kind}`);
        await load({ scene: wanted });
      }
      await page.getByRole("button", { name: "command line" }).click();
      const line = await page.getByLabel("Copied text").inputValue();
      if (what.startsWith("a scene")) {
        assert.match(line, /--scene own_scene_\.json /);
        continue;
      }
      const words = spawnSync("bash", ["-c", `clothlab() { printf '%s\\0' "$@"; }; ${line}`]);
      const [serve, ...args] = words.stdout.toString().split("\0").slice(0, -1);
      assert.equal(serve, "serve");
      const copy = await Server.start(...args);
      assert.deepEqual(JSON.parse((await copy.get("/api/scene")).body), wanted, line);
      await copy.stop();
    }
  } finally {
    rmSync(folder, { recursive: true });
  }
});

browserTest("a viewer reads, saves and copies the text, and can apply nothing", async () => {
  const guarded = await Server.start("--token", "secret", "--view-token", "public");
  try {
    const viewer = await open({ server: guarded, drawn: 0 });
    const { page } = viewer;
    await page.locator("#auth-token").fill("public");
    await page.keyboard.press("Enter");
    await viewer.until(() => window.clothlab?.framesDrawn > 2);
    await opened(page);
    await retype(page, '"dt": 0.001', '"dt": 0.0005');
    assert.ok(await page.getByRole("button", { name: "Apply", exact: true }).isDisabled());
    await page.getByRole("button", { name: "command line" }).click();
    assert.match(await page.getByLabel("Copied text").inputValue(), /--set \/solver\/dt=0\.0005/);
    await drop(page, { "a.json": '{ "version": 1, "cloths": [{ "mesh": { "grid": {} } }] }' });
    await notice(page, "Only operators may load a scene").waitFor();
  } finally {
    await guarded.stop();
  }
});
