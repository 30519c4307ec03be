// `clothlab manual`: pages that man and mandoc read without a warning, and a completion that bash understands.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { clothlab, folder } from "./program.mjs";

const manual = join(folder, "manual");
const help = (...args) => clothlab([...args, "--help"]).stdout;
const commands = [
  ...help()
    .split("\nSubcommands:\n")[1]
    .split("\n\n")[0]
    .matchAll(/^ {2}([a-z]+) /gm),
].map(([, name]) => name);
const page = (name) => readFileSync(join(manual, name), "utf8");
/// What a reader sees of a page, without formatting.
const plain = (name) =>
  page(name)
    .replaceAll(/\\f[BIR]|\\&/g, "")
    .replaceAll("\\-", "-")
    .replaceAll("\\(ga", "`");

before(() => {
  const { status, stderr } = clothlab(["manual", "--out", manual, "--date", "2026-01-31"]);
  assert.equal(status, 0, stderr);
});

test("there is a page for the program and for each command, with every option of its help", () => {
  assert.ok(commands.length >= 15 && commands.includes("serve"), commands.join());
  const pages = ["clothlab.1", ...commands.map((command) => `clothlab-${command}.1`)];
  assert.deepEqual(readdirSync(manual).sort(), [...pages, "clothlab.bash"].sort());
  for (const command of commands) {
    const text = plain(`clothlab-${command}.1`);
    const options = [...help(command).matchAll(/^ {2}(?:-h,)?(--[a-z-]+)/gm)].map(([, option]) => option);
    assert.ok(options.includes("--help"));
    for (const option of options) assert.match(text, new RegExp(`^(?:-h, )?${option}\\b`, "m"), command);
    assert.match(plain("clothlab.1"), new RegExp(`^clothlab-${command}\\(1\\)`, "m"));
  }
  assert.match(
    plain("clothlab-serve.1"),
    /--port PORT\nthe port to listen on; 0 picks a free one \(8080 if not given\)/,
  );
  assert.match(plain("clothlab-serve.1"), /\(or CLOTHLAB_TOKEN in the environment\)/);
  assert.match(plain("clothlab.1"), new RegExp(`"Clothlab ${clothlab(["--version"]).stdout.trim().slice(9)}"`));
});

for (const [reader, args] of [
  ["mandoc", ["-Tlint", "-Wwarning"]],
  ["man", ["--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z"]],
]) {
  const none = spawnSync(reader, ["-V"]).error && `${reader} is not installed`;
  test(`${reader} has no warning`, { skip: none }, () => {
    for (const name of readdirSync(manual).filter((name) => name.endsWith(".1"))) {
      const { stdout, stderr } = spawnSync(reader, [...args, join(manual, name)], {
        encoding: "utf8",
        env: { ...process.env, MANWIDTH: "80", MANROFFSEQ: "" },
      });
      assert.equal(reader === "mandoc" ? stdout + stderr : stderr, "", name);
    }
  });
}

/// What bash would offer for the words, of which the last is being written.
function offered(...words) {
  const script = `source "${join(manual, "clothlab.bash")}"
    COMP_WORDS=(clothlab "$@"); COMP_CWORD=$#; _clothlab clothlab; printf '%s\\n' "\${COMPREPLY[@]}"`;
  const { stdout, stderr } = spawnSync("bash", ["-c", script, "bash", ...words], { encoding: "utf8" });
  assert.equal(stderr, "");
  return stdout.split("\n").filter(Boolean);
}

test("bash completes commands, options, words that an option takes, and presets", () => {
  assert.deepEqual(offered(""), [...commands, "--version", "--help"]);
  assert.deepEqual(offered("se"), ["serve", "selftest"]);
  assert.deepEqual(offered("serve", "--sta"), ["--state-dir"]);
  assert.deepEqual(offered("serve", "--log-level", ""), ["error", "warning", "info", "debug"]);
  assert.deepEqual(offered("run", "cur"), ["curtain"]);
  assert.deepEqual(offered("serve", "--scene", "cur"), ["curtain"]);
  assert.deepEqual(offered("presets", "cur"), []); // it takes no scene
  assert.deepEqual(offered("run", "seed", "--out", ""), []); // files, by bash itself
});
