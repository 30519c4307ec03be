// Shows a bar while the scene is too much for the server: the simulation is slow, or no picture comes. It is the page's
// only message of that, and has the one thing to do: undo the scene's last change, or make the cloth coarser, or else
// ask the lab for a faster setting.
import { button, element } from "./dom";
import type { Operation } from "../link/scene_types";
import type { Status } from "./hud";

const creeping = 0.5; // share of the speed asked for; more than that the figures alone tell
const creepingFor = 3000; // [ms] before the bar appears: compiling a kernel takes a while too
const noPictureFor = 2000; // [ms]
const lookEvery = 250; // [ms]

export interface SlowHost {
  mayEdit(): boolean;
  undo(): void;
  coarser(): Operation[] | null; ///< that give every grid half the rows and columns; null: no grid is large enough
  edit(operations: Operation[]): void;
  lab(): void;
}

export class SlowWatch {
  dt = 0; ///< time step of the scene [s]
  private status: Status = {};
  private pictureAt = performance.now();
  private fastAt = performance.now();
  private open = false;
  private undoes: string | null = null; // the name of the change that Undo undoes
  private readonly box = element("slow", HTMLElement);
  private readonly text = element("slow-text", HTMLElement);
  private readonly act = button("slow-act");

  constructor(private readonly host: SlowHost) {
    this.act.onclick = () => this.remedy().run();
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
    const { label, title } = this.remedy();
    if (this.act.textContent !== label) this.act.textContent = label;
    this.act.title = title;
    this.act.hidden = !this.host.mayEdit();
  }

  private remedy(): { label: string; title: string; run(): void } {
    if (this.undoes !== null)
      return { label: "Undo", title: `Undo the scene's last change: ${this.undoes}`, run: () => this.host.undo() };
    const coarser = this.host.coarser();
    if (coarser)
      return { label: "Coarser cloth", title: "Half the rows and columns", run: () => this.host.edit(coarser) };
    return { label: "Ask the lab", title: "Measure which setting is fast enough", run: () => this.host.lab() };
  }

  private say(): string {
    const { playing, asleep, diverged, real_time_factor: factor = 0 } = this.status;
    if (!this.open || document.hidden || playing !== true || asleep || diverged) return "";
    const now = performance.now();
    const still = now - this.pictureAt;
    const why = `this scene is too much for the server${this.aStep(factor)}.`;
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
