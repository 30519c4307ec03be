import assert from "node:assert/strict";
import { Client, Server } from "../protocol/harness.mjs";
import { browserTest, eventually, withBrowser } from "./browser.mjs";

const { open } = withBrowser();

browserTest(
  "a server that is killed and started again on its port is reconnected to, and the page says so meanwhile",
  async () => {
    const server = await Server.start();
    const viewer = await open(server);
    await server.stop("SIGKILL");
    const banner = viewer.page.locator("#banner");
    // It says so between two attempts, and that it connects again while one is under way.
    await banner.filter({ hasText: "Connection lost" }).waitFor();
    const drawn = await viewer.read("framesDrawn");
    const again = await Server.start("--port", String(server.port));
    try {
      await viewer.until((count) => window.clothlab.framesDrawn > count + 3, drawn);
      await banner.waitFor({ state: "hidden" });
      assert.equal(await viewer.page.locator("#link").getAttribute("data-state"), "open");
    } finally {
      await again.stop();
    }
  },
);

browserTest(
  "a server that has restarted without its state gets the page's own copy back, and stays paused",
  async () => {
    const server = await Server.start();
    const viewer = await open(server);
    const { page } = viewer;
    const gravity = viewer.number("World", "gravity y");
    await gravity.fill("-3");
    await gravity.press("Enter");
    await viewer.until(() => window.clothlab.document.gravity[1] === -3);
    await page.getByRole("button", { name: "Pause", exact: true }).click();
    const restore = page.getByRole("button", { name: "Restore my scene" });
    await server.stop("SIGKILL");
    let again = await Server.start("--port", String(server.port));
    try {
      await restore.waitFor();
      await viewer.until(() => window.clothlab.document.gravity[1] === -9.8);
      await restore.click();
      await viewer.until(() => window.clothlab.document.gravity[1] === -3);
      await restore.waitFor({ state: "detached" });
      const client = await Client.connect(again, { session: "main" });
      await client.nextNotification("sim.status", ({ playing }) => !playing); // as the user had last asked for
      assert.equal((await client.request("scene.get", {})).document.gravity[1], -3);
      await client.close();

      // a page that is loaded again has the copy, too; one whose scene is there offers nothing
      await page.waitForFunction(() => sessionStorage.getItem("clothlab-scene-main")?.includes("-3"));
      await page.reload();
      await viewer.until(() => window.clothlab?.document?.gravity[1] === -3);
      assert.equal(await restore.count(), 0);
      await again.stop("SIGKILL");
      again = await Server.start("--port", String(server.port));
      await page.reload();
      await restore.click();
      await viewer.until(() => window.clothlab.document.gravity[1] === -3);
    } finally {
      await again.stop();
    }
  },
);

browserTest("a server with a token asks for it, refuses a wrong one, and lets the right one in", async () => {
  const server = await Server.start("--token", "spun gold");
  try {
    const viewer = await open(server, { drawn: 0 });
    const dialog = viewer.page.getByRole("dialog");
    await dialog.waitFor();
    const enter = async (token) => {
      await viewer.page.getByLabel("Token", { exact: true }).fill(token);
      await viewer.page.getByRole("button", { name: "Connect" }).click();
    };
    await enter("straw");
    await viewer.page.getByText("did not accept this token").waitFor();
    await enter("spun gold");
    await viewer.until(() => window.clothlab.framesDrawn > 2);
    assert.equal(await dialog.isVisible(), false);
    await viewer.page.reload();
    await viewer.until(() => window.clothlab.framesDrawn > 2); // the token is kept for this tab
  } finally {
    await server.stop();
  }
});

browserTest("where too many wrong tokens were tried, the page says so, waits, and gets in by itself", async () => {
  const server = await Server.start("--token", "spun gold", "--max-wrong-tokens", "6");
  try {
    const viewer = await open(server, { drawn: 0 });
    await viewer.page.getByRole("dialog").waitFor();
    for (let guess = 0; guess < 6; ++guess) await server.get("/metrics", { authorization: `Bearer straw ${guess}` });
    await viewer.page.getByLabel("Token", { exact: true }).fill("spun gold");
    await viewer.page.getByRole("button", { name: "Connect" }).click();
    await viewer.page.getByText("Not connected (too many wrong tokens came from this address").waitFor();
    await viewer.until(() => window.clothlab.framesDrawn > 2); // the server checks one token every ten seconds
    assert.equal(await viewer.page.locator("#banner").isVisible(), false);
  } finally {
    await server.stop();
  }
});

browserTest("a viewer whose session nobody has opened is told who opens it", async () => {
  const server = await Server.start("--token", "spun gold", "--view-token", "look");
  try {
    const viewer = await open(server, { session: "early", drawn: 0 });
    await viewer.page.getByLabel("Token", { exact: true }).fill("look");
    await viewer.page.getByRole("button", { name: "Connect" }).click();
    await viewer.page.getByText("no session early is open; an operator opens it by connecting to it").waitFor();
  } finally {
    await server.stop();
  }
});

browserTest(
  "a message that is none of the protocol's ends the connection with a reason, and the page goes on with the next one",
  async () => {
    const server = await Server.start();
    const viewer = await open(server);
    const closed = [];
    let spoil = null; // sent in place of the next frame
    await viewer.page.routeWebSocket("**/ws**", (page) => {
      const link = page.connectToServer();
      link.onMessage((message) => {
        const spoiled = spoil && Buffer.isBuffer(message) && message[0] === 2 ? spoil(message) : message;
        if (spoiled !== message) spoil = null;
        page.send(spoiled);
      });
      page.onClose((code, reason) => {
        closed.push({ code, reason });
        link.close();
      });
    });
    try {
      await viewer.page.reload();
      const cases = [
        [(frame) => frame.subarray(0, 100), /announces 5000 bytes, 36 came/],
        [(frame) => Buffer.from(frame).fill(9, 0, 1), /unknown kind 9/],
        [() => "no JSON", /no JSON object/],
      ];
      for (const [spoiling, reason] of cases) {
        await viewer.until(() => window.clothlab?.framesDrawn > 3);
        spoil = spoiling;
        const banner = viewer.page.locator("#banner", { hasText: reason });
        await banner.waitFor({ state: "visible" });
        await eventually(
          "told the server why",
          () => closed.filter((close) => reason.test(close.reason)).map(({ code }) => code),
          (codes) => codes.length === 1 && codes[0] === 4002,
        );
        const drawn = await viewer.read("framesDrawn");
        await viewer.page.getByRole("button", { name: "Try now" }).click();
        await viewer.until((count) => window.clothlab.framesDrawn > count + 3, drawn);
        await viewer.page.locator("#banner").waitFor({ state: "hidden" });
      }
    } finally {
      await server.stop();
    }
  },
);

browserTest("a page that finds no server says so instead of staying empty", async () => {
  const server = await Server.start();
  const viewer = await open(server, { drawn: 0 });
  await viewer.page.route("**/ws**", (route) => route.abort());
  await server.stop("SIGKILL");
  // Between two attempts the banner says for a moment that it tries again.
  await viewer.page.locator("#banner", { hasText: /Connection lost|No server answers/ }).waitFor({ state: "visible" });
});

browserTest("a page that a full server refuses says what is full, and shows the cloth once there is room", async () => {
  const server = await Server.start("--max-clients-per-address", "8"); // as many connections are left to the page
  const others = await Promise.all(Array.from({ length: 8 }, () => Client.connect(server)));
  const { page } = await open(server, { drawn: 0 });
  const why = "Not connected (this address has as many clients as it may, 8; see --max-clients-per-address)";
  await page.locator("#banner", { hasText: why }).waitFor({ state: "visible" });
  await others[0].close();
  await page.waitForFunction(() => window.clothlab?.framesDrawn >= 1);
  await server.stop();
});

browserTest("an address with a name that no session can have says so, and what is allowed", async () => {
  const server = await Server.start();
  const { page } = await open(server, { session: "my%20cloth", drawn: 0 });
  await page.getByText("a session by “my cloth”, which none can have. Allowed are 1 to 64 of the letters").waitFor();
  assert.ok(await page.locator("#banner").isHidden());
  await page.getByRole("link", { name: "Open the session that everybody starts with" }).click();
  await page.waitForFunction(() => window.clothlab?.framesDrawn >= 1);
  await server.stop();
});
