// Raw deflate, as the browser reads it.

export type Inflate = (bytes: Uint8Array) => Promise<Uint8Array>;

/// Older browsers have no `DecompressionStream`.
export const canInflate = (): boolean => "DecompressionStream" in globalThis;

/// Rejects what is not exactly one stream.
export const inflateRaw: Inflate = async (bytes) => {
  const stream = new Blob([bytes.slice()]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
};
