// The method "auto" over a socket: stable at once, chosen by the lab soon, kept while the scene stays, chosen
// again when it is left behind, and never unseen.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Client, Server } from "./harness.mjs";
import { strip as stripOf } from "./strip.mjs";

const strip = { ...stripOf(), solver: { method: "auto", tolerance: 0.01 } };

let server;
before(async () => (server = await Server.start()));
after(() => server.stop());

// Choosing takes seconds, on a busy machine many.
const auto = (client, accept) =>
  client.nextNotification("sim.status", ({ solver }) => solver?.auto && accept(solver.auto), 240_000);

test("a session with the method auto plays stably at once, then with what the lab has chosen, and says so", async () => {
  const client = await Client.connect(server, { session: "auto" });
  await client.notification("scene");
  await client.request("scene.load", { scene: strip });
  const first = await auto(client, ({ state }) => state === "measuring");
  assert.equal(first.solver.auto.method, "verlet");
  assert.ok(first.stability.margin < 1);
  const { solver, stability } = await auto(client, ({ state }) => state === "chosen");
  assert.equal(solver.auto.met, true);
  assert.ok(solver.auto.expected_error <= 0.01);
  assert.ok(solver.auto.why.length > 20);
  assert.ok(stability.margin === null || stability.margin <= 0.91);
  assert.ok(client.messages.some((m) => m.method === "notice" && /method auto: /.test(m.params.text)));

  // The document still says what was asked for.
  const { document } = await client.request("scene.get");
  assert.equal(document.solver.method, "auto");
  assert.equal(document.solver.tolerance, 0.01);

  // A small change keeps the choice, a large one is measured anew, and a method of one's own ends it.
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
