// The fields' words and colours, and the bytes that the page draws.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before, test } from "node:test";
import { load } from "./module.mjs";

let page, protocol;
before(async () => {
  page = await load("view/fields");
  protocol = await load("link/protocol");
});
const golden = (name) => {
  const bytes = new Uint8Array(readFileSync(new URL(`../golden/${name}.bin`, import.meta.url)));
  return bytes.slice().buffer;
};

test("a field's bytes follow the vertices; a frame without one has none", () => {
  const { frame } = protocol.decode(golden("frame-q16-speed"));
  assert.equal(frame.header.range, 1);
  assert.deepEqual([...protocol.fieldBytes(frame)], [0, 0, 0, 255, 255, 255, 64, 64, 64]);
  assert.equal(protocol.q16Words(frame).length, 4 * 9);
  assert.equal(protocol.fieldBytes(protocol.decode(golden("frame-q16")).frame), null);
});

test("a range without bytes, bytes without a range, and a range that is none are refused", () => {
  const set = (name, range) => {
    const buffer = golden(name);
    new DataView(buffer).setFloat32(60, range, true);
    return buffer;
  };
  assert.throws(() => protocol.decode(set("frame-q16", 1)), protocol.BadMessage);
  for (const range of [0, -0, -1, NaN, Infinity])
    assert.throws(() => protocol.decode(set("frame-q16-speed", range)), protocol.BadMessage, String(range));
  assert.throws(() => protocol.decode(set("topology", 1)), protocol.BadMessage);
});

test("the legend has three figures and a unit", () => {
  const { fields } = page;
  assert.deepEqual(Object.keys(fields), ["strain", "speed", "contact", "growth"]);
  assert.equal(fields.strain.most(0.109375), "10.9 %");
  assert.equal(fields.strain.most(0.0005), "0.05 %");
  assert.equal(fields.speed.most(3.5), "3.5 m/s");
  assert.equal(fields.speed.most(0.009999999776482582), "0.01 m/s");
  assert.deepEqual([fields.contact.least, fields.contact.most(1)], ["free", "touching"]);
});

test("the legend's colours lie where the shader gives them: evenly, of strain in its square root", () => {
  const places = (field) => [...page.gradient(field).matchAll(/#(\w+) ([\d.]+)%/g)].map(([, , at]) => Number(at));
  assert.deepEqual(places("speed"), [0, 12.5, 25, 37.5, 50, 62.5, 75, 87.5, 100]);
  assert.deepEqual(places("strain"), [0, 1.6, 6.3, 14.1, 25, 39.1, 56.3, 76.6, 100]);
});

test("what is stored or not a field is no field", () => {
  for (const name of ["", null, "none", "toString", "cloth", "growth"]) assert.equal(page.isField(name), false);
  for (const name of ["strain", "speed", "contact"]) assert.equal(page.isField(name), true);
});

// Machado, Oliveira and Fernandes 2009: what an eye sees without one kind of cones, in linear RGB.
const eyes = {
  all: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  tritanopia: [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
};

test("the colours rise in lightness in even steps, for every kind of colour vision", () => {
  for (const [eye, m] of Object.entries(eyes)) {
    const lightness = page.scale.map((hex) => {
      const rgb = [0, 2, 4].map((at) => Number.parseInt(hex.slice(at, at + 2), 16) / 255);
      const linear = rgb.map((s) => (s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4));
      const seen = [0, 3, 6].map((row) => linear.reduce((sum, value, i) => sum + m[row + i] * value, 0));
      const luminance = 0.2126 * seen[0] + 0.7152 * seen[1] + 0.0722 * seen[2];
      return 116 * Math.cbrt(Math.max(luminance, 0)) - 16; // CIE L*
    });
    const steps = lightness.slice(1).map((value, i) => value - lightness[i]);
    assert.ok(Math.min(...steps) > 5 && Math.max(...steps) < 16, `${eye}: ${steps.map((step) => step.toFixed(1))}`);
  }
});
