// What the deflate stream of frame-c16-speed could hold, and what it could not.
import { deflateRawSync } from "node:zlib";

const vertices = 9;
const field = Array(vertices).fill(0);

/// The field, then these bits.
function content(...bits) {
  const text = bits.join("");
  return [
    ...field,
    ...(text.padEnd(8 * Math.ceil(text.length / 8), "0").match(/.{8}/g) ?? []).map((byte) => parseInt(byte, 2)),
  ];
}
const zeros = (count) => "0".repeat(count);
// Three numbers of 65535 at vertex 0, which foretell numbers of 16 bits at vertices 1 and 2; the first of these is
// `number`, all others are 0.
const large = (number) => content("1".repeat(3 * 28), number, zeros(5 * 17 + 18));

export const right = [
  { what: "numbers that are all 0", content: content(zeros(3 * vertices)) },
  { what: "a number of 65535", content: large(`0${"1".repeat(16)}`) },
];

/// `golden` is the content of the golden frame.
export const wrong = (golden) => [
  ...golden.map((_, length) => ({ what: `${length} bytes of the content`, content: golden.slice(0, length) })),
  { what: "a byte too many", content: [...golden, 0] },
  ...[0, 1, 2, 3, 4].map((bit) => ({
    what: `a bit behind the end, ${bit}`,
    content: content(zeros(3 * vertices + bit), "1"),
  })),
  { what: "a number of 65536", content: large(`10${zeros(16)}`) },
  { what: "a content without end", content: Array(2000).fill(0) },
  { what: "nothing but ones", content: Array(200).fill(255) },
];

/// The message with the header of `message` and this content.
export function holding(message, held) {
  const payload = deflateRawSync(Uint8Array.from(held));
  const made = new Uint8Array(64 + payload.length);
  made.set(message.subarray(0, 64));
  made.set(payload, 64);
  new DataView(made.buffer).setUint32(56, payload.length, true);
  return made;
}
