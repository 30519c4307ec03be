// GPUs that are in the machine and that OpenGL does not offer: `info` says what to pass to a container, or to install.
// The machine's files are played by a folder. And software OpenGL as a GPU gets it.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { clothlab, folder } from "./program.mjs";

/** A machine with these files; what `info` notes of its GPUs. */
function noted(files) {
  const machine = mkdtempSync(join(folder, "machine-"));
  for (const [name, text] of Object.entries(files)) {
    mkdirSync(dirname(join(machine, name)), { recursive: true });
    writeFileSync(join(machine, name), text);
  }
  const { status, stdout, stderr } = clothlab(["info"], { CLOTHLAB_GPU_FILES: machine });
  assert.equal(status, 0, stderr);
  assert.match(stdout, /^\* \d+: /m, "the device that is used is told as ever");
  return stderr;
}
const onBus = (vendor, kind = "0x030000") => ({
  "sys/bus/pci/devices/0000:01:00.0/vendor": `${vendor}\n`,
  "sys/bus/pci/devices/0000:01:00.0/class": `${kind}\n`,
});
const node = (vendor) => ({
  "dev/dri/renderD128": "",
  "sys/class/drm/renderD128/device/vendor": `${vendor}\n`,
  ...onBus(vendor),
});

test("an NVIDIA GPU in a container without the capability graphics is told with what to pass", () => {
  const said = noted({ "dev/nvidia0": "", ...onBus("0x10de") });
  assert.match(said, /an NVIDIA GPU is here \(\/dev\/nvidia0\)/);
  assert.match(said, /-e NVIDIA_DRIVER_CAPABILITIES=graphics,compute,utility/);
  assert.match(said, /libegl1/);
  assert.equal(said.trim().split("\n").length, 1, said);
});

test("a GPU of the host that is not passed on is told, of each maker", () => {
  const nvidia = noted(onBus("0x10de", "0x030200"));
  assert.match(nvidia, /in this machine \(PCI 0000:01:00\.0\).*--gpus all/);
  for (const [vendor, maker] of [
    ["0x1002", "an AMD"],
    ["0x8086", "an Intel"],
  ]) {
    const said = noted(onBus(vendor));
    assert.ok(said.includes(`${maker} GPU is in this machine (PCI 0000:01:00.0)`), said);
    assert.match(said, /--device \/dev\/dri/);
  }
});

test("a render node without Mesa's drivers is told with what to install", () => {
  assert.match(
    noted(node("0x1002")),
    /an AMD GPU is here \(\/dev\/dri\/renderD128\).*apt-get install.*libgl1-mesa-dri/,
  );
});

test("a machine without a GPU, with another maker's screen, or with other devices of these makers, hears nothing", () => {
  assert.equal(noted({}), "");
  assert.equal(noted(onBus("0x1234")), "");
  assert.equal(noted(onBus("0x8086", "0x020000")), "");
});

test("a device that there is none of is answered with those that there are", () => {
  const { status, stderr } = clothlab(["run", "seed", "--time", "0", "--gpu", "99"]);
  assert.equal(status, 2);
  assert.match(stderr, /--gpu: 99.*one of 0 .*clothlab info/s);
});

test("a GPU is asked nothing that only software OpenGL has, and ends in the same bits", () => {
  for (const words of [
    ["seed", "--time", "0.1"],
    ["twist", "--time", "0.03"],
    ["seed", "--time", "0.05", "--set", '/solver/method="xpbd"'],
  ]) {
    const hash = (environment) => {
      const { status, stderr } = clothlab(["run", ...words, "--report", "report.json"], environment);
      assert.equal(status, 0, stderr);
      return JSON.parse(readFileSync(join(folder, "report.json"), "utf8")).state_hash;
    };
    assert.equal(hash({ CLOTHLAB_PLAY_GPU: "1" }), hash({}), words.join(" "));
  }
  assert.doesNotMatch(clothlab(["info"], { CLOTHLAB_PLAY_GPU: "1" }).stdout, /\(software\)/);
});

test("a device that is reset ends a run with a message and exit code 1", () => {
  for (const command of [
    ["run", "seed", "--time", "1"],
    ["render", "seed", "--time", "1", "--out", "reset.png"],
  ]) {
    const { status, stderr } = clothlab(command, { CLOTHLAB_FAULT: "context-lost:/run:200" });
    assert.equal(status, 1, stderr);
    assert.match(stderr, /OpenGL: the device was reset at step \d+, and all that was on it is lost.*driver's log/s);
  }
});
