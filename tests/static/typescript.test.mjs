// The page's TypeScript and the client for scripts have no type error: the bundler only strips types and would not
// notice.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { root } from "./files.mjs";

const compiler = join(root, "web/node_modules/typescript/bin/tsc");
const skip = !existsSync(compiler) && "web/node_modules is not installed: server/run or tests/run do it";
const typed = (...options) => {
  const { status, stdout } = spawnSync(process.execPath, [compiler, "--noEmit", ...options], {
    cwd: root,
    encoding: "utf8",
  });
  assert.equal(status, 0, stdout);
};

test("the page's TypeScript has no type error", { skip }, () => {
  typed("-p", "web");
});

test("the JavaScript client has no type error, by its JSDoc", { skip }, () => {
  const strict = ["--allowJs", "--checkJs", "--strict", "--noImplicitOverride", "--skipLibCheck"];
  const language = ["--target", "ES2022", "--module", "esnext", "--moduleResolution", "bundler"];
  const libraries = ["--lib", "ES2023,DOM,DOM.Iterable,DOM.AsyncIterable"];
  typed(...strict, ...language, ...libraries, "web/clients/clothlab.mjs");
});
