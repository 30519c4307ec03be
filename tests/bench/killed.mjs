// How much of a session kill -9 costs while other programs keep all cores busy: the simulated time between the last
// frame that a viewer got and the state that the next start finds. By hand:
//   CLOTHLAB=build/release/clothlab node tests/bench/killed.mjs [TIMES] [BUSY PROGRAMS] [--out FILE]
// Sessions of the seed and of `drape`, 20 times, with as many busy programs as cores and with twice as many, if not
// given otherwise. Prints (or writes) JSON.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { cpus, tmpdir } from "node:os";
import { join } from "node:path";
import { Client, Server, sleep } from "../protocol/harness.mjs";

const args = process.argv.slice(2);
const outAt = args.indexOf("--out");
const out = outAt < 0 ? null : args.splice(outAt, 2)[1];
const times = Number(args[0] ?? 20);
const loads = args[1] === undefined ? [0, cpus().length, 2 * cpus().length] : [Number(args[1])];
const sessions = { main: "seed", second: "drape" };
const round = (value) => Number(value.toFixed(3));

/// Ends the server at a moment of no choice; the simulated seconds that each session lost.
async function lose(folder) {
  const server = await Server.start("--state-dir", folder);
  const clients = [];
  for (const [session, preset] of Object.entries(sessions)) {
    const client = await Client.connect(server, { session });
    await client.request("scene.load", { preset });
    await client.request("stream.subscribe", { encoding: "q16", rate: 60, in_flight: 8 });
    await client.nextFrame();
    clients.push(client);
  }
  await sleep(3000 + 2000 * Math.random());
  await server.stop("SIGKILL");
  const again = await Server.start("--state-dir", folder);
  for (const session of Object.keys(sessions)) await (await Client.connect(again, { session })).notification("scene");
  await again.stop();
  return Object.keys(sessions).map((session, i) => {
    const restored = new RegExp(`event=session_restored session=${session} time=(\\S+)`).exec(again.stderr);
    return clients[i].frames.at(-1).time - Number(restored[1]);
  });
}

const rows = [];
for (const count of loads) {
  const busy = Array.from({ length: count }, () => spawn("sh", ["-c", "while :; do :; done"], { stdio: "ignore" }));
  const lost = [];
  try {
    for (let i = 0; i < times; ++i) {
      const folder = mkdtempSync(join(tmpdir(), "clothlab-killed-"));
      lost.push(...(await lose(folder)));
      rmSync(folder, { recursive: true, force: true });
    }
  } finally {
    for (const child of busy) child.kill("SIGKILL");
  }
  lost.sort((a, b) => a - b);
  rows.push({ busy: count, median: round(lost[lost.length >> 1]), most: round(lost.at(-1)), times: lost.length });
}
const text = JSON.stringify(
  { benchmark: "killed", machine: cpus()[0].model.trim(), cores: cpus().length, rows },
  null,
  2,
);
if (out) writeFileSync(out, `${text}\n`);
else console.log(text);
process.exit(0);
