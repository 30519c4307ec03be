// docker/debian/clothlab.service: systemd understands every line, and it leaves the server little but its work.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { root } from "./files.mjs";

const unit = readFileSync(join(root, "docker/debian/clothlab.service"), "utf8");
const folder = mkdtempSync(join(tmpdir(), "clothlab-service-"));
after(() => rmSync(folder, { recursive: true, force: true }));
const skip = spawnSync("systemd-analyze", ["--version"]).error && "systemd-analyze is not installed";

function analyze(text, ...args) {
  const file = join(folder, "clothlab.service");
  writeFileSync(file, text);
  const { status, stdout, stderr } = spawnSync("systemd-analyze", [...args, file], { encoding: "utf8" });
  return { status, told: stdout + stderr };
}
/// The program and its manual are not installed here.
const here = unit.replace("ExecStart=clothlab", "ExecStart=/bin/sh").replace(/^Documentation=.*\n/m, "");
/// 2.0 of 10, where less is better; without the protections a service has 9.6.
const exposure = ["security", "--offline=true", "--threshold=20", "--no-pager"];

test("systemd has nothing to say about the service", { skip }, () => {
  const { status, told } = analyze(here, "verify", "--recursive-errors=no");
  assert.deepEqual([status, told], [0, ""]);
  assert.match(analyze(here.replace("ProtectHome=", "ProtectHomes="), "verify").told, /ProtectHomes/);
});

test("its exposure is at most 2 of 10, and not without its protections", { skip }, () => {
  assert.equal(analyze(here, ...exposure).status, 0);
  for (const protection of [/^SystemCall.*\n/gm, /^Capability.*\n/gm, /^Protect.*\n/gm])
    assert.notEqual(analyze(here.replace(protection, ""), ...exposure).status, 0, String(protection));
});

test("it listens where the program does without options: on this machine alone", () => {
  const [, command] = /^ExecStart=(.*)$/m.exec(unit);
  assert.equal(command, "clothlab serve --state-dir %S/clothlab/sessions $CLOTHLAB_OPTIONS");
  const options = readFileSync(join(root, "docker/debian/clothlab.default"), "utf8").match(/^[^#\n].*$/gm);
  assert.deepEqual(options, ["CLOTHLAB_OPTIONS="]);
});
