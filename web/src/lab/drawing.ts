// Keeps a picture up to date with its job: it fetches the drawing again as results arrive, at most twice a second.
import type { Jobs } from "./jobs";
import type { Axis, Kind } from "./types";
import type { Picture } from "./picture";

const fetchEvery = 500; // [ms]

export class Drawing {
  text: string | null = null; ///< the SVG as the server sent it
  // names the job, axis and result to draw; the drawing is out of date while it differs from `drawn`
  private wanted = "";
  private drawn = "";
  private fetching = false;
  private fetchedAt = -Infinity;
  private timer = 0;

  constructor(
    private readonly kind: Kind,
    private readonly jobs: Jobs,
    private readonly picture: Picture,
    private readonly title: string,
    private readonly problem: (error: Error) => void,
  ) {}

  /// Asks for the drawing of the job's present result, on `axis`.
  want(result: object, axis: Axis): void {
    const { ofJob } = this.jobs.of(this.kind);
    if (ofJob === null) return; // the job is gone with the connection: the last drawing stays
    this.wanted = `${ofJob} ${axis} ${stamp(result)}`;
    this.axis = axis;
    this.schedule();
  }

  private axis: Axis = "position";

  private schedule(): void {
    if (this.timer || this.fetching || this.wanted === this.drawn) return;
    const otherAxis = this.drawn.split(" ")[1] !== this.axis; // the user chose another axis and waits for it
    const wait = otherAxis ? 0 : Math.max(0, this.fetchedAt + fetchEvery - performance.now());
    this.timer = window.setTimeout(() => void this.fetch(), wait);
  }

  private async fetch(): Promise<void> {
    this.timer = 0;
    this.fetching = true;
    this.fetchedAt = performance.now();
    const wanted = this.wanted;
    try {
      const text = await this.jobs.exported(this.kind, "svg", this.axis);
      this.text = text;
      this.picture.show(text, this.title);
    } catch (error) {
      if (this.jobs.of(this.kind).ofJob !== null) this.problem(error as Error);
    }
    this.drawn = wanted;
    this.fetching = false;
    this.schedule();
  }
}

// Numbers the results: each result that arrives is an object of its own.
const stamps = new WeakMap<object, number>();
let last = 0;
function stamp(result: object): number {
  const known = stamps.get(result) ?? ++last;
  stamps.set(result, known);
  return known;
}
