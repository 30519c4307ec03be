// A scene in a link: its JSON, compressed (raw deflate), in base64url after `#scene=`. Nothing of it goes to a server
// until whoever opens the link says so. `&compare=` may follow with a comparison of that scene.
import { isFault, readJson } from "./json_text";
import { isObject } from "../link/json_patch";
import type { SceneDocument } from "../link/scene_types";

const key = "#scene=";
const old = "This browser is too old for scenes in links: save the scene as a file instead.";
const damaged = "The link is damaged: perhaps its end was cut off when it was sent. Ask for it again, or for a file.";

async function through(bytes: BlobPart, stream: GenericTransformStream, most: number): Promise<Uint8Array> {
  const reader = (
    new Blob([bytes]).stream().pipeThrough(stream as ReadableWritablePair) as ReadableStream<Uint8Array>
  ).getReader();
  const parts: Uint8Array[] = [];
  let size = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > most) {
      void reader.cancel();
      throw new RangeError(`more than ${most} bytes`);
    }
    parts.push(value);
  }
  const all = new Uint8Array(size);
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}

/// A value as text for a link.
export async function packed(value: unknown): Promise<string> {
  if (!("CompressionStream" in globalThis)) throw new Error(old);
  const bytes = await through(JSON.stringify(value), new CompressionStream("deflate-raw"), Infinity);
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

/// The value that `packed` made the text of. Throws an Error that says in words why there is none.
export async function unpacked(text: string, mostBytes: number): Promise<unknown> {
  if (!("DecompressionStream" in globalThis)) throw new Error(old);
  let bytes: Uint8Array;
  try {
    const raw = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
    bytes = await through(raw, new DecompressionStream("deflate-raw"), mostBytes);
  } catch (error) {
    if (error instanceof RangeError)
      throw new Error(`What the link carries has more than the ${mostBytes} bytes that a scene may have.`);
    throw new Error(damaged);
  }
  const read = readJson(new TextDecoder().decode(bytes));
  if (isFault(read)) throw new Error(damaged);
  return read.value;
}

/// The part of a link from # on.
export const fragmentOf = async (scene: SceneDocument): Promise<string> => key + (await packed(scene));

/// What follows the scene in a link, as a link's part of its own; "" if nothing does.
export function besideScene(fragment: string): string {
  const rest = fragment.indexOf("&");
  return rest < 0 ? "" : `#${fragment.slice(rest + 1)}`;
}

export const carriesScene = (fragment: string): boolean => fragment.startsWith(key);

/// The scene in a link. Throws an Error that says in words why there is none.
export async function sceneIn(fragment: string, mostBytes: number): Promise<SceneDocument> {
  const scene = (await unpacked(fragment.slice(key.length).split("&")[0] ?? "", mostBytes)) as Partial<SceneDocument>;
  if (!isObject(scene) || !Array.isArray(scene.cloths)) throw new Error("The link carries no scene: it has no cloths.");
  return scene as SceneDocument;
}
