// Shows a bar while the scene is too much for the server: the simulation is slow, or no picture comes. A button in it
// undoes the scene's last change.
import { button, element } from "./dom";
import type { Status } from "./hud";

const creeping = 0.1; // share of the speed asked for: nobody sees a slower motion
const creepingFor = 3000; // [ms] before the bar appears: compiling a kernel takes a while too
const noPictureFor = 2000; // [ms]
const lookEvery = 250; // [ms]

export class SlowWatch {
  dt = 0; ///< time step of the scene [s]
  private status: Status = {};
  private pictureAt = performance.now();
  private fastAt = performance.now();
  private open = false;
  private undoes: string | null = null; // the name of the change that Undo undoes
  private readonly box = element("slow", HTMLElement);
  private readonly text = element("slow-text", HTMLElement);
  private readonly undo = button("slow-undo");

  constructor(undo: () => void) {
    this.undo.onclick = undo;
    document.addEventListener("visibilitychange", () => this.startAgain()); // a hidden page gets no pictures
    setInterval(() => this.look(), lookEvery);
  }

  link(open: boolean): void {
    this.open = open;
    this.startAgain();
  }

  picture(): void {
    this.pictureAt = performance.now();
  }

  /// Takes the name of the last change of the scene; null: there is none to undo.
  changed(undoes: string | null): void {
    this.undoes = undoes;
  }

  told(status: Status): void {
    if (status.playing !== this.status.playing) this.startAgain();
    this.status = status;
    if ((status.real_time_factor ?? 1) >= creeping * (this.status.speed ?? 1)) this.fastAt = performance.now();
  }

  private startAgain(): void {
    this.pictureAt = this.fastAt = performance.now();
  }

  private look(): void {
    const said = this.say();
    document.body.classList.toggle("slow", said !== "");
    this.box.hidden = said === "";
    if (this.text.textContent !== said) this.text.textContent = said;
    this.undo.hidden = this.undoes === null;
    this.undo.title = `Undo: ${this.undoes}`;
  }

  private say(): string {
    const { playing, asleep, diverged, real_time_factor: factor = 0 } = this.status;
    if (!this.open || document.hidden || playing !== true || asleep || diverged) return "";
    const now = performance.now();
    const still = now - this.pictureAt;
    const why = `this scene is too much for the server${this.aStep(factor)}. Make it smaller, or undo.`;
    if (still > noPictureFor) return `No new picture for ${Math.floor(still / 1000)} s: ${why}`;
    if (now - this.fastAt > creepingFor) return `Only ×${Number(factor.toPrecision(2))} of real time: ${why}`;
    return "";
  }

  // How long a step takes, as text, by the server's last status.
  private aStep(factor: number): string {
    const seconds = factor > 0 ? this.dt / factor : 0;
    return seconds >= 0.01 ? `, a step takes it ${Number(seconds.toPrecision(2))} s` : "";
  }
}
