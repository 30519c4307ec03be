// The strain of springs and finite elements, from the places of their vertices, and which are strained most.

/// Of one kind: two vertices each, or three.
export interface Strained {
  vertices: Uint32Array; ///< [count * corners]
  corners: 2 | 3;
  strain: Float32Array; ///< [count] of the places seen last: more than 0 if stretched
}

export interface Springs extends Strained {
  corners: 2;
  restLength: Float32Array; ///< [count] [m]
  kind: Uint8Array; ///< [count] 0 structural, 1 shear, 2 bend
}

export interface Elements extends Strained {
  corners: 3;
  shares: Float32Array; ///< [count * 4] [1/m], as inspect.elements has them
}

/// Length over rest length, less 1. `places`: [vertex_count * 3] [m].
export function strainSprings({ vertices, restLength, strain }: Springs, places: Float32Array): void {
  for (let i = 0; i < strain.length; ++i) {
    const a = 3 * (vertices[2 * i] as number),
      b = 3 * (vertices[2 * i + 1] as number);
    const x = (places[b] as number) - (places[a] as number),
      y = (places[b + 1] as number) - (places[a + 1] as number),
      z = (places[b + 2] as number) - (places[a + 2] as number);
    strain[i] = Math.sqrt(x * x + y * y + z * z) / (restLength[i] as number) - 1;
  }
}

/// The change of length along warp or weft, whichever is more, as a share of the rest length.
export function strainElements({ vertices, shares, strain }: Elements, places: Float32Array): void {
  for (let i = 0; i < strain.length; ++i) {
    const a = 3 * (vertices[3 * i] as number),
      b = 3 * (vertices[3 * i + 1] as number),
      c = 3 * (vertices[3 * i + 2] as number);
    const [p, q, r, s] = [shares[4 * i], shares[4 * i + 1], shares[4 * i + 2], shares[4 * i + 3]] as [
      number,
      number,
      number,
      number,
    ];
    let warp = 0,
      weft = 0;
    for (let axis = 0; axis < 3; ++axis) {
      const at = places[a + axis] as number,
        u = (places[b + axis] as number) - at,
        v = (places[c + axis] as number) - at;
      warp += (p * u + r * v) ** 2;
      weft += (q * u + s * v) ** 2;
    }
    warp = Math.sqrt(warp) - 1;
    weft = Math.sqrt(weft) - 1;
    strain[i] = Math.abs(warp) >= Math.abs(weft) ? warp : weft;
  }
}

/// The `count` items of the largest strain, stretched or compressed, the largest first; of those that `counts` accepts.
export function worst({ strain }: Strained, count: number, counts: (item: number) => boolean): number[] {
  const found: number[] = []; // the least of them last
  if (count < 1) return found;
  let least = -1; // once there are enough
  for (let i = 0; i < strain.length; ++i) {
    const size = Math.abs(strain[i] as number);
    if (!(size > least) || !counts(i)) continue;
    let at = found.length;
    while (at > 0 && Math.abs(strain[found[at - 1] as number] as number) < size) --at;
    found.splice(at, 0, i);
    if (found.length > count) found.pop();
    if (found.length === count) least = Math.abs(strain[found[count - 1] as number] as number);
  }
  return found;
}

/// How far the strain of something of this rest length [m] may be from that of the session, as frames have places in
/// steps of 1/65535 of their box: each end is up to half a step off along each axis.
export function strainRounding(boxExtent: readonly number[], restLength: number): number {
  return Math.hypot(...boxExtent) / 65535 / restLength;
}

/// `+12.3 %`.
export function strainText(strain: number): string {
  const percent = 100 * strain;
  return `${percent < 0 ? "−" : "+"}${Math.abs(percent).toFixed(Math.abs(percent) < 10 ? 2 : 1)} %`;
}
