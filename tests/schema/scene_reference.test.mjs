// The tables of server/scene/README.md agree with the schema and the fabrics.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { updated } from "./scene_reference.mjs";

const folder = new URL("../../server/scene/", import.meta.url);

test("the scene's README has every key of the schema, with its range and default (else: node tests/schema/scene_reference.mjs)", () => {
  const readme = readFileSync(new URL("README.md", folder), "utf8");
  const [schema, fabrics] = ["scene.schema.json", "fabrics.json"].map((name) =>
    JSON.parse(readFileSync(new URL(name, folder))),
  );
  assert.equal(readme, updated(readme, schema, fabrics));
});
