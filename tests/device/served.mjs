// Frames as a viewer gets them from `clothlab serve`: how many, how late, and how soon a step is answered.
import { spawn } from "node:child_process";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import WebSocket from "ws";
import { connect } from "./clients/clothlab.mjs";
import { median } from "./median.mjs";
import { brief, folder } from "./programs.mjs";
import { sheet } from "./scenes.mjs";

/** The value of the histogram that a share of what was added is below [s]. */
function quantile(text, share) {
  const buckets = [...text.matchAll(/latency_seconds_bucket\{le="([^"]+)"\} (\d+)/g)].map((m) =>
    m.slice(1).map(Number),
  );
  return buckets.find(([, count]) => count >= share * buckets.at(-1)[1])?.[0] ?? null;
}

async function watch(here, scene, seconds, limit) {
  const child = spawn(join(here, "with"), ["clothlab", "serve", "--port", "0", "--scene", scene]);
  let said = "",
    late = false;
  const end = setTimeout(() => {
    late = true;
    child.kill("SIGKILL");
  }, 1000 * limit);
  try {
    const address = await new Promise((resolve, reject) => {
      child.stdout.on("data", (data) => {
        said += data;
        const found = /listening on (http:\S+)/.exec(said)?.[1];
        if (found) resolve(found);
      });
      child.on("exit", (code) => reject(new Error(`the server ended with ${code}`)));
    });
    const cloth = await connect(address, { WebSocket, timeout: limit });
    const at = [];
    for await (const _ of cloth.frames({ rate: 60, encoding: "q16" })) {
      at.push(performance.now());
      if (at.at(-1) - at[0] > 1000 * seconds) break;
    }
    const { real_time_factor } = await cloth.status();
    const metrics = await (await fetch(new URL("/metrics", address))).text();
    // Of a step that is asked for while time stands still: from the request to the answer.
    await cloth.request("sim.pause");
    const answered = [];
    for (let i = 0; i < 50; ++i) {
      const asked = performance.now();
      await cloth.request("sim.step", { steps: 1 });
      answered.push(performance.now() - asked);
    }
    cloth.close();
    const gaps = at.slice(1).map((time, i) => time - at[i]);
    return {
      frames_a_second: brief((1000 * gaps.length) / (at.at(-1) - at[0])),
      gap_p95_ms: brief([...gaps].sort((a, b) => a - b)[Math.floor(0.95 * gaps.length)]),
      real_time_factor: brief(real_time_factor),
      latency_p95_ms: brief(1000 * quantile(metrics, 0.95)),
      step_answered_ms: brief(median(answered)),
    };
  } catch (error) {
    throw late ? new Error(`frames did not come in the ${brief(limit)} s that were left`) : error;
  } finally {
    clearTimeout(end);
    child.kill("SIGTERM");
  }
}

export async function served({ here, left, small }) {
  const file = join(folder, "sheet.json");
  writeFileSync(
    file,
    JSON.stringify({
      version: 1,
      name: "sheet",
      cloths: [{ mesh: sheet(256, 256, 1, 1), pins: [{ at: "corner:0,0" }, { at: "corner:255,0" }] }],
      solver: { method: "symplectic_euler", dt: 0.0002 },
    }),
  );
  const rows = [];
  for (const [name, scene] of [
    ["seed", "seed"],
    ["256x256 vertices", file],
  ].slice(0, small ? 1 : 2)) {
    if (left() < 2) break;
    const row = {
      scene: name,
      ...(await watch(here, scene, small ? 2 : 5, left()).catch((error) => ({ failed: error.message }))),
    };
    rows.push(row);
    console.log(
      `${name}: ${row.failed ?? `${row.frames_a_second} frames/s, real-time factor ${row.real_time_factor}`}`,
    );
  }
  return { rows, wrong: rows.filter(({ failed }) => failed).length };
}
