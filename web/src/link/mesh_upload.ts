// What becomes of a mesh's file of the user's: a message with its content, and a cloth that hangs.
import type { Operation, Vec3 } from "./scene_types";

/// The answer of mesh.upload, the part that is used here.
export interface Uploaded {
  name: string;
  vertices: number;
  triangles: number;
  box: [Vec3, Vec3]; // [m]
}

const rounded = (value: number): number => Number(value.toPrecision(4));

/// What makes the first cloth of this mesh: upright, of a size between a hand and a tent, its top 3 % held.
export function hung(mesh: Uploaded): Operation[] {
  const [low, high] = mesh.box;
  const size = [0, 1, 2].map((axis) => (high[axis] as number) - (low[axis] as number)) as Vec3;
  const largest = Math.max(...size);
  // A file in centimetres or millimetres; else the cloth gets a size of 1 m.
  const scale = [1, 0.01, 0.001].find((unit) => largest * unit >= 0.2 && largest * unit <= 5) ?? rounded(1 / largest);
  const lying = size[1] < 0.05 * largest && size[2] > size[1]; // its third axis then points up
  const [bottom, top] = lying ? [low[2], high[2]] : [low[1], high[1]];
  const [front, back] = lying ? [-high[1], -low[1]] : [low[2], high[2]];
  const height = (top - bottom) * scale;
  const hangsFrom = rounded(height + 0.2);
  const middle = (from: number, to: number): number => rounded(-0.5 * scale * (from + to)) || 0;
  const translate: Vec3 = [middle(low[0], high[0]), rounded(hangsFrom - top * scale), middle(front, back)];
  const held: [Vec3, Vec3] = [
    [-1000, rounded(hangsFrom - 0.03 * height), -1000],
    [1000, rounded(hangsFrom + 0.01 * height + 0.001), 1000],
  ];
  const replace = (key: string, value: unknown): Operation => ({ op: "replace", path: `/cloths/0/${key}`, value });
  return [
    replace("mesh", { file: mesh.name, pattern: null }),
    replace("transform", { translate, rotate: [lying ? -90 : 0, 0, 0], scale }),
    replace("pins", [{ at: { box: held }, motion: null }]),
    replace("weights", []),
    replace("start", null),
  ];
}

/// The content for mesh.upload: text as it is, a binary .ply or a .glb file in base64.
export function content(bytes: Uint8Array): { obj: string; encoding: "text" | "base64" } {
  const head = new TextDecoder("latin1").decode(bytes.subarray(0, 200));
  if (!/^glTF|^ply\s[^]*format binary/.test(head)) return { obj: new TextDecoder().decode(bytes), encoding: "text" };
  let text = "";
  for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
  return { obj: btoa(text), encoding: "base64" };
}
