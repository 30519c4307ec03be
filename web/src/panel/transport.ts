// Play, pause, step, reset and speed: the buttons, and the state that the server reports.
import { button, element } from "./dom";
import type { Status } from "./hud";

export interface TransportEvents {
  request(method: string, params?: Record<string, unknown>): void;
}

export class Transport {
  playing = true;
  private readonly play = button("play");
  private readonly speed = element("speed", HTMLSelectElement);
  // until then a status may be older than this page's request and would flip the button back
  private readonly holdUntil = { playing: 0, speed: 0 };

  constructor(private readonly events: TransportEvents) {
    this.play.onclick = () => this.toggle();
    button("step").onclick = () => this.step();
    button("reset").onclick = () => this.reset();
    this.speed.onchange = () => {
      this.holdUntil.speed = performance.now() + 400;
      this.events.request("sim.speed", { factor: Number(this.speed.value) });
    };
    this.show();
  }

  enable(enabled: boolean): void {
    for (const control of [this.play, button("step"), button("reset"), this.speed]) control.disabled = !enabled;
  }

  toggle(): void {
    this.events.request(this.playing ? "sim.pause" : "sim.play");
    this.assume(!this.playing);
  }

  start(): void {
    if (!this.playing) this.toggle();
  }

  stop(): void {
    if (this.playing) this.toggle();
  }

  step(): void {
    this.events.request("sim.step", { steps: 1 });
    this.assume(false);
  }

  reset(): void {
    this.events.request("sim.reset");
  }

  status(status: Status): void {
    const now = performance.now();
    if (status.playing !== undefined && now > this.holdUntil.playing && status.playing !== this.playing) {
      this.playing = status.playing;
      this.show();
    }
    if (status.speed !== undefined && now > this.holdUntil.speed) this.showSpeed(status.speed);
  }

  private assume(playing: boolean): void {
    this.playing = playing;
    this.holdUntil.playing = performance.now() + 400;
    this.show();
  }

  private show(): void {
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
