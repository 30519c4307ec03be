// docker/release in a copy of this repository: one version for everything, the list of changes, a commit and a tag.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { files, root } from "./files.mjs";

const copy = mkdtempSync(join(tmpdir(), "clothlab-release-"));
after(() => rmSync(copy, { recursive: true, force: true }));
const author = ["-c", "user.name=A", "-c", "user.email=a@localhost"];
const git = (...args) => execFileSync("git", [...author, ...args], { cwd: copy, encoding: "utf8" }).trim();
const release = (...args) =>
  spawnSync("docker/release", args, {
    cwd: copy,
    encoding: "utf8",
    env: { ...process.env, GIT_AUTHOR_NAME: "A", GIT_AUTHOR_EMAIL: "a@localhost", ...committer },
  });
const committer = { GIT_COMMITTER_NAME: "A", GIT_COMMITTER_EMAIL: "a@localhost" };
const read = (file) => readFileSync(join(copy, file), "utf8");

mkdirSync(join(copy, "docker"));
for (const file of ["CMakeLists.txt", "CHANGELOG.md", "docker/release"]) cpSync(join(root, file), join(copy, file));
if (!/^## Unreleased$/m.test(read("CHANGELOG.md")))
  writeFileSync(join(copy, "CHANGELOG.md"), read("CHANGELOG.md").replace("\n## ", "\n## Unreleased\n\n* A.\n\n## "));
git("init", "-q");
git("add", ".");
git("commit", "-q", "-m", "as it is");

test("a version that is none, or older, and what is not committed, are refused, and change nothing", () => {
  for (const [args, message] of [
    [[], /three numbers/],
    [["v1.0.0"], /three numbers/],
    [["1.0"], /three numbers/],
    [["0.0.1"], /0\.0\.1 is older than/],
  ]) {
    const { status, stderr } = release(...args);
    assert.equal(status, 1, args.join());
    assert.match(stderr, message);
  }
  writeFileSync(join(copy, "new"), "");
  assert.match(release("9.8.7").stderr, /not committed/);
  rmSync(join(copy, "new"));
  assert.equal(git("status", "--porcelain"), "");
});

test("a release is one commit with the version and the changes under it, and its tag", () => {
  const { status, stdout, stderr } = release("9.8.7");
  assert.equal(status, 0, stderr);
  assert.match(stdout, /v9\.8\.7 is tagged/);
  assert.match(read("CMakeLists.txt"), /^project\(clothlab VERSION 9\.8\.7 /m);
  assert.match(read("CHANGELOG.md"), /\n## 9\.8\.7\n\n\* /);
  assert.doesNotMatch(read("CHANGELOG.md"), /Unreleased/);
  assert.equal(git("rev-parse", "v9.8.7^{commit}"), git("rev-parse", "HEAD"));
  assert.equal(git("rev-list", "--count", "HEAD"), "2");
  assert.equal(git("status", "--porcelain"), "");
  assert.match(release("9.8.7").stderr, /tagged already/);
  assert.match(release("9.8.8").stderr, /nothing is new/);
});

test("the version is written nowhere else in what builds, runs or is packed", () => {
  const [, version] = /^project\(clothlab VERSION ([\d.]+)/m.exec(read("CMakeLists.txt"));
  const [now] = /\d+\.\d+\.\d+/.exec(readFileSync(join(root, "CMakeLists.txt"), "utf8").split("project(clothlab")[1]);
  assert.notEqual(now, version); // the copy was released
  const places = files.filter(
    (file) =>
      /^(?:server|web|docker|shaders|\.ci|\.github)\/|^CMake/.test(file) &&
      !/package-lock\.json$|\.(?:jpg|png)$/.test(file) &&
      new RegExp(`(?<![\\d.])${now.replaceAll(".", "\\.")}(?![\\d.])`).test(readFileSync(join(root, file), "latin1")),
  );
  assert.deepEqual(places, ["CMakeLists.txt"]);
});
