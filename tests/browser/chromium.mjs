#!/usr/bin/env node
// The browser of the tests. ctest starts one before the first browser test and ends it after the last one, so that all
// files share it, a context for each test; a file that is run by hand starts its own:
//   node tests/browser/chromium.mjs start FILE    leaves one running, and where it is in FILE
//   node tests/browser/chromium.mjs stop FILE     ends it; fails if it has ended before
import { spawn } from "node:child_process";
import { existsSync, mkdirSync, openSync, readFileSync, renameSync, rmSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const candidates = [
  process.env.CLOTHLAB_BROWSER,
  "/usr/bin/chromium",
  "/usr/bin/google-chrome",
  "/usr/bin/google-chrome-stable",
];
/// Undefined if there is no browser here.
export const executablePath = candidates.find((path) => path && existsSync(path));

const options = {
  executablePath,
  headless: true,
  args: [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-gpu-compositing",
  ],
};

const alive = (pid) => {
  try {
    return process.kill(pid, 0);
  } catch {
    return false;
  }
};

const described = (file) => JSON.parse(readFileSync(file, "utf8"));

/// The browser that ctest started, else one of this process's own.
export async function browser() {
  const file = process.env.CLOTHLAB_BROWSER_AT;
  if (file && existsSync(file)) {
    const { endpoint, pid } = described(file);
    if (alive(pid)) return chromium.connect(endpoint);
  }
  return chromium.launch(options);
}

/// Serves a browser until it is told to end, or ctest is gone without having said so.
async function serve(file, parent) {
  const server = await chromium.launchServer({ ...options, host: "127.0.0.1" });
  writeFileSync(`${file}.new`, JSON.stringify({ endpoint: server.wsEndpoint(), pid: process.pid }));
  renameSync(`${file}.new`, file);
  server.on("close", () => process.exit(1));
  const end = () => server.close().finally(() => process.exit());
  process.on("SIGTERM", end);
  setInterval(() => alive(parent) || end(), 1000);
}

async function start(file) {
  mkdirSync(dirname(file), { recursive: true });
  rmSync(file, { force: true });
  if (!executablePath) return console.log("no browser here");
  const log = openSync(`${file}.log`, "w");
  const child = spawn(process.execPath, [fileURLToPath(import.meta.url), "serve", file, String(process.ppid)], {
    detached: true,
    stdio: ["ignore", log, log],
  });
  child.unref();
  const until = Date.now() + 120_000;
  while (!existsSync(file)) {
    if (Date.now() > until || !alive(child.pid)) throw new Error(readFileSync(`${file}.log`, "utf8"));
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

async function stop(file) {
  if (!existsSync(file)) return;
  const { pid } = described(file);
  rmSync(file);
  if (!alive(pid)) throw new Error(`the browser has not lived to the end: ${readFileSync(`${file}.log`, "utf8")}`);
  process.kill(pid, "SIGTERM");
  while (alive(pid)) await new Promise((resolve) => setTimeout(resolve, 50));
}

const commands = { start, serve, stop };
if (process.argv[1] === fileURLToPath(import.meta.url)) await commands[process.argv[2]](...process.argv.slice(3));
