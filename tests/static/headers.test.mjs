// Each of our headers compiles alone, whatever is included before it elsewhere. NAME.cpp includes NAME.h first, so that
// a build of each source by itself checks it (the preset odr; the others compile several together); headers without
// such a source are compiled here.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { cpus } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";

const root = fileURLToPath(new URL("../../", import.meta.url));
const compiler = process.env.CLOTHLAB_CXX;
/// Folders of the generated OpenGL loader and of libraries that are not in the usual places.
const folders = (process.env.CLOTHLAB_INCLUDES ?? "").split(":").filter(Boolean);

function* headers(folder) {
  for (const entry of readdirSync(join(root, folder), { withFileTypes: true })) {
    const path = join(folder, entry.name);
    if (entry.isDirectory() && entry.name !== "node_modules") yield* headers(path);
    else if (entry.name.endsWith(".h")) yield path;
  }
}

const all = [...headers("server"), ...headers("tests")];
const sourceOf = (header) => header.replace(/h$/, "cpp");
const [sourced, alone] = [true, false].map((has) =>
  all.filter((header) => existsSync(join(root, sourceOf(header))) === has),
);

test("a source includes the header of its name before anything else", () => {
  assert.ok(sourced.length > 100);
  for (const header of sourced)
    assert.equal(
      /^#include (.*)$/m.exec(readFileSync(join(root, sourceOf(header)), "utf8"))?.[1],
      `"${header}"`,
      sourceOf(header),
    );
});

const skip = compiler ? false : "CLOTHLAB_CXX names no compiler";
test("a header without a source of its name compiles alone", { skip }, async () => {
  const waiting = [...alone],
    failures = [];
  const work = async () => {
    for (let header; (header = waiting.pop()); ) {
      const args = [
        "-std=c++20",
        "-fsyntax-only",
        "-I.",
        ...folders.flatMap((folder) => ["-isystem", folder]),
        '-DCLOTHLAB_VERSION=""',
        '-DCLOTHLAB_SOURCE_DIR=""',
        "-include",
        header,
        "-x",
        "c++",
        "/dev/null",
      ];
      await promisify(execFile)(compiler, args, { cwd: root }).catch(({ stderr }) =>
        failures.push(`${header}: ${stderr}`),
      );
    }
  };
  await Promise.all(cpus().map(work));
  assert.deepEqual(failures, []);
});
