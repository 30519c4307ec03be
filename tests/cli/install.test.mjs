// What `cmake --install` installs runs from wherever it lies, and uses what lies beside it and nothing else. Each kind
// of installed file is marked, and the mark is looked for in what the program does.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { once } from "node:events";
import { existsSync, mkdirSync, readdirSync, readFileSync, renameSync, rmSync, statSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { createInterface } from "node:readline";
import { before, test } from "node:test";
import { folder, program } from "./program.mjs";

const tree = dirname(resolve(program));
const prefix = join(folder, "moved/usr");
const data = join(prefix, "share/clothlab");
const environment = { ...process.env, CLOTHLAB_DATA: undefined };
const installed = join(prefix, "bin/clothlab");

function run(args) {
  const { status, stdout, stderr } = spawnSync(installed, args, { cwd: folder, encoding: "utf8", env: environment });
  return { status, stdout, stderr };
}
function mark(file, from, to) {
  const text = readFileSync(join(data, file), "utf8");
  assert.ok(text.includes(from), `${file} has ${from}`);
  writeFileSync(join(data, file), text.replace(from, to));
}

before(() => {
  const { status, stdout, stderr } = spawnSync("cmake", ["--install", tree, "--prefix", join(folder, "first/usr")], {
    encoding: "utf8",
  });
  assert.equal(status, 0, stdout + stderr);
  mkdirSync(dirname(prefix));
  renameSync(join(folder, "first/usr"), prefix); // from where it was installed, nothing is left
});

test("files lie where the standard for file systems has them, readable for all and writable for the owner alone", () => {
  for (const file of ["bin/clothlab", "lib/systemd/system/clothlab.service", "lib/sysusers.d/clothlab.conf"])
    assert.ok(existsSync(join(prefix, file)), file);
  assert.deepEqual(readdirSync(prefix).sort(), ["bin", "lib", "share"]);
  assert.deepEqual(readdirSync(join(prefix, "bin")), ["clothlab"]);
  const files = readdirSync(data, { recursive: true }).filter((file) => statSync(join(data, file)).isFile());
  assert.ok(files.length > 100);
  for (const file of files) assert.equal(statSync(join(data, file)).mode & 0o777, 0o644, file);
  assert.deepEqual([...new Set(files.map((file) => file.split("/")[0]))].sort(), ["server", "shaders", "web"]);
});

test("info names the folders beside the program", () => {
  const { status, stdout, stderr } = run(["info"]);
  assert.equal(status, 0, stderr);
  for (const what of ["shaders", "server/scene/presets", "web/dist"])
    assert.ok(stdout.includes(` ${join(data, what)}\n`), `${what} in ${stdout}`);
});

test("presets, fabrics and shaders are those beside the program", () => {
  mark("server/scene/presets/seed.json", '"name": "seed"', '"name": "marked seed"');
  mark("server/scene/fabrics.json", '"cotton"', '"marked cotton"');
  const report = join(folder, "report.json");
  const good = run(["run", "seed", "--time", "0.01", "--report", report]);
  assert.equal(good.status, 0, good.stderr);
  assert.equal(JSON.parse(readFileSync(report, "utf8")).scene, "marked seed");
  assert.match(run(["fabrics"]).stdout, /marked cotton/);
  mark("shaders/access.glsl", "\n", "\nno_such_thing;\n");
  const bad = run(["run", "seed", "--time", "0.01"]);
  assert.notEqual(bad.status, 0);
  assert.match(bad.stderr, /access\.glsl:2: error/);
  mark("shaders/access.glsl", "no_such_thing;\n", "");
});

test("serve sends the page, the pictures and the clients beside the program", async (t) => {
  mark("web/dist/index.html", "<title>", "<title>marked ");
  mark("web/clients/clothlab.py", '"""', '"""marked ');
  const server = spawn(installed, ["serve", "--port", "0"], { env: environment, stdio: ["ignore", "pipe", "inherit"] });
  const ended = once(server, "close");
  t.after(() => server.kill("SIGKILL"));
  const [line] = await once(createInterface(server.stdout), "line");
  const url = /listening on (http:\S+)/.exec(line)[1];
  const text = async (path) => (await fetch(url + path)).text();
  assert.match(await text(""), /<title>marked /);
  assert.match(await text("clothlab.py"), /^"""marked /);
  if (existsSync(join(data, "web/pictures/seed.png")))
    assert.equal((await fetch(`${url}presets/seed.png`)).headers.get("content-type"), "image/png");
  server.kill("SIGTERM");
  assert.equal((await ended)[0], 0);
});

test("a preset, a page or a shader that is not beside the program is missing, wherever the sources are", () => {
  const missing = `not found below ${data}`;
  for (const [file, args, message] of [
    ["server/scene/presets/flag.json", ["run", "flag", "--time", "0.01"], missing],
    ["web/dist/player.html", ["record", "seed", "--time", "0.01", "--out", "a.html"], "has not been built"],
    ["shaders/access.glsl", ["run", "seed", "--time", "0.01"], missing],
  ]) {
    rmSync(join(data, file));
    const { status, stderr } = run(args);
    assert.notEqual(status, 0, file);
    assert.ok(stderr.includes(message), `${file}: ${stderr}`);
  }
});
