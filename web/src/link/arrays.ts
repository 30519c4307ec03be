// Arrays in answers: little-endian numbers in base64.

export function bytesOf(text: string): ArrayBuffer {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes.buffer;
}

export const uints = (text: string): Uint32Array => new Uint32Array(bytesOf(text));
export const floats = (text: string): Float32Array => new Float32Array(bytesOf(text));
export const octets = (text: string): Uint8Array => new Uint8Array(bytesOf(text));

/// One array after another.
export function joined<T extends Uint32Array | Float32Array | Uint8Array>(
  parts: T[],
  make: new (size: number) => T,
): T {
  const whole = new make(parts.reduce((size, part) => size + part.length, 0));
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole;
}
