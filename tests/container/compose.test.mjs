import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const folder = join(dirname(fileURLToPath(import.meta.url)), "../../docker");
const text = readFileSync(join(folder, "compose.yaml"), "utf8");
const tool = [["docker", "compose"], ["docker-compose"]].find(([program, ...args]) =>
  /v?2\./.test(spawnSync(program, [...args, "version", "--short"], { encoding: "utf8" }).stdout ?? ""),
);
const skip = tool ? false : "there is no Docker Compose 2 here to read compose.yaml with";

/// The configuration that Docker Compose reads from a compose file; needs no daemon.
function read(document, env = {}) {
  const [program, ...args] = [...tool, "--project-directory", folder, "-f", "-", "config", "--format", "json"];
  const { status, stdout, stderr } = spawnSync(program, args, {
    encoding: "utf8",
    input: document,
    env: { PATH: process.env.PATH, ...env },
  });
  assert.equal(status, 0, stderr);
  return JSON.parse(stdout).services.clothlab;
}

/// The compose file with some of its commented lines in force.
function uncommented(...lines) {
  let document = text;
  for (const line of lines) {
    const pattern = new RegExp(`^( *)# (?=${line})`, "m");
    assert.match(document, pattern);
    document = document.replace(pattern, "$1");
  }
  return document;
}

test("compose.yaml: read-only root, no capability, limits, a health check, and only this machine may connect", {
  skip,
}, () => {
  const service = read(text);
  assert.equal(service.read_only, true);
  assert.deepEqual(service.cap_drop, ["ALL"]);
  assert.deepEqual(service.security_opt, ["no-new-privileges:true"]);
  assert.deepEqual(Object.keys(service.deploy.resources.limits).sort(), ["cpus", "memory", "pids"]);
  assert.deepEqual(service.healthcheck.test, ["CMD", "/usr/local/bin/healthcheck"]);
  assert.deepEqual(
    service.ports.map(({ host_ip, target, published }) => [host_ip, target, published]),
    [["127.0.0.1", 8080, "8080"]],
  );
  assert.equal(service.build.context, join(folder, ".."));
});

test("the port, the limits and the tokens come from the environment", { skip }, () => {
  const env = {
    CLOTHLAB_PORT: "9000",
    CLOTHLAB_CPUS: "4",
    CLOTHLAB_MEMORY: "4g",
    CLOTHLAB_TOKEN: "t",
    CLOTHLAB_VIEW_TOKEN: "v",
  };
  const { ports, deploy, environment } = read(text, env);
  assert.equal(ports[0].published, "9000");
  assert.deepEqual([Number(deploy.resources.limits.cpus), deploy.resources.limits.memory], [4, String(4 * 1024 ** 3)]);
  assert.deepEqual(environment, { CLOTHLAB_TOKEN: "t", CLOTHLAB_VIEW_TOKEN: "v" });
});

test("the lines for a GPU and for a secret are right once they are no comments", { skip }, () => {
  const nvidia = read(uncommented("reservations:", "  devices: \\[\\{driver"));
  assert.deepEqual(nvidia.deploy.resources.reservations.devices[0].capabilities, [
    "gpu",
    "graphics",
    "compute",
    "utility",
  ]);
  const mesa = read(uncommented("devices: ", "group_add: "), { RENDER_GID: "105" });
  assert.match(JSON.stringify(mesa.devices), /\/dev\/dri/);
  assert.deepEqual(mesa.group_add, ["105"]);
  const secret = read(
    uncommented("CLOTHLAB_TOKEN_FILE: ", "secrets: \\[", "secrets:$", "  clothlab_token:", "    file: "),
  );
  assert.equal(secret.secrets[0].source, "clothlab_token");
});
