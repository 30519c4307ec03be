// What is in a PNG.
import assert from "node:assert/strict";
import { inflateSync } from "node:zlib";

/** Width, height and pixels of an 8-bit PNG, RGB or, if it is `clear`, RGBA; every filter of the format. */
export function decode(png, clear = false) {
  assert.equal(png.subarray(0, 8).toString("latin1"), "\x89PNG\r\n\x1a\n");
  const [width, height] = [png.readUInt32BE(16), png.readUInt32BE(20)];
  assert.deepEqual([png[24], png[25]], [8, clear ? 6 : 2], "8 bits, RGB or RGBA");
  const chunks = [];
  for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at))
    if (png.toString("latin1", at + 4, at + 8) === "IDAT")
      chunks.push(png.subarray(at + 8, at + 8 + png.readUInt32BE(at)));
  const packed = inflateSync(Buffer.concat(chunks));
  const size = clear ? 4 : 3; // bytes of a pixel
  const row = size * width,
    pixels = Buffer.alloc(row * height);
  const paeth = (a, b, c) => {
    const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
    return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
  };
  for (let y = 0; y < height; ++y) {
    const filter = packed[y * (row + 1)];
    for (let x = 0; x < row; ++x) {
      const left = x < size ? 0 : pixels[y * row + x - size],
        up = y === 0 ? 0 : pixels[(y - 1) * row + x];
      const corner = x < size || y === 0 ? 0 : pixels[(y - 1) * row + x - size];
      const guess = [0, left, up, (left + up) >> 1, paeth(left, up, corner)][filter];
      pixels[y * row + x] = packed[y * (row + 1) + 1 + x] + guess;
    }
  }
  return { width, height, at: (x, y) => [...pixels.subarray(y * row + size * x, y * row + size * (x + 1))] };
}

/** Box and number of the pixels that satisfy the predicate. */
export function region(image, predicate) {
  const found = { count: 0, left: image.width, right: -1, top: image.height, bottom: -1 };
  for (let y = 0; y < image.height; ++y)
    for (let x = 0; x < image.width; ++x) {
      if (!predicate(image.at(x, y))) continue;
      ++found.count;
      [found.left, found.right] = [Math.min(found.left, x), Math.max(found.right, x)];
      [found.top, found.bottom] = [Math.min(found.top, y), Math.max(found.bottom, y)];
    }
  return found;
}
