// Makes recordings with `clothlab record` and reads them with the page's own reader.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { inflateRawSync } from "node:zlib";
import { load } from "../page/module.mjs";
import { clothlab, folder } from "./program.mjs";

const inflate = async (bytes) => new Uint8Array(inflateRawSync(bytes));
let page;

export function record(args, out) {
  const { status, stdout, stderr } = clothlab(["record", ...args, "--out", out]);
  return { status, stdout, stderr, path: join(folder, out) };
}

/// What the bytes of a recording hold.
export async function readRecording(bytes) {
  page ??= await load("player/recording");
  const recording = await page.Reader.open(new Uint8Array(bytes).buffer, inflate);
  const moments = [];
  for (const group of recording.groups) moments.push(...(await page.readGroup(group, inflate)));
  return { recording, moments };
}

/// The bytes of a recording in a page.
export const inPage = (html) => Buffer.from(/id="recording">([A-Za-z0-9+/=]*)</.exec(html)[1], "base64");

/// The positions of a PC2 file's samples.
export function pointCache(path) {
  const bytes = readFileSync(path);
  const [points, samples] = [bytes.readInt32LE(16), bytes.readInt32LE(28)];
  return Array.from({ length: samples }, (_, sample) =>
    Array.from({ length: 3 * points }, (_, i) => bytes.readFloatLE(32 + 4 * (3 * points * sample + i))),
  );
}
