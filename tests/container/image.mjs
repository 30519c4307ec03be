// The image that tests/container/run has built, and containers of it, restricted as docker/compose.yaml asks: a
// read-only root, no capability, no new privileges, the server as process 1, and no device but /dev/null and the like.
import { spawn, spawnSync } from "node:child_process";
import { once } from "node:events";
import { chownSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Server, withTimeout } from "../protocol/harness.mjs";

/// The folder with the image's files, and the part Config of `docker inspect`.
export const root = process.env.CLOTHLAB_IMAGE_ROOT;
export const config = JSON.parse(readFileSync(process.env.CLOTHLAB_IMAGE_CONFIG, "utf8"));
export const user = Number(config.User.split(":")[0]);

const confined = `set -eu
  mount --make-rprivate /
  mount --bind "$ROOT" "$ROOT"
  mount -t proc -o nosuid,nodev,noexec proc "$ROOT/proc"
  mount -t sysfs -o ro,nosuid,nodev,noexec sysfs "$ROOT/sys"
  mount -t tmpfs -o mode=755,nosuid dev "$ROOT/dev"
  for device in null zero full random urandom; do
    touch "$ROOT/dev/$device"
    mount --bind "/dev/$device" "$ROOT/dev/$device"
  done
  mount -t tmpfs -o mode=1777,size=64m,nosuid,nodev,noexec tmp "$ROOT/tmp"
  mount --bind "$VOLUME" "$ROOT/var/lib/clothlab"
  mount -o remount,bind,ro "$ROOT"
  exec chroot "$ROOT" setpriv --reuid "$USER_ID" --regid "$USER_ID" --clear-groups --bounding-set=-all \\
    --inh-caps=-all --no-new-privs env -i --chdir="$FOLDER" "$@"`;

export class Container extends Server {
  /// Starts the image's entrypoint with `args` (by default the image's own), or `command` instead of it.
  static run({ args = config.Cmd, command = [...config.Entrypoint, ...args], env = {}, volume } = {}) {
    const container = new Container();
    container.volume = volume ?? newVolume();
    const variables = [...config.Env, ...Object.entries(env).map(([name, value]) => `${name}=${value}`)];
    const inside = ["bash", "-c", confined, "confined", ...variables, ...command];
    container.child = spawn("unshare", ["--mount", "--pid", "--fork", "--kill-child", "--", ...inside], {
      stdio: ["ignore", "pipe", "pipe"],
      env: { PATH: process.env.PATH, ROOT: root, VOLUME: container.volume, USER_ID: user, FOLDER: config.WorkingDir },
    });
    container.stdout = container.stderr = "";
    container.child.stdout.on("data", (data) => (container.stdout += data));
    container.child.stderr.on("data", (data) => (container.stderr += data));
    container.closed = once(container.child, "close");
    return container;
  }

  /// Runs a container until it listens.
  static async start(options = {}) {
    const container = Container.run(options);
    const listening = new Promise((resolve, reject) => {
      container.child.stdout.on("data", () => container.stdout.includes("\n") && resolve(container.stdout));
      container.child.on("close", (code) => reject(new Error(`it ended with ${code}: ${container.stderr}`)));
    });
    const match = /^listening on https?:\/\/([^:]+):(\d+)\/\n/.exec(
      await withTimeout(listening, "the container to listen"),
    );
    if (!match) throw new Error(`serve said ${JSON.stringify(container.stdout)}`);
    container.address = match[1];
    container.port = Number(match[2]);
    container.host = `127.0.0.1:${container.port}`;
    return container;
  }

  /// Runs a container to its end.
  static async finish(options) {
    const container = Container.run(options);
    const [code] = await withTimeout(container.closed, "the container to end");
    return { code, stdout: container.stdout, stderr: container.stderr };
  }

  /// The process id that this machine gives the container's process 1.
  get process() {
    const children = readFileSync(`/proc/${this.child.pid}/task/${this.child.pid}/children`, "utf8");
    return Number(children.split(" ")[0]);
  }

  /// A field of /proc/PID/status of process 1.
  get status() {
    const lines = readFileSync(`/proc/${this.process}/status`, "utf8").trim().split("\n");
    return Object.fromEntries(lines.map((line) => line.split(/:\s*/)));
  }

  get environment() {
    const lines = readFileSync(`/proc/${this.process}/environ`, "utf8").split("\0");
    return Object.fromEntries(lines.filter(Boolean).map((line) => line.split(/=(.*)/s, 2)));
  }

  /// Runs another command in the same container, like `docker exec`: its exit code and output.
  exec(...command) {
    const inside = [
      "--mount",
      "--pid",
      "--root",
      "--wd",
      "setpriv",
      `--reuid=${user}`,
      `--regid=${user}`,
      "--clear-groups",
    ];
    const { status, stdout, stderr } = spawnSync("nsenter", ["--target", this.process, ...inside, ...command], {
      encoding: "utf8",
    });
    return { code: status, stdout, stderr };
  }

  /// Stops the container like `docker stop`, with SIGTERM to process 1: the exit code, and how long it took.
  async stop(signal = "SIGTERM") {
    const from = performance.now();
    process.kill(this.process, signal);
    const [code] = await withTimeout(this.closed, "the container to end");
    return { code, seconds: (performance.now() - from) / 1000 };
  }
}

const volumes = mkdtempSync(join(tmpdir(), "clothlab-volumes-"));
process.on("exit", () => rmSync(volumes, { recursive: true, force: true }));

/// A folder that belongs to the image's user, like a new volume. It is removed when the tests end.
export function newVolume() {
  const folder = mkdtempSync(join(volumes, "volume-"));
  chownSync(folder, user, user);
  return folder;
}
