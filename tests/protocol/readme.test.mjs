// Runs the scripts and scenes in the documents as they stand there, except for the port.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createInterface } from "node:readline";
import { after, before, test } from "node:test";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const program = process.env.CLOTHLAB ?? "build/release/clothlab";
/// The first piece of code in this language in a document.
const shown = (document, language) =>
  readFileSync(new URL(`../../${document}`, import.meta.url), "utf8").match(
    new RegExp("```" + language + "\n(.*?)```", "s"),
  )[1];
// Below tests/, so that Node finds the packages.
const folder = mkdtempSync(fileURLToPath(new URL("readme-", import.meta.url)));
let server, address;

/** Starts a process and resolves to its first lines that match, or rejects when it ends without them. */
function firstLines(child, pattern, count) {
  return new Promise((resolve, reject) => {
    const lines = [];
    let errors = "";
    child.stderr.on("data", (data) => (errors += data));
    createInterface({ input: child.stdout }).on("line", (line) => {
      if (pattern.test(line) && lines.push(line) === count) resolve(lines);
    });
    child.on("error", reject);
    child.on("exit", (code) => reject(new Error(`it ended with ${code} after ${lines.length} lines: ${errors}`)));
  });
}

before(async () => {
  server = spawn(program, ["serve", "--port", "0"]);
  const [line] = await firstLines(server, /^listening on /, 1);
  address = new URL(line.replace("listening on ", "")).host;
  for (const client of ["clothlab.py", "clothlab.mjs"])
    writeFileSync(join(folder, client), await (await fetch(`http://${address}/${client}`)).text());
});
after(() => {
  server?.kill();
  rmSync(folder, { recursive: true });
});

async function runs(document, language, extension, interpreter) {
  const code = shown(document, language);
  assert.match(code, /127\.0\.0\.1:8080/);
  const path = join(folder, `script.${extension}`);
  writeFileSync(path, code.replaceAll("127.0.0.1:8080", address));
  const child = spawn(interpreter, [path], { env: { ...process.env, PYTHONDONTWRITEBYTECODE: "1" } });
  try {
    const lines = await firstLines(child, /^\d+\.\d+ s: lowest vertex at -?\d+\.\d+ m$/, 3);
    const times = lines.map(parseFloat);
    assert.ok(times[0] <= times[1] && times[1] <= times[2], lines.join("\n"));
  } finally {
    child.kill();
  }
}

test("the script for Node prints a line a frame", () => runs("README.md", "js", "mjs", process.execPath));

const python = ["/usr/bin/python3", "python3"].find(
  (program) => spawnSync(program, ["-c", "import numpy"]).status === 0,
);
test("the script for Python prints a line a frame", { skip: python ? false : "no Python has NumPy here" }, () =>
  runs("README.md", "python", "py", python),
);

for (const document of ["README.md", "server/scene/README.md"])
  test(`the scene in ${document} is valid`, () => {
    const path = join(folder, "scene.json");
    writeFileSync(path, shown(document, "json"));
    const { status, stderr } = spawnSync(program, ["validate", path], { encoding: "utf8" });
    assert.equal(status, 0, stderr);
  });
