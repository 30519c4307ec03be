// Play, pause, step, reset and speed: the buttons, and the state that the server reports.
import { button, element } from "./dom";
import type { Status } from "./hud";

export interface TransportEvents {
  /// Settles once the server has answered, also if it refuses.
  request(method: string, params?: Record<string, unknown>): Promise<void>;
}

export class Transport {
  playing = true;
  asked = 0; ///< how often playing or not has been asked for here
  private readonly play = button("play");
  private readonly speed = element("speed", HTMLSelectElement);
  // This page's requests that the server has not answered: a status that comes before may be older than they are.
  private readonly unanswered = { playing: 0, speed: 0 };

  constructor(private readonly events: TransportEvents) {
    this.play.onclick = () => this.toggle();
    button("step").onclick = () => this.step();
    button("reset").onclick = () => this.reset();
    this.speed.onchange = () => {
      this.ask("speed", "sim.speed", { factor: Number(this.speed.value) });
    };
    this.show(true);
  }

  enable(enabled: boolean): void {
    for (const control of [this.play, button("step"), button("reset"), this.speed]) control.disabled = !enabled;
  }

  toggle(): void {
    if (this.playing) this.stop();
    else this.start();
  }

  start(): void {
    this.ask("playing", "sim.play");
    this.show(true);
  }

  stop(): void {
    this.ask("playing", "sim.pause");
    this.show(false);
  }

  step(): void {
    this.ask("playing", "sim.step", { steps: 1 });
    this.show(false);
  }

  reset(): void {
    void this.events.request("sim.reset");
  }

  status({ playing, speed }: Status): void {
    if (playing !== undefined && playing !== this.playing && this.unanswered.playing === 0) this.show(playing);
    if (speed !== undefined && this.unanswered.speed === 0) this.showSpeed(speed);
  }

  private ask(what: "playing" | "speed", method: string, params?: Record<string, unknown>): void {
    if (what === "playing") ++this.asked;
    ++this.unanswered[what];
    void this.events.request(method, params).then(() => --this.unanswered[what]);
  }

  private show(playing: boolean): void {
    this.playing = playing;
    this.play.dataset.playing = String(this.playing);
    this.play.setAttribute("aria-label", this.playing ? "Pause" : "Play");
  }

  // Shows a speed. Another viewer may have set one that is not in the list.
  private showSpeed(factor: number): void {
    if (Number(this.speed.value) === factor) return;
    if (![...this.speed.options].some((option) => Number(option.value) === factor)) {
      this.speed.add(new Option(`×${Number(factor.toPrecision(3))}`, String(factor)));
    }
    this.speed.value = String(factor);
  }
}
