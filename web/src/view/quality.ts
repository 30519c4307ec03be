// Lowers the resolution and the mesh's fineness if the machine cannot draw every frame in time, and tries higher ones
// later.

/// Of a finer mesh in a picture at rest, which takes its time.
export const stillTriangles = 25_000;

export interface Level {
  scale: number; ///< of the picture
  triangles: number; ///< at most so many of a finer mesh; a cloth of more is drawn as it came
  details: boolean; ///< uneven threads and seams, which a software renderer takes long for
}

const levels: Level[] = [
  { scale: 1, triangles: 40_000, details: true },
  { scale: 1, triangles: 13_000, details: false },
  { scale: 0.8, triangles: 13_000, details: false },
  { scale: 0.65, triangles: 5_000, details: false },
];
const tooSlow = 34; // [ms] between drawn frames: below 30 frames/s
const fastEnough = 20; // [ms]
const patience = 20; // frames between decisions

export class Quality {
  private index: number;
  private average = 16;
  private samples = 0;
  private calmUntilRise = 600; // frames; doubles whenever a higher resolution proves too slow
  private calm = 0;

  constructor(
    private readonly changed: (level: Level) => void,
    startIndex: number,
  ) {
    this.index = startIndex;
  }

  get level(): Level {
    return levels[this.index] as Level;
  }

  /// Takes the time [ms] between two drawn frames.
  sample(milliseconds: number): void {
    if (milliseconds > 1500) return; // a pause, not a slow frame
    this.average += 0.1 * (Math.min(milliseconds, 200) - this.average);
    this.calm = this.average < fastEnough ? this.calm + 1 : 0;
    if (++this.samples < patience) return;
    if (this.average > tooSlow && this.index < levels.length - 1) {
      if (this.calm === 0) this.calmUntilRise *= 2;
      this.move(1);
    } else if (this.calm > this.calmUntilRise && this.index > 0) {
      this.move(-1);
    }
  }

  private move(by: number): void {
    this.index += by;
    this.samples = this.calm = 0;
    this.average = 24;
    this.changed(this.level);
  }
}
