// Checks messages against server/net/asyncapi.yaml.
import { readFileSync } from "node:fs";
import Ajv2020 from "ajv/dist/2020.js";
import { parse } from "yaml";

export const place = new URL("../../server/net/asyncapi.yaml", import.meta.url);
export const document = parse(readFileSync(place, "utf8"));
export const messages = document.channels.session.messages;

const ajv = new Ajv2020({ strict: true, strictTypes: false, strictRequired: false, allowUnionTypes: true });
ajv.addVocabulary(Object.keys(document)); // keywords of a document that holds schemas but is none
for (const schema of ["../scene/scene.schema.json", "../lab/result.schema.json"])
  ajv.addSchema(JSON.parse(readFileSync(new URL(schema, place))), new URL(schema, place).href);
ajv.addSchema(document, place.href);

/// The reasons why a value violates the schema at a JSON Pointer of the document; empty if it is valid.
export function complaints(pointer, value) {
  const validate = ajv.getSchema(`${place.href}#${pointer}`);
  return validate(value)
    ? []
    : validate.errors.map(
        ({ instancePath, message, params }) => `${instancePath} ${message} ${JSON.stringify(params)}`,
      );
}

export const payloadComplaints = (name, value) => complaints(`/channels/session/messages/${name}/payload`, value);

/// The value at a JSON Pointer of the document, or at one of its $refs; undefined if there is none.
export function lookUp(reference, from = place) {
  const [file, pointer] = reference.split("#");
  const at = new URL(file, from);
  const root = at.href === place.href ? document : JSON.parse(readFileSync(at));
  return (pointer ?? "")
    .split("/")
    .slice(1)
    .reduce((value, key) => value?.[key.replaceAll("~1", "/").replaceAll("~0", "~")], root);
}

export const nameOf = ({ $ref }) => $ref.split("/").at(-1);

/// The operations, each with the names of its messages instead of references.
export const operations = Object.entries(document.operations).map(([name, operation]) => ({
  ...operation,
  name,
  messages: operation.messages.map(nameOf),
  replies: operation.reply?.messages.map(nameOf) ?? [],
}));
export const operation = (name) => operations.find((candidate) => candidate.name === name);

const sizes = { u8: 1, i8: 1, u16: 2, u32: 4, u64: 8, f32: 4, f64: 8 };
const readers = {
  u8: (view, at) => view.getUint8(at),
  i8: (view, at) => view.getInt8(at),
  u16: (view, at) => view.getUint16(at, true),
  u32: (view, at) => view.getUint32(at, true),
  u64: (view, at) => Number(view.getBigUint64(at, true)),
  f32: (view, at) => view.getFloat32(at, true),
  f64: (view, at) => view.getFloat64(at, true),
};

/// Reads a binary message by its `x-binary`: { header, ...payload }. Throws if it has too few or too many bytes.
export function readBinary(bytes) {
  const layout = document["x-binary"];
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = 0;
  const value = (type) => {
    const read = readers[type](view, at);
    at += sizes[type];
    return read;
  };
  const record = (fields, known) => {
    const read = {};
    for (const { name, type, count, times, items } of fields) {
      const one = () =>
        items ? record(items, known) : count ? Array.from({ length: count }, () => value(type)) : value(type);
      read[name] = times ? Array.from({ length: { ...known, ...read }[times] }, one) : one();
    }
    return read;
  };
  const header = record(layout.header, {});
  const encoding = ["f32", "q16", "c16"][header.encoding];
  const payload = record(header.kind === 1 ? layout.topology : layout[encoding], header);
  if (header.range > 0 && encoding !== "c16") Object.assign(payload, record(layout.field, header));
  if (at !== bytes.byteLength) throw new Error(`${bytes.byteLength - at} bytes too many`);
  return { header, ...payload };
}
