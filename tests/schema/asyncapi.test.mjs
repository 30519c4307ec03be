// server/net/asyncapi.yaml by itself: it is a complete AsyncAPI 3 document and describes the bytes of the golden
// messages. tests/protocol/asyncapi.test.mjs compares it with real sessions.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { test } from "node:test";
import { inflateRawSync } from "node:zlib";
import Ajv from "ajv";
import { document, lookUp, messages, operations, payloadComplaints, readBinary } from "../protocol/asyncapi.mjs";

const { schemas } = createRequire(import.meta.url)("@asyncapi/specs");

/// Every object within a value, with its path.
function* objectsIn(value, path = "") {
  if (typeof value !== "object" || value === null) return;
  yield [path, value];
  for (const [key, inner] of Object.entries(value)) yield* objectsIn(inner, `${path}/${key}`);
}

/// The schema includes JSON Schema's own, which must not be added twice.
const compiled = () =>
  new Ajv({ strict: false, validateFormats: false, meta: false, validateSchema: false, logger: false }).compile(
    schemas[document.asyncapi],
  );

test("it is a valid AsyncAPI document of the version it names", () => {
  const validate = compiled();
  assert.ok(validate(document), JSON.stringify(validate.errors?.slice(0, 5), null, 1));
  assert.match(document.asyncapi, /^3\./);
});

test("a document with a field that AsyncAPI does not know is not valid", () => {
  const validate = compiled();
  assert.equal(validate({ ...document, methods: {} }), false);
});

test("every reference leads somewhere, and nothing that can be referred to is idle", () => {
  const used = new Set();
  for (const [path, { $ref }] of objectsIn(document)) {
    if (typeof $ref !== "string") continue;
    assert.notEqual(lookUp($ref), undefined, `${path}: ${$ref}`);
    used.add($ref);
  }
  for (const [kind, components] of Object.entries(document.components))
    for (const name of Object.keys(components))
      assert.ok(used.has(`#/components/${kind}/${name}`), `${kind}/${name} is used nowhere`);
  for (const name of Object.keys(messages))
    assert.ok(used.has(`#/channels/session/messages/${name}`), `no operation has ${name}`);
});

test("unknown keys are refused: every object that it describes is closed, and no message is empty", () => {
  for (const [path, schema] of objectsIn({ messages, schemas: document.components.schemas }))
    if (schema.type === "object" && schema.properties)
      assert.equal(schema.unevaluatedProperties ?? schema.additionalProperties, false, path);
  for (const name of Object.keys(messages).filter((name) => !messages[name].contentType))
    for (const nothing of [{}, { jsonrpc: "2.0" }]) assert.notDeepEqual(payloadComplaints(name, nothing), [], name);
});

test("a request's operation is named after its method, and is answered by something", () => {
  for (const {
    name,
    action,
    messages: [message],
    replies,
  } of operations.filter((o) => o.action === "receive")) {
    assert.equal(message, name);
    assert.equal(messages[name].payload.properties.method.const, name);
    assert.ok(
      replies.some((reply) => reply.startsWith("result.")),
      `${action} ${name}`,
    );
  }
});

test("the golden messages are laid out as it says", () => {
  for (const name of [
    "topology",
    "frame-q16",
    "frame-q16-asleep",
    "frame-f32",
    "frame-f32-diverged",
    "frame-q16-speed",
    "frame-f32-speed",
    "frame-c16",
    "frame-c16-speed",
  ]) {
    const file = (ending) => readFileSync(new URL(`../golden/${name}.${ending}`, import.meta.url));
    const bytes = file("bin");
    const { made_from, field, ...expected } = JSON.parse(file("json"));
    const {
      header: { range, ...header },
      triangle_count,
      cloth_count,
      ...content
    } = readBinary(bytes);
    assert.equal(range, expected.header.range ?? 0);
    delete expected.header.range;
    assert.ok(made_from.length > 0);
    if (header.kind === 1)
      assert.deepEqual([triangle_count, cloth_count], [expected.triangles.length, expected.cloths.length]);
    if (header.encoding === 1) for (const vertex of expected.vertices) delete vertex.position, delete vertex.normal;
    if (header.encoding === 2) {
      content.content = [...inflateRawSync(Buffer.from(content.deflated))];
      for (const key of ["triangles", "vertices", "numbers", "field_bytes"]) delete expected[key];
      delete content.deflated;
    }
    assert.deepEqual({ header, ...content }, expected, name);
    for (const wrong of [bytes.subarray(0, -1), Buffer.concat([bytes, Buffer.alloc(4)])])
      assert.throws(() => readBinary(wrong));
  }
});
