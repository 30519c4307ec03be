// A blow-up as a show. The session stands still; steps are taken until it blows up; it goes back, and the last steps
// are taken once more, one by one, with the cloth and its energy after each. Then they are played at a tenth of the
// speed, coloured by the mode that grows, beside the energy. All of it is what the session computes: a session that
// goes back computes the same again, bit for bit.
import { ShowCard } from "./card";
import type { Cause, ShowHost } from "./door";
import { coloured } from "./growth";
import type { Frame, ShownFrame } from "../link/protocol";
import type { Operation, SceneDocument } from "../link/scene_types";
import type { Status } from "../panel/hud";
import { type Diverged, notice } from "../panel/notices";

const stepsAtOnce = 32; // while the blow-up is looked for
const stepsBetween = 128; // before the cause is asked for more: explicit Euler grows by less than 1 % in a step
const mostSeconds = 20; // of looking for it
const before = 28; // moments from the first that is shown to the last good one
const most = 80; // moments
const slower = 10; // times
const patience = 3000; // [ms] for a moment's frame and energy

interface Moment {
  step: number;
  time: number; // [s]
  energy: number; // [J]
  frame: ShownFrame;
}

interface Where {
  step: number;
  time: number;
}

export class Show {
  private readonly card = new ShowCard({
    seek: (index) => this.still(index),
    again: () => this.play(),
    remedy: () => void this.mend(),
    close: () => this.close(),
    resized: () => this.host.changed(),
  });
  private latest: Frame | null = null;
  private told: Status = {};
  private blown: Diverged | null = null; // since the session last went back
  private first: Diverged | null = null; // as it was told first
  private moments: Moment[] = [];
  private waiting: (() => void)[] = [];
  private closed = false;
  private animation = 0;
  private mended = false;
  private presented = false;
  private stride = 1; // steps between moments

  constructor(
    private readonly host: ShowHost,
    private readonly gone: () => void,
  ) {}

  async run(cause: Cause): Promise<void> {
    this.host.opened();
    document.body.classList.add("showing");
    this.card.say("Looking for the step at which it fails …");
    try {
      const from = cause.failed ? await this.earlier() : await this.provoke(cause);
      if (this.closed) return;
      if (from === null) {
        this.holds();
        return;
      }
      await this.gather(from, cause.failed ?? (await this.scene()));
      if (!this.closed) this.present();
    } catch (error) {
      this.close();
      throw error;
    }
  }

  frame(frame: Frame): void {
    this.latest = frame;
    this.wake();
  }

  status(status: Status): void {
    this.told = status;
    this.wake();
    if (this.moments.length > 0 && this.presented && status.diverged === false) this.close(); // somebody has mended it
  }

  diverged(diverged: Diverged): void {
    this.blown = diverged;
    this.first ??= diverged;
    this.wake();
  }

  close(): void {
    if (this.closed) return;
    this.closed = true;
    cancelAnimationFrame(this.animation);
    this.host.picture.lookAt(null);
    this.card.remove();
    document.body.classList.remove("showing");
    this.wake();
    this.gone();
    this.host.changed();
    this.host.ended(this.mended || this.told.diverged === false ? null : (this.blown ?? this.first));
  }

  /// Has it blow up, and returns from which step on it is looked at again; null: it has held.
  private async provoke({ apply, more }: Cause): Promise<number | null> {
    await this.host.request("sim.pause");
    await apply(() => this.limit());
    let start = (await this.presentStep()).step;
    const until = performance.now() + 1000 * mostSeconds;
    for (let steps = 0; !this.blown && !this.closed && performance.now() < until; steps += stepsAtOnce) {
      if (more && steps === stepsBetween) {
        await more();
        start = (await this.presentStep()).step;
        steps = 0;
      }
      await this.step(stepsAtOnce);
    }
    if (!this.blown) return null;
    const good = (await this.presentStep()).step;
    this.stride = Math.max(1, Math.floor((good - start) / 2 / before));
    return Math.min(good, Math.max(start, good - before * this.stride));
  }

  /// Of a session that has blown up already.
  private async earlier(): Promise<number> {
    const { oldest, newest } = await this.host.request<{ oldest: Where; newest: Where }>("timeline.get");
    return Math.max(oldest.step, newest.step - before);
  }

  private async presentStep(): Promise<Where> {
    return (await this.host.request<{ newest: Where }>("timeline.get")).newest;
  }

  private async scene(): Promise<SceneDocument> {
    return (await this.host.request<{ document: SceneDocument }>("scene.get")).document;
  }

  /// Null: it has blown up.
  private async step(steps: number): Promise<Where | null> {
    try {
      return await this.host.request<Where>("sim.step", { steps });
    } catch (error) {
      await this.until(() => this.blown !== null);
      if (!this.blown) throw error;
      return null;
    }
  }

  /// Goes back, and takes the steps again until it blows up.
  private async gather(from: number, failed: SceneDocument): Promise<void> {
    this.blown = null;
    await this.host.request("timeline.resume", { step: from });
    if (JSON.stringify(await this.scene()) !== JSON.stringify(failed)) {
      // What made it fail came later than the step gone back to.
      const whole: Operation[] = [{ op: "replace", path: "", value: failed }];
      await this.host.request("scene.patch", { patch: whole, name: "Blow up again" });
    }
    let at: Where | null = { step: from, time: 0 };
    while (at && this.moments.length < most && !this.closed) {
      await this.take(at.step);
      this.card.say(`Taking the last steps one by one: ${this.moments.length} …`);
      if (this.blown) break;
      at = await this.step(this.stride);
    }
  }

  /// Keeps the cloth and its energy after a step.
  private async take(step: number): Promise<void> {
    const here = (): boolean => this.latest?.header.step === step && this.told.step === step;
    await this.until(() => here() || this.blown !== null);
    const { latest, told } = this;
    if (!here() || !latest || !told.energy || latest.header.step === this.moments.at(-1)?.step) return;
    const elastic = ((this.blown ?? this.first)?.energy?.elastic ?? true) ? told.energy.elastic : 0;
    this.moments.push({
      step,
      time: latest.header.time,
      energy: told.energy.kinetic + elastic,
      frame: { ...latest, field: null, moved: this.host.picture.moved },
    });
  }

  /// The longest stable step of the scene as it is now [s]; 0 if none is stable.
  private async limit(): Promise<number> {
    const known = (): number | null | undefined => this.told.stability?.dt_limit;
    await this.until(() => typeof known() === "number");
    const found = known();
    if (typeof found !== "number") throw new Error("The server knows no longest stable time step of this scene.");
    return found;
  }

  private holds(): void {
    this.card.say(
      `It has held for ${mostSeconds} s of stepping from here. The lab's trial began at the scene's start: ` +
        "Reset, and let it play.",
    );
  }

  private present(): void {
    const diverged = this.blown ?? this.first;
    if (!diverged || this.moments.length < 3) {
      this.close();
      return;
    }
    this.presented = true;
    const frames = coloured(this.moments.map(({ frame }) => frame));
    frames.forEach((frame, i) => ((this.moments[i] as Moment).frame = frame));
    const began = (this.moments[0] as Moment).time;
    const { allowed = null, found = null, time = null } = diverged.energy ?? {};
    const times = this.moments.map(({ time: at }) => 1000 * (at - began));
    const energy = this.moments.map((moment) => moment.energy);
    if (found !== null && time !== null && 1000 * (time - began) > (times.at(-1) as number)) {
      times.push(1000 * (time - began));
      energy.push(found);
    }
    this.card.present(diverged, { milliseconds: times, energy, allowed }, this.moments.length);
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) this.still(this.moments.length - 1);
    else this.play();
  }

  private play(): void {
    cancelAnimationFrame(this.animation);
    const began = performance.now();
    const first = (this.moments[0] as Moment).time;
    const next = (): void => {
      const time = first + (performance.now() - began) / 1000 / slower;
      const after = this.moments.findIndex((moment) => moment.time > time);
      this.look(after < 0 ? this.moments.length - 1 : Math.max(0, after - 1));
      if (after >= 0 && !this.closed) this.animation = requestAnimationFrame(next);
    };
    next();
  }

  private still(index: number): void {
    cancelAnimationFrame(this.animation);
    this.look(index);
  }

  private look(index: number): void {
    const moment = this.moments[index];
    if (!moment) return;
    this.host.picture.lookAt(moment.frame);
    this.card.at(index, 1000 * (moment.time - (this.moments[0] as Moment).time), moment.step);
  }

  private async mend(): Promise<void> {
    const diverged = this.blown ?? this.first;
    if (!diverged) return;
    try {
      this.mended = true;
      await this.host.remedy(diverged);
      this.close();
      this.host.play();
    } catch (error) {
      this.mended = false;
      notice("error", { title: "The remedy was refused", lines: [(error as Error).message] });
    }
  }

  private wake(): void {
    for (const each of this.waiting) each();
  }

  /// Waits until something is so that is told by a frame, a status or a blow-up, but not for ever.
  private until(so: () => boolean): Promise<void> {
    return new Promise((resolve) => {
      const look = (): void => {
        if (!so() && !this.closed) return;
        clearTimeout(timer);
        this.waiting = this.waiting.filter((each) => each !== look);
        resolve();
      };
      const timer = setTimeout(() => {
        this.waiting = this.waiting.filter((each) => each !== look);
        resolve();
      }, patience);
      this.waiting.push(look);
      look();
    });
  }
}
