// Plays the moments of a comparison: both sides have the same time, and stand still together.
import { labelled, make, makeButton, makeSelect } from "../lab/dom";

interface PlayerEvents {
  drawn(time: number): void; ///< shows this time [s]
}

export class Player {
  readonly element = make("div", "compare-player");
  private readonly button = makeButton("Pause", "lab-small", () => this.toggle());
  private readonly slider = make("input");
  private readonly where = make("span", "compare-where");
  private readonly speed = makeSelect(
    [
      ["0.1", "×0.1"],
      ["0.25", "×0.25"],
      ["1", "×1"],
      ["4", "×4"],
    ],
    "1",
  );
  private time = 0;
  private end = 0; // [s], of what is there
  private rate = 25; // moments a second
  private complete = false; // no more comes
  private playing = false;
  private last = 0; // [ms]
  private request = 0;

  constructor(private readonly events: PlayerEvents) {
    this.slider.type = "range";
    this.slider.min = "0";
    this.slider.step = "1";
    this.slider.setAttribute("aria-label", "Moment");
    this.slider.oninput = () => this.go(Number(this.slider.value) / this.rate);
    const restart = makeButton("Restart", "lab-small", () => this.restart());
    restart.title = "Both from the start (R)";
    this.button.title = "Both (Space)";
    this.speed.setAttribute("aria-label", "Speed of the comparison");
    this.element.append(
      this.slider,
      this.button,
      restart,
      labelled("speed", this.speed, "simulated time against real time"),
      this.where,
    );
  }

  /// Moments up to this time [s] are there.
  reach(end: number, rate: number, complete: boolean): void {
    this.end = end;
    this.rate = rate;
    this.complete = complete;
    this.slider.max = String(Math.round(end * rate));
    this.tell();
  }

  restart(): void {
    this.time = 0;
    this.play(true);
    this.draw();
  }

  stop(): void {
    this.play(false);
  }

  toggle(): void {
    if (!this.playing && this.complete && this.time >= this.end) this.restart();
    else this.play(!this.playing);
  }

  /// Stands still at the moment nearest to this time [s].
  go(time: number): void {
    this.play(false);
    this.time = Math.min(Math.max(0, Math.round(time * this.rate) / this.rate), this.end);
    this.draw();
  }

  move(by: number): void {
    this.go(this.time + by / this.rate);
  }

  private play(playing: boolean): void {
    this.playing = playing;
    cancelAnimationFrame(this.request);
    this.last = performance.now();
    if (playing) this.request = requestAnimationFrame((now) => this.tick(now));
    this.tell();
  }

  // At the end of what is there it waits for more, or stops.
  private tick(now: number): void {
    const passed = Math.min(Math.max(0, now - this.last), 100) / 1000;
    this.last = now;
    const before = this.time;
    this.time = Math.min(this.end, this.time + passed * Number(this.speed.value));
    if (this.time !== before) this.draw();
    if (this.complete && this.time >= this.end) this.play(false);
    else this.request = requestAnimationFrame((next) => this.tick(next));
  }

  private draw(): void {
    this.events.drawn(this.time);
    this.tell();
  }

  private tell(): void {
    this.slider.value = String(Math.round(this.time * this.rate));
    this.button.textContent = this.playing ? "Pause" : "Play";
    const text = `${this.time.toFixed(2)} of ${this.end.toFixed(2)} s`;
    if (this.where.textContent !== text) this.where.textContent = text;
    this.slider.setAttribute("aria-valuetext", text);
  }
}
