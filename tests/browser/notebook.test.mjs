// The page in a notebook's cell, and the JavaScript client in the page of another origin.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { once } from "node:events";
import http from "node:http";
import { after, before } from "node:test";
import { Server } from "../protocol/harness.mjs";
import { browserTest, eventually, withBrowser } from "./browser.mjs";

const here = withBrowser();
let notebook, origin, cell;
before(async () => {
  notebook = http.createServer((_, answer) => {
    answer.setHeader("content-type", "text/html");
    answer.end(`<!doctype html><title>Notebook</title>${cell}`);
  });
  notebook.listen(0, "127.0.0.1");
  await once(notebook, "listening");
  origin = `http://localhost:${notebook.address().port}`;
});
after(() => notebook.close());

/// What clothlab.py gives a notebook's cell for a session of this server.
function html(server) {
  const code = `import clothlab; print(clothlab.html("cell", "${server.host}")._repr_html_())`;
  const { status, stdout, stderr } = spawnSync("python3", ["-c", code], {
    cwd: new URL("../../web/clients/", import.meta.url),
    encoding: "utf8",
    env: { ...process.env, PYTHONDONTWRITEBYTECODE: "1" },
  });
  assert.equal(status, 0, stderr);
  return stdout;
}

browserTest("the cell shows the live page if the server allows the notebook's origin, and else how to", async () => {
  for (const allowed of [true, false]) {
    const server = await Server.start(...(allowed ? ["--allow-origin", origin] : []));
    cell = html(server);
    const page = await here.browser.newPage();
    const complaints = [];
    page.on("console", (message) => complaints.push(message.text()));
    await page.goto(origin);
    const frame = await (await page.waitForSelector("iframe")).contentFrame();
    if (allowed) {
      await frame.waitForFunction(() => window.clothlab?.framesDrawn > 3);
      assert.match(frame.url(), /session=cell$/);
    } else {
      await page.getByText(/--allow-origin/).waitFor();
      await eventually(
        "the browser refuses",
        () => complaints.join("\n"),
        (text) => /frame-ancestors/.test(text),
      );
    }
    await page.close();
    await server.stop();
  }
});

browserTest("a page of an allowed origin imports the client from the server, and reads the cloth", async () => {
  const server = await Server.start("--allow-origin", origin);
  cell = "";
  const page = await here.browser.newPage();
  await page.goto(origin);
  const told = await page.evaluate(async (host) => {
    const { connect } = await import(`http://${host}/clothlab.mjs`);
    const cloth = await connect(host, { session: "imported" });
    await cloth.set({ "/gravity/1": -1.6 });
    const frame = await cloth.frame({ encoding: "q16" });
    const picture = await cloth.picture(64, 64);
    cloth.close();
    return [frame.vertices, frame.positions.length, picture[0]];
  }, server.host);
  assert.deepEqual(told, [625, 3 * 625, 0x89]);
  const other = await Server.start();
  const refused = await page.evaluate((host) => import(`http://${host}/clothlab.mjs`).catch(String), other.host);
  assert.match(refused, /TypeError: Failed to fetch/);
  await page.close();
  await Promise.all([server.stop(), other.stop()]);
});
