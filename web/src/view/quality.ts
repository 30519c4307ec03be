// Lowers the resolution if the machine cannot draw every frame in time, and tries a higher one later.

export interface Level {
  scale: number;
  shadow: number;
}

const levels: Level[] = [
  { scale: 1, shadow: 2048 },
  { scale: 1, shadow: 1024 },
  { scale: 0.8, shadow: 1024 },
  { scale: 0.65, shadow: 512 },
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
