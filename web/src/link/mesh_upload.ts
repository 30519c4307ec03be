// A file of meshes on its way to the server: the message with its content, and what the server answers of it.
import type { Vec3 } from "./scene_types";

/// An opening of a mesh, or its outline.
export interface Border {
  vertices: number[]; ///< in order, of many some, evenly chosen; as a pin counts them
  middle: Vec3;
}

/// What mesh.upload answers of a file, and of each named part of it. Lengths are in the file's unit.
export interface Part {
  node?: string; ///< the name of the part; none: the whole file
  vertices: number;
  triangles: number;
  pattern: boolean; ///< it has texture coordinates
  box: [Vec3, Vec3];
  area: number;
  pattern_area: number;
  mean_edge: number;
  no_cloth: string | null; ///< why it can be a body alone
  borders: Border[]; ///< the longest first
  ends: [number[], number[], number[]]; ///< vertices of the last 3 % along x, y and z
}
export interface Uploaded extends Part {
  name: string;
  notes: string[]; ///< what was mended, where it is open
  nodes: Part[];
}

export const largestMessage = 8 * 1024 * 1024; // bytes: hello.limits.meshes.message_bytes
const longestName = 64; // bytes

const coded = (bytes: Uint8Array): string => {
  let text = "";
  for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
  return btoa(text);
};

/// The content for mesh.upload: text as it is, a binary .ply or a .glb file in base64.
export function content(bytes: Uint8Array): { obj: string; encoding: "text" | "base64" } {
  const head = new TextDecoder("latin1").decode(bytes.subarray(0, 200));
  if (!/^glTF|^ply\s[^]*format binary/.test(head)) return { obj: new TextDecoder().decode(bytes), encoding: "text" };
  return { obj: coded(bytes), encoding: "base64" };
}

/// A .gltf file with the buffers in it that lie beside it: an upload is one file. What is no JSON stays as it is, and
/// the server says what is wrong.
export function withBuffers(gltf: string, beside: Map<string, Uint8Array>): string {
  let file: { buffers?: { uri?: string }[] };
  try {
    file = JSON.parse(gltf) as typeof file;
  } catch {
    return gltf;
  }
  for (const buffer of file.buffers ?? []) {
    const bytes = beside.get(decodeURIComponent(buffer.uri ?? ""));
    if (bytes) buffer.uri = `data:application/octet-stream;base64,${coded(bytes)}`;
  }
  return JSON.stringify(file);
}

/// The name of a file in the session: its end, of at most 64 bytes, with a number if the scene has it already. An
/// upload by a name that the scene has would change the scene unasked.
export function freeFileName(file: string, taken: Set<string>): string {
  const [, stem = "", ending = ""] = /^(.*?)(\.[^.]*)?$/.exec(file) ?? [];
  const bytes = (text: string): number => new TextEncoder().encode(text).length;
  for (let number = 1; ; ++number) {
    const rest = (number === 1 ? "" : `-${number}`) + ending;
    let from = 0;
    while (bytes(stem.slice(from) + rest) > longestName) ++from;
    const name = stem.slice(from) + rest;
    if (!taken.has(name)) return name;
  }
}
