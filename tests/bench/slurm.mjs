// A sweep on a Slurm cluster that loses a node: docker/slurm/sweep.sbatch on four nodes that this machine plays. By
// hand, as root, after `apt-get install slurm-wlm munge` (Debian starts no service of them without a configuration):
//   CLOTHLAB=build/release/clothlab node tests/bench/slurm.mjs [soon|late|never]
// In the middle of an array of 10 tasks with 500 points, a node's daemon and its task are killed (SIGKILL). The node
// comes back before Slurm misses it (soon), after that (late, the default), or never. Slurm must requeue that task, it
// must go on where it was, and each point must be measured once. Prints JSON; exits with 1 if something is not so, and
// then leaves its folder, with the logs.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import {
  chmodSync,
  mkdirSync,
  mkdtempSync,
  openSync,
  readdirSync,
  readFileSync,
  rmSync,
  statSync,
  writeFileSync,
} from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { runProgram, sleep } from "../protocol/harness.mjs";

const back = process.argv[2] ?? "late";
assert.ok(["soon", "late", "never"].includes(back), `"${back}"; soon, late or never`);
const tasks = 10,
  total = 500,
  victim = 7, // the task that is killed
  port = 17000, // the controller's; the nodes' follow
  nodes = ["node1", "node2", "node3", "node4"];

const folder = mkdtempSync(join(tmpdir(), "clothlab-slurm-"));
chmodSync(folder, 0o755); // MUNGE wants a socket that everybody can reach
const at = (name) => join(folder, name);
for (const name of ["state", "logs", ...nodes]) mkdirSync(at(name));
writeFileSync(at("munge.key"), crypto.getRandomValues(new Uint8Array(128)), { mode: 0o400 });
// SlurmdTimeout: so long a node may be silent [s]. cred_expire: so long a requeued task waits [s]; 120 by default.
// linuxproc and none, as not every machine lets one make control groups.
writeFileSync(
  at("slurm.conf"),
  `ClusterName=bench
SlurmctldHost=localhost
SlurmctldPort=${port}
SlurmUser=root
SlurmdUser=root
AuthInfo=socket=${at("munge.socket")},cred_expire=10
StateSaveLocation=${at("state")}
SlurmdSpoolDir=${folder}/%n
SlurmctldPidFile=${at("slurmctld.pid")}
SlurmdPidFile=${folder}/%n.pid
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SlurmdParameters=config_overrides
ReturnToService=2
SlurmdTimeout=10
${nodes.map((name, i) => `NodeName=${name} NodeHostname=localhost Port=${port + 1 + i} CPUs=1`).join("\n")}
PartitionName=all Nodes=ALL Default=YES
`,
);
const env = { ...process.env, SLURM_CONF: at("slurm.conf"), CLOTHLAB: resolve(process.env.CLOTHLAB) };
const slurm = (program, ...args) => execFileSync(program, args, { env, cwd: folder, encoding: "utf8" });

const daemons = [];
function daemon(program, ...args) {
  const log = openSync(at(`logs/${program}.${daemons.length}`), "a");
  const child = spawn(program, args, { env, stdio: ["ignore", log, log] });
  daemons.push(child);
  return child;
}
const startNode = (name) => daemon("slurmd", "-D", "-N", name);

async function until(what, seconds, holds) {
  const attempt = () => {
    try {
      return holds();
    } catch {
      return false; // a daemon that does not answer yet, a folder that is not there yet
    }
  };
  for (const end = performance.now() + 1000 * seconds; !attempt(); await sleep(200))
    if (performance.now() > end) throw new Error(`waited ${seconds} s for ${what}; see ${folder}`);
}

/// The files of the results, and of each what changes when it is written again.
function results() {
  const points = at("results/points");
  const names = readdirSync(points, { recursive: true }).filter((name) => name.endsWith(".json"));
  return new Map(
    names.map((name) => {
      const { ino, mtimeMs } = statSync(join(points, name));
      return [name, `${ino} ${mtimeMs}`];
    }),
  );
}

/// The processes of a job: Slurm's own, and the program.
const processesOf = (job) =>
  readdirSync("/proc")
    .filter((pid) => /^\d+$/.test(pid))
    .map(Number)
    .filter((pid) => {
      try {
        if (readFileSync(`/proc/${pid}/cmdline`, "utf8").startsWith(`slurmstepd: [${job}.`)) return true;
        const variables = readFileSync(`/proc/${pid}/environ`, "utf8").split("\0");
        return variables.includes(`SLURM_JOB_ID=${job}`) && variables.includes(`SLURM_CONF=${env.SLURM_CONF}`);
      } catch {
        return false; // it has ended meanwhile
      }
    });

async function trial() {
  writeFileSync(
    at("small.json"),
    JSON.stringify({
      scene: {
        version: 1,
        cloths: [{ mesh: { grid: { columns: 5, rows: 5, width: 1, height: 1 } }, pins: [{ at: "edge:row:0" }] }],
        self_collision: null,
      },
      time: 5,
      measure: [],
      axes: [
        { at: "/solver/method", values: ["verlet", "rk4"] },
        { at: "/solver/dt", from: 0.0005, to: 0.002, count: total / 2, spacing: "log" },
      ],
    }),
  );
  const munge = ["key-file", "socket", "pid-file", "log-file", "seed-file"];
  daemon("munged", "--foreground", "--force", ...munge.map((name) => `--${name}=${at("munge." + name.split("-")[0])}`));
  await sleep(1000);
  daemon("slurmctld", "-D");
  const daemonOf = new Map(nodes.map((name) => [name, startNode(name)]));
  const idle = () => slurm("sinfo", "-h", "-N", "-t", "idle", "-o", "%N").trim().split("\n");
  await until("the nodes", 60, () => idle().length === nodes.length);

  const start = performance.now();
  const seconds = () => Math.round((performance.now() - start) / 100) / 10;
  const script = resolve(import.meta.dirname, "../../docker/slurm/sweep.sbatch");
  slurm("sbatch", `--array=1-${tasks}`, "--output=logs/%a.log", script, "small.json", "results");
  let job, node;
  await until("the task to run", 300, () => {
    const running = slurm("squeue", "-h", "-t", "running", "-O", "ArrayTaskID:|,JobID:|,NodeList:|");
    [, job, node] = running.match(`(?:^|\\n)${victim}\\|(\\d+)\\|(node\\d)`);
    return true;
  });
  await sleep(2000); // so that some of its points are done
  daemonOf.get(node).kill("SIGKILL");
  const killed = processesOf(job);
  for (const pid of killed) process.kill(pid, "SIGKILL");
  const before = results();
  const report = { node_back: back, points_then: before.size, killed_at_s: seconds() };
  assert.ok(killed.length >= 2, "the task was running");

  if (back === "soon") startNode(node);
  else await until("Slurm to miss the node", 120, () => /State=DOWN/.test(slurm("scontrol", "show", "node", node)));
  if (back === "late") startNode(node);
  await until("the task to be requeued", 60, () => /Restarts=1/.test(slurm("scontrol", "show", "job", job)));
  report.requeued_at_s = seconds();
  await until("the task to run again", 300, () => !/JobState=PENDING/.test(slurm("scontrol", "show", "job", job)));
  report.runs_again_at_s = seconds();
  await until("all tasks to end", 600, () => slurm("squeue", "-h") === "");
  report.ended_at_s = seconds();

  const after = results();
  report.points = after.size;
  report.written_again = [...before].filter(([name, file]) => after.get(name) !== file).length;
  report.measured = report.there_before = 0;
  for (let i = 1; i <= tasks; ++i) {
    const log = readFileSync(at(`logs/${i}.log`), "utf8");
    const words = /(\d+) points? measured(?:, (\d+) there before)?/.exec(log);
    assert.ok(words, `task ${i} said: ${log}`);
    report.measured += Number(words[1]);
    report.there_before += Number(words[2] ?? 0);
  }
  report.merge = (await runProgram(["sweep", "--merge", at("results")])).stdout.split("\n")[0];
  console.log(JSON.stringify(report, null, 2));
  assert.equal(report.points, total);
  assert.equal(report.written_again, 0);
  // What the killed task measured it could not say; it found it there when it ran again.
  assert.equal(report.measured + report.there_before, total);
  assert.ok(report.there_before > 0, "the killed task had measured something");
  assert.match(report.merge, new RegExp(`${total} of ${total} points`));
}

let failed = true;
try {
  await trial();
  failed = false;
} finally {
  if (failed && daemons.length > 1) {
    slurm("scancel", "--user=root");
    await until("the tasks to end", 60, () => slurm("squeue", "-h") === "");
  }
  for (const child of daemons.reverse()) {
    if (child.exitCode !== null || child.signalCode !== null) continue;
    child.kill();
    await once(child, "exit");
  }
  if (!failed) rmSync(folder, { recursive: true });
}
