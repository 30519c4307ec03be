// Data flows down the list of folders in server/README.md: a folder includes itself and the folders above it, and no
// other folder of ours. So a session does not depend on sockets, nor a method on sessions.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { files, root } from "./files.mjs";

const read = (file) => readFileSync(join(root, file), "utf8");
const order = [...read("server/README.md").matchAll(/^\| \[?`(\w+)\/`/gm)].map(([, folder]) => folder);
const sources = files.filter((file) => /^server\/.*\.(?:h|cpp)$/.test(file));
const folderOf = (path) => path.split("/")[1];

/// The includes of our own files that are forbidden in this file.
function forbidden(file, text) {
  const place = order.indexOf(folderOf(file));
  return [...text.matchAll(/^\s*#\s*include\s+"([^"]+)"/gm)]
    .map(([, path]) => path)
    .filter((path) => /^(?:server|tests)\//.test(path))
    .filter((path) => !order.slice(0, place + 1).some((folder) => path.startsWith(`server/${folder}/`)));
}

test("every folder of server/ with sources has its place in the list of server/README.md", () => {
  assert.deepEqual([...new Set(sources.map(folderOf))].sort(), [...order].sort());
});

test("a folder of server/ includes only itself and those above it in that list", () => {
  assert.deepEqual(
    sources.flatMap((file) => forbidden(file, read(file)).map((path) => `${file} includes ${path}`)),
    [],
  );
});

test("no file of server/session includes anything of the network", () => {
  const network = /^\s*#\s*include\s+(?:"server\/net\/|<libwebsockets|<sys\/socket|<netinet)/m;
  assert.deepEqual(
    sources.filter((file) => folderOf(file) === "session" && network.test(read(file))),
    [],
  );
});

/// A file of ours outside server/gl/software that goes in by another way than its door.
const door = "server/gl/software/software.h";
const pastDoor = (file, text) =>
  file.startsWith("server/gl/software/") ||
  file.startsWith("server/gl/context.") ||
  file.startsWith("server/gl/devices.")
    ? []
    : [
        ...[...text.matchAll(/^\s*#\s*include\s+"(server\/gl\/software\/[^"]+)"/gm)]
          .map(([, path]) => path)
          .filter((path) => path !== door),
        ...(text.replace(/\/\/.*$/gm, "").match(/\b(?:LP_NUM_THREADS|llvmpipe|softpipe)\b/g) ?? []),
      ];

test("what is only for software OpenGL is in server/gl/software, behind one header", () => {
  assert.deepEqual(
    sources.flatMap((file) => pastDoor(file, read(file)).map((found) => `${file}: ${found}`)),
    [],
  );
  const through = '#include "server/gl/software/displays.h"\nsetenv("LP_NUM_THREADS", "0", 1);  // llvmpipe\n';
  assert.deepEqual(pastDoor("server/sim/a.cpp", through), ["server/gl/software/displays.h", "LP_NUM_THREADS"]);
  assert.deepEqual(pastDoor("server/sim/a.cpp", `#include "${door}"\n`), []);
});

test("what the lab measures does not depend on how it is drawn or exported", () => {
  const above = /^\s*#\s*include\s+"server\/lab\/(?!measure\/)/m;
  assert.deepEqual(
    sources.filter((file) => file.startsWith("server/lab/measure/") && above.test(read(file))),
    [],
  );
});

test("the check sees an include that goes up the list, and none that goes down", () => {
  const inSession = '#include "server/net/limits.h"\n#include "server/sim/plan.h"\n';
  assert.deepEqual(forbidden("server/session/a.cpp", inSession), ["server/net/limits.h"]);
  const inSim = '  #  include "server/lab/measure/chart.h"\n#include "tests/scenes.h"\n';
  assert.deepEqual(forbidden("server/sim/a.cpp", inSim), ["server/lab/measure/chart.h", "tests/scenes.h"]);
});
