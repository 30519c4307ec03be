// Every text that is handed to a driver as a shader is GLSL 4.50 by the letter: glslangValidator is stricter than
// drivers are, each of which lets other mistakes pass.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { thorough } from "../thorough.mjs";

const folder = mkdtempSync(join(tmpdir(), "clothlab-glsl-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

/// What is wrong with these files: the message, and the line of the text that it is about.
function wrong(files) {
  const { status, stdout, error } = spawnSync("glslangValidator", files, { cwd: folder, encoding: "utf8" });
  assert.ifError(error);
  if (status === 0) return [];
  let text = [];
  const found = [];
  for (const line of stdout.split("\n")) {
    if (files.includes(line)) text = readFileSync(join(folder, line), "utf8").split("\n");
    const [, number, message] = /^(?:ERROR|WARNING): \S*?:(\d+): (.*)/.exec(line) ?? [];
    if (number) found.push(`${message}: ${text[number - 1].trim()}`);
  }
  return found.length > 0 ? found : [stdout];
}

const skip = spawnSync("glslangValidator", ["--version"]).error && "there is no glslangValidator (glslang-tools)";

test("the texts of all programs are strict GLSL", { skip }, () => {
  const { status, stderr } = spawnSync(process.env.CLOTHLAB_SHADER_TEXTS, [folder], {
    env: { ...process.env, LP_NUM_THREADS: "0" },
    encoding: "utf8",
  });
  assert.equal(status, 0, stderr);
  const files = readdirSync(folder);
  assert.ok(files.length > 1500, `${files.length} texts`);
  for (const stage of [".comp", ".vert", ".geom", ".frag"]) assert.ok(files.some((file) => file.endsWith(stage)));
  // They are named by their hashes, and most lines are in many of them: unless thorough, a third is read.
  const read = files.filter((_, k) => thorough || k % 3 === 0);
  assert.deepEqual([...new Set(wrong(read))], []);
});

test("the check sees a missing conversion, and says which line it is", { skip }, () => {
  writeFileSync(
    join(folder, "bad.comp"),
    "#version 450 core\nlayout(local_size_x = 1) in;\nvoid main() { int i = 1.5; }\n",
  );
  const found = wrong(["bad.comp"]);
  assert.ok(
    found.some((what) => /cannot convert/.test(what) && what.includes("int i = 1.5;")),
    `${found}`,
  );
});
