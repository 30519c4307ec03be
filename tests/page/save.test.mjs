// The name of a picture or a video that is saved.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { load } from "./module.mjs";

let fileName;
before(async () => {
  ({ fileName } = await load("panel/file_name"));
});

test("a file is named after the scene and the time, without what a file's name may not have", () => {
  assert.equal(fileName("seed", 3.754, "png"), "seed-3.75s.png");
  assert.equal(fileName("../my cloth: a/b?", 0, "webm"), "my-cloth-a-b-0.00s.webm");
  assert.equal(fileName("Tischtücher", 12, "png"), "Tischtücher-12.00s.png");
  assert.equal(fileName("///", 1, "png"), "cloth-1.00s.png");
});
