// A page at the end of a slow line: it asks for compressed frames by itself, and shows what the session has.
import assert from "node:assert/strict";
import { createServer, connect } from "node:net";
import { after } from "node:test";
import { Client } from "../protocol/harness.mjs";
import { browserTest, eventually, withServer } from "./browser.mjs";

const here = withServer();

/// A line to the server that carries so many bytes a second to the page, and keeps each for a while [ms].
class Line {
  bytesPerSecond = 0; // 0: as many as come
  delay = 30;

  async start(port) {
    this.server = createServer((page) => {
      const server = connect(port, "127.0.0.1");
      page.pipe(server);
      for (const [end, other] of [
        [page, server],
        [server, page],
      ])
        end.on("error", () => other.destroy()).on("close", () => other.destroy());
      let free = 0; // when what was sent before has left [ms]
      server.on("data", (data) => {
        const now = performance.now();
        free = Math.max(free, now) + (this.bytesPerSecond ? (1000 * data.length) / this.bytesPerSecond : 0);
        if (free - now > 100) server.pause();
        setTimeout(
          () => {
            page.write(data);
            server.resume();
          },
          free + this.delay - now,
        );
      });
    });
    await new Promise((resolve) => this.server.listen(0, "127.0.0.1", resolve));
    this.host = `127.0.0.1:${this.server.address().port}`;
  }
}

let line = null;
after(() => line?.server.close());

/// A page behind the line: what it has asked for of the stream, in order.
async function behind(session) {
  if (!line) await (line = new Line()).start(here.server.port);
  line.bytesPerSecond = 0;
  const viewer = await here.open({ server: line, session, drawn: 1 });
  const asked = [];
  viewer.page.on("websocket", (socket) => socket.on("framesent", ({ payload }) => asked.push(String(payload))));
  await viewer.page.reload();
  await viewer.until(() => window.clothlab?.framesDrawn >= 3);
  return { viewer, subscribed: () => asked.filter((text) => text.includes("stream.subscribe")) };
}

browserTest("behind a slow line the page asks for compressed frames, and shows the session's places", async () => {
  const { viewer, subscribed } = await behind("far");
  assert.match(subscribed().at(-1), /"q16"/);
  line.bytesPerSecond = 40_000; // eight q16 frames of the seed a second
  await eventually("a wish for c16", subscribed, (all) => all.at(-1).includes('"c16"'));
  const drawn = await viewer.read("framesDrawn");
  await viewer.until((before) => window.clothlab.framesDrawn > before + 20, drawn);
  // with a field, too
  await viewer.page.locator("#colour-by").selectOption("speed");
  await eventually("the field", subscribed, (all) => /"c16".*"speed"/.test(all.at(-1)));
  const client = await Client.connect(here.server, { session: "far" });
  await client.request("stream.subscribe", { encoding: "q16", rate: 30 });
  await client.request("sim.pause", {});
  const { step } = await client.nextNotification("sim.status", ({ playing }) => playing === false);
  await viewer.until((last) => window.clothlab.step === last, step);
  const frame = client.binary.findLast((message) => message.kind === 2 && message.step === step);
  const places = await viewer.positions();
  assert.equal(places.length, frame.positions.length);
  frame.positions.forEach((place, i) => {
    const off = Math.hypot(...place.map((value, axis) => value - places[i][axis]));
    assert.ok(off < 1e-6, `vertex ${i} is ${off} m off`);
  });
  // of the browser's, about how tests look at pixels
  assert.deepEqual(
    viewer.complaints.filter((text) => !text.includes("ReadPixels")),
    [],
  );
  await client.close();
});

browserTest("where no thread can unpack frames, the page goes back to q16, and goes on", async () => {
  const { viewer, subscribed } = await behind("no-thread");
  await viewer.page.route("**/unpack.js", (route) => route.abort());
  line.bytesPerSecond = 40_000;
  await eventually("c16, and q16 again", subscribed, (all) => all.length >= 3 && all.at(-1).includes('"q16"'));
  assert.match(subscribed().at(-2), /"c16"/);
  line.bytesPerSecond = 0;
  const drawn = await viewer.read("framesDrawn");
  await viewer.until((before) => window.clothlab.framesDrawn > before + 20, drawn);
});
