// Writes into a WebM file how long it is. A browser's MediaRecorder leaves that out, as it writes the head first, and a
// player then shows no length and cannot seek. After RFC 8794 (EBML) and RFC 9559 (Matroska).

const ids = {
  segment: 0x18538067,
  info: 0x1549a966,
  timestampScale: 0x2ad7b1,
  duration: 0x4489,
  cluster: 0x1f43b675,
  timestamp: 0xe7,
  simpleBlock: 0xa3,
  blockGroup: 0xa0,
  block: 0xa1,
} as const;
const containers: number[] = [ids.segment, ids.info, ids.cluster, ids.blockGroup];

interface Element {
  id: number;
  at: number; ///< of its id
  content: number; ///< where that begins
  size: number; ///< of its content; Infinity: to the end of what it is in
}

/// The bytes of a number whose first byte says how many there are: by the place of its first 1.
const lengthAt = (file: Uint8Array, at: number): number => Math.clz32(file[at] ?? 0) - 23;

function numberOf(file: Uint8Array, at: number, length: number): number {
  let value = 0;
  for (let i = 0; i < length; ++i) value = 256 * value + (file[at + i] ?? 0);
  return value;
}

/// All elements of the file, those in containers, too, in its order; it ends where the file is no EBML.
function* elements(file: Uint8Array): Generator<Element> {
  for (let at = 0; at < file.length; ) {
    const idLength = lengthAt(file, at);
    const sizeAt = at + idLength;
    const sizeLength = lengthAt(file, sizeAt);
    if (idLength > 4 || sizeLength > 8) return;
    const content = sizeAt + sizeLength;
    const most = 2 ** (7 * sizeLength) - 1; // all bits: not known
    const size = numberOf(file, sizeAt, sizeLength) - most - 1;
    const element = { id: numberOf(file, at, idLength), at, content, size: size === most ? Infinity : size };
    yield element;
    at = containers.includes(element.id) ? content : content + size;
  }
}

/// A size in eight bytes; null: not known.
function sizeBytes(size: number | null): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(8);
  new DataView(bytes.buffer).setBigUint64(0, (1n << 56n) | (size === null ? (1n << 56n) - 1n : BigInt(size)));
  return bytes;
}

const idBytes = (id: number): Uint8Array<ArrayBuffer> => {
  const bytes = id.toString(16).match(/../g) ?? [];
  return Uint8Array.from(bytes, (byte) => Number.parseInt(byte, 16));
};

/// The file's parts, with its duration: to the last picture's time and `lasts` [s] more. The file as it is if it tells
/// its duration already, or is none that this knows.
export function withDuration(file: Uint8Array<ArrayBuffer>, lasts: number): Uint8Array<ArrayBuffer>[] {
  let segment: Element | null = null;
  let info: Element | null = null;
  let scale = 1e6; // [ns] of a unit of time
  let cluster = 0;
  let last = -1;
  const units = (element: Element): number => numberOf(file, element.content, element.size);
  for (const element of elements(file)) {
    const { id, content } = element;
    if (id === ids.duration) return [file];
    if (id === ids.segment) segment = element;
    if (id === ids.info) info = element;
    if (id === ids.timestampScale) scale = units(element);
    if (id === ids.timestamp) cluster = units(element);
    if (id !== ids.simpleBlock && id !== ids.block) continue;
    const after = new DataView(file.buffer, file.byteOffset + content + lengthAt(file, content)).getInt16(0);
    last = Math.max(last, cluster + after);
  }
  if (!segment || !info || last < 0 || !Number.isFinite(info.size)) return [file];
  const duration = new Uint8Array(8);
  new DataView(duration.buffer).setFloat64(0, last + (1e9 * lasts) / scale);
  const added = [idBytes(ids.duration), Uint8Array.of(0x88), duration]; // of eight bytes
  const end = info.content + info.size;
  return [
    file.subarray(0, segment.at),
    idBytes(ids.segment),
    sizeBytes(null), // it has grown
    file.subarray(segment.content, info.at),
    idBytes(ids.info),
    sizeBytes(info.size + 11),
    file.subarray(info.content, end),
    ...added,
    file.subarray(end),
  ];
}
