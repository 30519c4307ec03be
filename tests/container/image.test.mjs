import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { test } from "node:test";
import { config, root, user } from "./image.mjs";

const find = (...conditions) => {
  const { status, stdout, stderr } = spawnSync("find", [root, "-xdev", ...conditions, "-printf", "/%P\\n"], {
    encoding: "utf8",
  });
  assert.equal(status, 0, stderr);
  return stdout.split("\n").filter(Boolean).sort();
};

test("the image runs as a user who is not root, by number, and says its port and its health check", () => {
  assert.match(config.User, /^[1-9]\d*:[1-9]\d*$/);
  assert.deepEqual(Object.keys(config.ExposedPorts), ["8080/tcp"]);
  assert.deepEqual(config.Healthcheck.Test, ["CMD", "/usr/local/bin/healthcheck"]);
});

test("no token is in the image", () => assert.doesNotMatch(JSON.stringify(config), /token/i));

test("there is no compiler, assembler, linker, build tool, Node or Python in it", () => {
  const names =
    "cc|c[+][+]|cpp|gcc|g[+][+]|clang|as|ld|ld[.]bfd|make|cmake|ninja|node|npm|python3?|cc1|cc1plus|collect2|lto1";
  assert.deepEqual(
    find(
      "!",
      "-type",
      "d",
      "-regextype",
      "posix-extended",
      "-regex",
      `.*/([a-z0-9_]+-linux-gnu-)?(${names})(-[0-9.]+)?`,
    ),
    [],
  );
  assert.ok(find("-path", "*/bin/bash").length > 0); // the search does find existing files
});

test("its user may write nowhere but in /var/lib/clothlab and the folders for everybody", () => {
  const writable = find(
    "(",
    "-uid",
    user,
    "-o",
    "-gid",
    user,
    "-o",
    "-perm",
    "-0002",
    ")",
    "!",
    "-type",
    "l",
    "!",
    "-path",
    "*/dev/*",
  );
  assert.deepEqual(writable, ["/run/lock", "/tmp", "/var/lib/clothlab", "/var/tmp"]);
});

test("no program in it gives its user another's rights beyond Debian's own", () => {
  assert.deepEqual(find("-perm", "/6000", "-path", "*/usr/local/*"), []);
});

test("a runtime that only changes the root runs it as its user, too", () => {
  const [program, ...args] = process.env.CLOTHLAB_BUILDAH_RUN.split(" ");
  const inside = (...command) => spawnSync(program, [...args, ...command], { encoding: "utf8" });
  assert.equal(inside("id", "--user").stdout, `${user}\n`);
  assert.match(inside(...config.Entrypoint, "info").stdout, /^\* 0: .*OpenGL 4[.]/m);
});

test("NVIDIA's EGL is found where the host adds it", () => {
  assert.deepEqual(find("-path", "*/egl_vendor.d/*.json"), [
    "/usr/share/glvnd/egl_vendor.d/10_nvidia.json",
    "/usr/share/glvnd/egl_vendor.d/50_mesa.json",
  ]);
  assert.ok(config.Env.includes("NVIDIA_DRIVER_CAPABILITIES=graphics,compute,utility"));
});

test("it takes no more room than docker/README.md says: 300 MB", (context) => {
  const [bytes] = spawnSync("du", ["--summarize", "--apparent-size", "--bytes", "--one-file-system", root], {
    encoding: "utf8",
  }).stdout.split("\t");
  context.diagnostic(`${(bytes / 1e6).toFixed(1)} MB`);
  assert.ok(bytes < 300e6);
});
