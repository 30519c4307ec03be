// docker/gallery makes a folder that any web server can serve: each scene's recording, its picture, and a page of all.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { folder, program } from "./program.mjs";

const script = fileURLToPath(new URL("../../docker/gallery", import.meta.url));

function gallery(...args) {
  const env = { ...process.env, CLOTHLAB: resolve(program), SECONDS_EACH: "0.1" };
  return spawnSync("bash", [script, ...args], { cwd: folder, encoding: "utf8", env });
}

test("a gallery of a preset and of a scene file: pages that play, pictures, and one page that links to them", () => {
  const scene = { version: 1, cloths: [{ mesh: { grid: { columns: 5, rows: 5 } } }] };
  writeFileSync(join(folder, "my <b> & more.json"), JSON.stringify(scene));
  const { status, stderr } = gallery("shown", "hanging-strip", "my <b> & more.json");
  assert.equal(status, 0, stderr);
  const files = readdirSync(join(folder, "shown")).sort();
  const names = ["hanging-strip", "my--b----more"];
  assert.deepEqual(files, [...names.flatMap((name) => [`${name}.html`, `${name}.png`]), "index.html"].sort());
  const index = readFileSync(join(folder, "shown", "index.html"), "utf8");
  const named = (attribute) => [...index.matchAll(new RegExp(`${attribute}="([^":]*)"`, "g"))].map(([, name]) => name);
  assert.deepEqual(
    named("href"),
    names.map((name) => `${name}.html`),
  );
  assert.deepEqual(
    named("src"),
    names.map((name) => `${name}.png`),
  );
  assert.match(index, /<b>my &lt;b&gt; &amp; more<\/b>/);
  assert.match(index, /<b>hanging-strip<\/b> <span>[a-z][^<]+<\/span>/);
  assert.match(readFileSync(join(folder, "shown", "hanging-strip.html"), "utf8"), /id="recording">[\w+/=]+</);
});

test("a scene that is not there ends it, with the program's own words", () => {
  const { status, stderr } = gallery("none", "no-such-preset");
  assert.ok(status !== 0 && /no-such-preset/.test(stderr), stderr);
});
