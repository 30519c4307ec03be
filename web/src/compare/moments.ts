// The moments of a comparison as they come: both sides' places at 0, 1/rate, 2/rate, ... seconds.
import { floats } from "../link/arrays";
import type { MovedCollider } from "../link/scene_types";

/// The answer to `lab.moments`.
export interface MomentsAnswer {
  from: number;
  count: number;
  a: string; ///< f32 x3 per vertex and moment, little-endian, in base64
  b: string;
  moving: (MovedCollider[] | null)[];
}

/// Where a time lies: between two moments, at this share of the way from one to the next.
export interface Between {
  index: number;
  share: number; ///< [0, 1)
}

export class Moments {
  readonly a: Float32Array[] = [];
  readonly b: Float32Array[] = [];
  readonly moving: MovedCollider[][] = [];

  /// `rate`: moments a second.
  constructor(
    readonly rate: number,
    readonly vertices: number,
  ) {}

  get count(): number {
    return this.a.length;
  }

  /// The last one's time [s].
  get end(): number {
    return Math.max(0, this.count - 1) / this.rate;
  }

  /// Takes the moments that follow those that are there. Throws an Error if the answer does not follow.
  append(answer: MomentsAnswer): void {
    const [a, b] = [floats(answer.a), floats(answer.b)];
    const size = 3 * this.vertices;
    if (answer.from !== this.count || a.length !== answer.count * size || b.length !== a.length)
      throw new Error(`moments ${answer.from} to ${answer.from + answer.count} do not follow ${this.count}`);
    for (let i = 0; i < answer.count; i++) {
      this.a.push(a.subarray(i * size, (i + 1) * size));
      this.b.push(b.subarray(i * size, (i + 1) * size));
      this.moving.push(answer.moving[i] ?? []);
    }
  }

  /// Where a time lies; a time beyond the ends lies at the end.
  place(time: number): Between {
    const at = Math.min(Math.max(0, time), this.end) * this.rate;
    const nearest = Math.round(at);
    if (Math.abs(at - nearest) < 1e-6) return { index: nearest, share: 0 };
    const index = Math.floor(at);
    return { index, share: at - index };
  }

  /// The places of one side there: on the straight line between two moments.
  positions(side: "a" | "b", { index, share }: Between): Float32Array {
    const from = this[side][index] as Float32Array;
    const to = this[side][index + 1];
    if (share === 0 || !to) return from;
    return from.map((x, i) => x + share * ((to[i] as number) - x));
  }
}
