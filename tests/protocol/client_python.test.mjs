// The Python client, by client.py in a Python with NumPy.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { cacheEnvironment } from "./harness.mjs";

const python = ["/usr/bin/python3", "python3"].find((name) => spawnSync(name, ["-c", "import numpy"]).status === 0);

test("the Python client, as the server serves it", { skip: python ? false : "no Python has NumPy here" }, () => {
  const { status, stdout, stderr } = spawnSync(python, [fileURLToPath(new URL("client.py", import.meta.url))], {
    encoding: "utf8",
    timeout: 600_000,
    env: { ...process.env, ...cacheEnvironment, PYTHONDONTWRITEBYTECODE: "1" },
  });
  assert.equal(status, 0, stdout + stderr);
  assert.match(stderr, /Ran \d\d tests/);
});
