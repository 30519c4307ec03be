// Runs the program as a user does: arguments in; exit code, output and files out.
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";

export const program = process.env.CLOTHLAB ?? "build/release/clothlab";

/** Everything a test file writes goes here, and goes away with it. */
export const folder = mkdtempSync(join(tmpdir(), "clothlab-cli-"));
after(() => rmSync(folder, { recursive: true, force: true }));

export function clothlab(args, environment = {}) {
  const { status, stdout, stderr, error } = spawnSync(program, args, {
    cwd: folder,
    encoding: "utf8",
    timeout: 120_000,
    env: { ...process.env, ...environment },
  });
  if (error) throw error;
  return { status, stdout, stderr };
}
