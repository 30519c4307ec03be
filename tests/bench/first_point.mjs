// How long a chart takes until it has its first point, and in all: in seconds, and in the server's processor time,
// which says the same on a busy machine. By hand, on the seed unless another preset is named; the cloth is paused:
//   CLOTHLAB=build/release/clothlab node tests/bench/first_point.mjs [PRESET] [BUDGET in s]
import { loadavg } from "node:os";
import { Client, Server } from "../protocol/harness.mjs";
import { processorSeconds } from "./processor.mjs";

const [preset = "seed", budget = "45"] = process.argv.slice(2);
const load = loadavg()[0];
const server = await Server.start();
const client = await Client.connect(server);
await client.request("scene.load", { preset });
await client.request("sim.pause");

const begun = performance.now();
const used = processorSeconds(server.child.pid);
const now = () => ({
  seconds: Number(((performance.now() - begun) / 1000).toFixed(1)),
  processor_seconds: Number((processorSeconds(server.child.pid) - used).toFixed(1)),
});
const { job } = await client.request("lab.chart", { fresh: true, budget: Number(budget) });
let seen = client.messages.length;
const phases = [];
let first = null;
let whole = null;
while (!whole) {
  await client.until(
    () => client.messages.slice(seen),
    () => true,
    "the lab's next word",
    600_000,
  );
  for (; seen < client.messages.length; ++seen) {
    const { method, params } = client.messages[seen];
    if (params?.job !== job) continue;
    if (method === "lab.progress" && phases.at(-1)?.doing !== params.doing)
      phases.push({ doing: params.doing, ...now() });
    if (method !== "lab.result") continue;
    if (params.result?.points?.length > 0) first ??= now();
    if (params.state !== "running") whole = { ...now(), state: params.state, points: params.result?.points?.length };
  }
}
console.log(JSON.stringify({ preset, budget, load_before: load, first_point: first, whole, phases }, null, 2));
await client.close();
await server.stop();
