// What a first visit sees, and what stands where on it: the scene, the figures, the panel, messages.
import assert from "node:assert/strict";
import { browserTest, eventually, screenshots, withServer } from "./browser.mjs";
import { Client, Server } from "../protocol/harness.mjs";

const here = withServer();

const sceneOf = async (server, session = "main") => {
  const client = await Client.connect(server, { session });
  const { document } = await client.request("scene.get", {});
  await client.close();
  return document.name;
};

/// Opens the server's own address, as somebody who has never been there.
async function firstVisit(server, options = {}) {
  const viewer = await here.open({
    server,
    newcomer: true,
    width: 1440,
    height: 900,
    drawn: 0,
    session: null,
    ...options,
  });
  await viewer.until(() => window.clothlab?.framesDrawn > 1);
  return viewer;
}

browserTest(
  "a first visit to a server that nobody has used sees cloth fall over a ball, and the seed is one click away",
  async () => {
    const server = await Server.start();
    try {
      const { page } = await firstVisit(server);
      // Not one picture of another scene comes before.
      assert.equal(await page.evaluate(() => window.clothlab.document.name), "drape");
      const headline = page.locator("#figures > summary");
      await headline.filter({ hasText: /\d+ fps\s*(×\d|paused|at rest).*\s*Stable/ }).waitFor();
      assert.equal(await page.locator("#stats").isVisible(), false);
      for (const name of ["Record", "Share"])
        assert.ok(await page.getByRole("button", { name, exact: true }).isVisible());
      await page.screenshot({ path: `${screenshots}first-screen-1440x900.png` });
      await page.locator("#first-steps").getByRole("button", { name: "seed" }).click();
      await page.waitForFunction(() => window.clothlab.document.name === "seed");
      await headline.click();
      await page.locator("#stats").getByText("Vertices").waitFor();
    } finally {
      await server.stop();
    }
  },
);

for (const [who, args, before] of [
  ["a script that has the session open", [], (server) => Client.connect(server, { session: "main" })],
  [
    "a script that has been there",
    [],
    async (server) => {
      await (await Client.connect(server, { session: "main" })).close();
    },
  ],
  ["a picture asked for over HTTP", [], (server) => fetch(`http://${server.host}/api/snapshot.png?width=64&height=64`)],
  ["the seed named on the command line", ["seed"], () => undefined],
  ["a value set on the command line", ["--set", "/solver/dt=0.0005"], () => undefined],
])
  browserTest(`the scene stays that somebody uses: ${who}`, async () => {
    const server = await Server.start(...args);
    try {
      await before(server);
      const { page } = await firstVisit(server);
      await page.locator("#first-steps").waitFor();
      assert.equal(await page.evaluate(() => window.clothlab.document.name), "seed");
      assert.equal(await sceneOf(server), "seed");
    } finally {
      await server.stop();
    }
  });

browserTest("two first visits at once make one scene, and a second one leaves it as it is", async () => {
  const server = await Server.start();
  try {
    const [first, second] = await Promise.all([firstVisit(server), firstVisit(server)]);
    const names = await Promise.all(
      [first, second].map(({ page }) => page.evaluate(() => window.clothlab.document.name)),
    );
    assert.equal(names[0], names[1]);
    const client = await Client.connect(server, { session: "main" });
    const { revision } = await client.request("scene.get", {});
    const third = await firstVisit(server);
    await third.page.locator("#first-steps").waitFor();
    assert.equal((await client.request("scene.get", {})).revision, revision);
    await client.close();
  } finally {
    await server.stop();
  }
});

browserTest("a session that the address names, a visitor who comes back and a script get the seed", async () => {
  const server = await Server.start();
  try {
    const named = await here.open({ server, newcomer: true, session: "mine" });
    await named.page.locator("#first-steps").waitFor();
    assert.equal(await sceneOf(server, "mine"), "seed");
    const back = await firstVisit(server, { newcomer: false });
    assert.equal(await back.page.evaluate(() => window.clothlab.document.name), "seed");
    assert.equal(await sceneOf(server), "seed");
  } finally {
    await server.stop();
  }
});

const share = ({ page }) =>
  page.evaluate(() => {
    const { width, height } = window.clothlab.stage.area;
    return (width * height) / (innerWidth * innerHeight);
  });

for (const [width, height, folded] of [
  [768, 1024, true],
  [1024, 768, false],
  [1440, 900, false],
])
  browserTest(
    `at ${width}x${height} the cloth has at least half of the window, the panel ${folded ? "closed" : "open"}`,
    async () => {
      const session = `half-${width}`;
      const viewer = await here.open({ session, width, height, newcomer: true });
      const { page } = viewer;
      const handle = page.getByRole("button", { name: "Parameters" });
      assert.equal(await handle.getAttribute("aria-expanded"), String(!folded));
      await page.getByRole("button", { name: "Close the first steps" }).click();
      await eventually(
        "the picture's share",
        () => share(viewer),
        (now) => now >= 0.5,
      );
      await handle.click();
      await page.reload();
      await viewer.until(() => window.clothlab?.framesDrawn > 1);
      assert.equal(await handle.getAttribute("aria-expanded"), String(folded), "what was chosen is kept");
    },
  );

browserTest("a key after a click draws no frame around the picture; the focus that comes by Tab has one", async () => {
  const { page } = await here.open({ session: "frame" });
  const outline = () => page.locator("#view").evaluate((view) => getComputedStyle(view).outlineStyle);
  await page.mouse.click(60, 400);
  await page.keyboard.press(" ");
  assert.equal(await page.evaluate(() => document.activeElement.id), "view");
  assert.equal(await outline(), "none");
  await page.keyboard.press("Tab");
  await page.keyboard.press("Shift+Tab");
  assert.equal(await page.evaluate(() => document.activeElement.id), "view");
  assert.equal(await outline(), "solid");
});

browserTest("help opens at its top, also in a low window and the second time", async () => {
  const { page } = await here.open({ session: "help", width: 390, height: 500 });
  for (const _ of [1, 2]) {
    await page.keyboard.press("?");
    const dialog = page.locator("#help-dialog");
    await dialog.waitFor();
    assert.ok(await dialog.evaluate((box) => box.scrollHeight > box.clientHeight + 50), "there is something to scroll");
    assert.equal(await dialog.evaluate((box) => box.scrollTop), 0);
    await page.mouse.move(200, 250);
    await page.mouse.wheel(0, 300);
    await eventually(
      "scrolled",
      () => dialog.evaluate((box) => box.scrollTop),
      (top) => top > 0,
    );
    await page.keyboard.press("Escape");
  }
});

/// Buttons that a notice lies on.
const covered = () => {
  const meets = (a, b) => a.left < b.right - 1 && a.right > b.left + 1 && a.top < b.bottom - 1 && a.bottom > b.top + 1;
  // What does not fit scrolls in what holds it.
  const seen = (node) => {
    let { left, right, top, bottom } = node.getBoundingClientRect();
    for (let holder = node.parentElement; holder; holder = holder.parentElement) {
      if (getComputedStyle(holder).overflowY === "visible") continue;
      const box = holder.getBoundingClientRect();
      (top = Math.max(top, box.top)), (bottom = Math.min(bottom, box.bottom));
    }
    return { left, right, top, bottom };
  };
  const boxes = [...document.querySelectorAll(".notice")].map(seen);
  return [...document.querySelectorAll("button, select, input")]
    .filter((control) => !control.closest(".notice") && control.checkVisibility({ visibilityProperty: true }))
    .filter((control) => boxes.some((box) => meets(box, seen(control))))
    .map((control) => control.id || control.textContent);
};

for (const [width, height] of [
  [1440, 900],
  [768, 1024],
  [390, 844],
])
  browserTest(`at ${width}x${height} notices cover no button, whatever is open`, async () => {
    const viewer = await here.open({ session: `toast-${width}`, width, height, newcomer: true });
    const { page } = viewer;
    await page.locator("#first-steps").waitFor();
    // What slides in covers some for a moment.
    const look = (when) =>
      eventually(
        when,
        () => page.evaluate(covered),
        ({ length }) => length === 0,
      );
    // This notice stays.
    const script = await Client.connect(here.server, { session: `toast-${width}` });
    await script.request("scene.patch", { patch: { solver: { dt: 0.01 } } });
    await page.locator(".notice", { hasText: "blew up" }).waitFor();
    await script.close();
    await look("first steps");
    await viewer.figures();
    await look("figures");
    await viewer.figures();
    await page.keyboard.press("i");
    await look("inside");
    await page.keyboard.press("i");
    await page.getByRole("button", { name: "Timeline" }).click();
    await look("timeline");
    if (width <= 760) await page.getByRole("button", { name: "Parameters" }).click();
    await look("panel");
  });

browserTest("share has a link to the session and one to the scene, which opens it", async () => {
  const viewer = await here.open({ session: "share", width: 1440, height: 900 });
  const { page } = viewer;
  await page.getByRole("button", { name: "Share", exact: true }).click();
  const dialog = page.getByRole("dialog", { name: "Share" });
  const link = (name) => dialog.getByRole("textbox", { name }).inputValue();
  assert.equal(await link("Link to this session"), page.url());
  const scene = await link("Link to this scene");
  await dialog.getByRole("button", { name: "Close" }).click();
  await page.goto(scene.replace("session=share", "session=shared"));
  await page.getByRole("dialog").getByText("seed").first().waitFor();
});
