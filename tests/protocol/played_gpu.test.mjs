// A server on a GPU, played by software OpenGL (CLOTHLAB_PLAY_GPU, server/gl/software): nothing that is for software
// OpenGL alone is asked, or the program would end.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Client, Server } from "./harness.mjs";

test("sessions, a scene that becomes heavy, pictures and the lab need nothing that only software OpenGL has", async () => {
  process.env.CLOTHLAB_PLAY_GPU = "1";
  const server = await Server.start().finally(() => delete process.env.CLOTHLAB_PLAY_GPU);
  const [client, other] = [await Client.connect(server), await Client.connect(server, { session: "other" })];
  for (const one of [client, other]) {
    await one.request("stream.subscribe", { encoding: "q16" });
    await one.frame((frame) => frame.step > 1);
  }
  const mesh = { grid: { columns: 100, rows: 100, width: 1, height: 1 } };
  await client.request("scene.patch", { patch: { cloths: [{ mesh, pins: [] }] } });
  await client.nextFrame((frame) => frame.vertexCount === 10_000 && frame.step > 0);
  assert.equal((await server.get("/api/snapshot.png?width=64&height=48")).status, 200);
  await other.request("lab.stability", { methods: ["symplectic_euler"], columns: 2, from: 1, to: 4 });
  await other.notification("lab.progress", ({ done }) => done > 0);
  await server.stop();
});
