// The check of barriers (server/gl/checked_calls.h) sees every call of server/ that uses a buffer: what it leaves out
// uses none.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { files, root } from "./files.mjs";

const read = (file) => readFileSync(join(root, file), "utf8");
const checker = "server/gl/checked_calls.cpp";

/// Functions that use no buffer's contents: they make and ask for objects, set what draws and uniforms, and wait.
const harmless = new RegExp(
  [
    "Create\\w+",
    "Delete(?:Framebuffers|Queries|Renderbuffers|Sync)",
    "Get(?!\\w*(?:BufferSubData|TexImage))\\w+",
    "Is\\w+",
    "(?:Program)?Uniform\\w+",
    "(?:Compile|Link)\\w+",
    "\\w*(?:Framebuffer|Renderbuffer|TextureParameter)\\w*",
    "TextureStorage2D|ReadPixels|PixelStorei|PolygonOffset|Viewport|BlendFunc(?:Separate)?|DepthMask|Clear(?:Color)?",
    "Enable|Disable|ActiveTexture",
    "EnableVertexArrayAttrib|VertexArrayAttrib(?:Binding|Format)|ObjectLabel|QueryCounter|ClientWaitSync|Finish|Flush",
    "NamedBufferStorage", // of a buffer that nobody has used yet
  ]
    .map((names) => `^gl(?:${names})$`)
    .join("|"),
);

const called = (text) => [...text.matchAll(/\b(gl[A-Z]\w+)\(/g)].map(([, name]) => name);
const checked = new Set([...read(checker).matchAll(/"(gl[A-Z]\w+)"/g)].map(([, name]) => name));
const unseen = (text) => called(text).filter((name) => !checked.has(name) && !harmless.test(name));

test("every function of OpenGL that server/ calls is looked at by the check of barriers, or uses no buffer", () => {
  const sources = files.filter((file) => /^server\/.*\.(?:h|cpp)$/.test(file) && file !== checker);
  assert.ok(checked.size > 20);
  assert.deepEqual(
    sources.flatMap((file) => unseen(read(file)).map((name) => `${file}: ${name}`)),
    [],
  );
});

test("it sees a function that is new", () => {
  for (const name of ["glBindBufferRange", "glBufferSubData", "glDrawArraysIndirect", "glGetBufferSubData"])
    assert.deepEqual(unseen(`${name}(1);`), [name]);
  assert.deepEqual(unseen("glDispatchCompute(1, 1, 1); glProgramUniform1i(a, b, c);"), []);
});
