// How fabrics look, by their names.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { load } from "./module.mjs";

const { lookOf, looks, metresPerTexture, weaves } = await load("view/fabric_looks");
const named = JSON.parse(readFileSync(new URL("../../server/scene/fabrics.json", import.meta.url), "utf8"));

test("every fabric of the server has a look of its own, and no other name has one", () => {
  assert.deepEqual(Object.keys(looks).sort(), named.map(({ name }) => name).sort());
  assert.equal(new Set(Object.values(looks).map((look) => JSON.stringify(look))).size, named.length);
});

test("threads are as far apart as real ones, and cloth as thick: in millimetres", () => {
  assert.deepEqual(lookOf("cotton").pitch, [0.4, 0.4]);
  assert.deepEqual(lookOf("denim").pitch, [0.8, 0.8]);
  assert.equal(lookOf("denim").weave, "twill");
  assert.equal(lookOf("silk").weave, "satin");
  assert.equal(lookOf("interlock").weave, "knit");
  for (const [name, { pitch, thickness, weave }] of Object.entries(looks)) {
    assert.ok(weaves.includes(weave));
    assert.ok(
      pitch.every((each) => each >= 0.1 && each <= 2),
      name,
    );
    assert.ok(thickness >= 0.1 && thickness <= 3, name);
  }
  assert.ok(lookOf("denim").thickness > 2 * lookOf("cotton").thickness);
});

test("a cloth without a fabric, or with one that the page does not know, looks like cotton", () => {
  assert.equal(lookOf(undefined), looks.cotton);
  assert.equal(lookOf("unheard of"), looks.cotton);
});

test("a mesh file's texture is measured in metres, for each cloth by itself", () => {
  const places = Float32Array.of(0, 0, 0, 2, 0, 0, 0, 2, 0, 5, 5, 5, 5.5, 5, 5, 5, 5.5, 5);
  const texture = Float32Array.of(0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1);
  const triangles = Uint32Array.of(0, 1, 2, 3, 4, 5);
  const of = (firstVertex) => metresPerTexture(places, texture, triangles, { firstVertex, vertexCount: 3 });
  assert.equal(of(0), 2);
  assert.equal(of(3), 0.5);
  assert.equal(metresPerTexture(places, new Float32Array(12), triangles, { firstVertex: 0, vertexCount: 3 }), 1);
});
