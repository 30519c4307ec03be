// The method "auto" over a socket: it is stable at once; the lab soon chooses a method, keeps it while the scene
// changes little, and chooses again after a large change; clients are told of each choice.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Client, Server } from "./harness.mjs";
import { strip as stripOf } from "./strip.mjs";

const strip = { ...stripOf(), solver: { method: "auto", tolerance: 0.01 } };

let server;
before(async () => (server = await Server.start()));
after(() => server.stop());

// A choice takes seconds, many on a busy machine.
const auto = (client, accept) =>
  client.nextNotification("sim.status", ({ solver }) => solver?.auto && accept(solver.auto), 900_000);

test("a session with the method auto plays stably at once, then with what the lab has chosen, and says so", async () => {
  const client = await Client.connect(server, { session: "auto" });
  await client.notification("scene");
  await client.request("scene.load", { scene: strip });
  const first = await auto(client, ({ state }) => state === "measuring");
  assert.equal(first.solver.auto.method, "verlet");
  assert.ok(first.stability.margin < 1);
  const { solver } = await auto(client, ({ state }) => state === "chosen");
  assert.equal(solver.auto.met, true);
  assert.ok(solver.auto.expected_error <= 0.01);
  assert.ok(solver.auto.why.length > 20);
  // Until the longest stable step is found, the margin is that to a lower bound of it.
  await client.nextNotification("sim.status", ({ stability }) => stability.margin === null || stability.margin <= 0.91);
  assert.ok(client.messages.some((m) => m.method === "notice" && /method auto: /.test(m.params.text)));

  // The document still names the method that was asked for.
  const { document } = await client.request("scene.get");
  assert.equal(document.solver.method, "auto");
  assert.equal(document.solver.tolerance, 0.01);

  // A small change keeps the choice, a large one makes the lab choose again, and another method ends it.
  await client.request("scene.patch", { patch: { gravity: [0, -9.5, 0] } });
  const kept = await client.nextNotification("sim.status");
  assert.equal(kept.solver.auto.state, "chosen");
  await client.request("scene.patch", { patch: { air_drag: 2 } });
  await auto(client, ({ state }) => state === "measuring");
  await auto(client, ({ state }) => state === "chosen");
  await client.request("scene.patch", { patch: { solver: { method: "rk4" } } });
  await client.nextNotification("sim.status", ({ solver }) => solver.auto === null);
  await client.close();
});
