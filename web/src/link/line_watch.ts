// Finds out whether the line to the server is what keeps pictures back, so that frames had better be compressed.

const askedRate = 60; // frames a second
const tooFew = 0.7; // of the frames that the page could draw
const longAnswer = 40; // [ms] of a ping: frames before it fill the line
const slowSeconds = 3; // in a row, until the line is taken for slow

/// Of about a second.
export interface Second {
  pictures: number; ///< that the page could have drawn: a busy page draws few, and more frames would not help it
  frames: number; ///< that came
  latency: number; ///< of the last ping [ms]
  steps: boolean; ///< the session plays, does not sleep, and keeps up: it has new frames to send
}

export class LineWatch {
  private slow = 0; // seconds in a row

  /// True: the line has been slow for some seconds.
  second({ pictures, frames, latency, steps }: Second): boolean {
    const few = frames < tooFew * Math.min(pictures, askedRate);
    this.slow = steps && few && latency > longAnswer ? this.slow + 1 : 0;
    return this.slow >= slowSeconds;
  }
}
