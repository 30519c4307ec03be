// Where buffers, attributes and uniforms are bound is said in shaders/slots.glsl alone: elsewhere shaders and C++ have
// names for it, no numbers.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { files, root } from "./files.mjs";

const read = (file) => readFileSync(join(root, file), "utf8");
const list = "shaders/slots.glsl";
const isShader = /\.(?:glsl|comp|vert|geom|frag)$/;
const isCode = /^(?:shaders|server|tests)\/.*\.(?:glsl|comp|vert|geom|frag|h|cpp)$/;
const sources = files.filter((file) => isCode.test(file) && file !== list).map((file) => [file, read(file)]);

const number = new RegExp(
  [
    /\b(?:binding|location) = [^,)]*\b\d[^)]*\)(?! out )/, // a picture has one colour
    /\bREAD_\w+\(\w+, [^)]*\b\d/,
    /\bbind(?:_storage)?\([^()]*\b\d/,
    /\bglBind(?:TextureUnit|ImageTexture)\(\d|\bglBindBuffer(?:Base|Range)\(\w+, \d/,
    /\bglUniform\w+\(\d|\bglProgramUniform\w+\([^,]+, \d|\bgl\w*VertexArray\w+\(\w+, \d/,
    /\b(?:GLuint|int) (?:unit|slot)_\w+ = \d/,
  ]
    .map((pattern) => pattern.source)
    .join("|"),
  "g",
);

test("shaders and C++ bind by name", () => {
  assert.deepEqual(
    sources.flatMap(([file, text]) => (text.match(number) ?? []).map((found) => `${file}: ${found}`)),
    [],
  );
});

test("every name is used by a shader and by C++, and each number is below how many there are", () => {
  const names = new Map([...read(list).matchAll(/^const int (\w+) = (\d+);/gm)].map(([, name, is]) => [name, +is]));
  assert.ok(names.size > 50);
  const [inShaders, inCpp] = [true, false].map((shaders) => {
    const texts = sources.filter(([file]) => isShader.test(file) === shaders).map(([, text]) => text);
    return new Set(texts.join("\n").match(/\b[a-z]\w+/g));
  });
  for (const [name, is] of names) {
    assert.ok(inCpp.has(name), `${name} in C++`);
    assert.ok(inShaders.has(name) || name === "number_of_units", `${name} in a shader`);
    const kind = /^(?:unit|slot)/.exec(name)?.[0];
    if (kind) assert.ok(is < names.get(`number_of_${kind}s`), name);
  }
});

test("the check sees numbers, and none in names", () => {
  for (const bad of [
    "READ_VEC4(position, 0);",
    "layout(std430, binding = 4) buffer Control {",
    "layout(location = 1) uniform int count;",
    "heads_.buffer.bind_storage(3);",
    "rest.bind(unit_slope + 1);",
    "glBindBufferBase(GL_UNIFORM_BUFFER, 0, id);",
    "glUniform1i(4, first);",
    "constexpr GLuint unit_deviation = 9;",
  ])
    assert.equal(bad.match(number)?.length, 1, bad);
  for (const good of [
    "READ_VEC4(slope_1, unit_slope_1);  // 1 of 3",
    "layout(local_size_x = 64) in;",
    "layout(location = 0) out vec4 pixel;",
    "vectors_[0].residual.bind(unit_residual);",
    "glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, 0);",
    "glUniform4f(uniform_placed, 0, 0, 0, 1);",
  ])
    assert.equal(good.match(number), null, good);
});
