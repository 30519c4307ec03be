// Plays a recording: the frame that is due, read ahead of its time, on the page's own stage.
import { hook } from "../test_hook";
import type { Stage } from "../view/stage";
import { readGroup, type Group, type Moment, type Recording, type Setting } from "./recording";
import { Shower } from "./show";

interface PlayerEvents {
  shown(frame: number, moment: Moment, range: number): void;
  playing(playing: boolean): void;
  failed(error: unknown): void;
}

export class Player {
  strained = false; ///< coloured by strain
  private readonly shower = new Shower();
  private readonly read = new Map<Group, Promise<Moment[]> | Moment[]>(); // the group on screen and the next
  private setting: Setting | null = null;
  private position = 0; // frame, with the part of the time to the next one that has passed
  private lastTick = 0;
  private running = false;
  private stale = true; // what is on screen is not the frame at `position`

  constructor(
    private readonly recording: Recording,
    private readonly stage: Stage,
    private readonly events: PlayerEvents,
  ) {
    const animate = (now: number): void => {
      requestAnimationFrame(animate);
      this.tick(now);
      stage.draw();
    };
    requestAnimationFrame(animate);
  }

  get playing(): boolean {
    return this.running;
  }

  get frame(): number {
    return Math.floor(this.position);
  }

  /// Of the frame, since the recording began [s].
  get time(): number {
    return this.frame / this.recording.rate;
  }

  /// Plays or stops; from the end it plays anew.
  play(playing: boolean): void {
    if (playing && this.frame >= this.recording.frames - 1) this.seek(0);
    this.running = playing;
    this.events.playing(playing);
  }

  seek(frame: number): void {
    this.position = Math.min(Math.max(0, frame), this.recording.frames - 1);
    this.stale = true;
  }

  /// Shows the frame again: what it shows has changed.
  again(): void {
    this.stale = true;
  }

  private tick(now: number): void {
    const passed = Math.min(now - this.lastTick, 250) / 1000;
    this.lastTick = now;
    const group = this.groupAt(this.frame);
    const moments = group && this.moments(group);
    if (!group || !moments) return; // it is being read: time waits for it
    if (this.running && !this.stale) this.advance(passed * this.recording.rate);
    const next = this.groupAt(group.first + group.count);
    if (next) this.moments(next);
    for (const known of this.read.keys()) if (known !== group && known !== next) this.read.delete(known);
    if (!this.stale || this.frame < group.first || this.frame >= group.first + group.count) return;
    const moment = moments[this.frame - group.first];
    if (moment) this.show(moment, group.setting);
  }

  private advance(frames: number): void {
    const before = this.frame;
    this.position = Math.min(this.position + frames, this.recording.frames - 1);
    if (this.frame !== before) this.stale = true;
    if (this.position >= this.recording.frames - 1) this.play(false);
  }

  private show(moment: Moment, setting: Setting): void {
    const { stage } = this;
    this.stale = false;
    if (setting !== this.setting) {
      const first = this.setting === null;
      if (setting.topology !== this.setting?.topology) stage.setTopology(setting.topology);
      stage.setDocument(setting.document, first);
      hook.document = setting.document;
      this.setting = setting;
    }
    const shown = this.shower.frame(moment, setting, this.frame, this.strained);
    stage.show(shown);
    hook.lastFrame = shown;
    hook.simTime = moment.time;
    hook.step = moment.step;
    hook.framesDrawn++;
    this.events.shown(this.frame, moment, shown.header.range);
  }

  private groupAt(frame: number): Group | undefined {
    return this.recording.groups.find(({ first, count }) => frame >= first && frame < first + count);
  }

  /// The group's frames; null while they are being read.
  private moments(group: Group): Moment[] | null {
    const known = this.read.get(group);
    if (Array.isArray(known)) return known;
    if (!known) {
      const reading = readGroup(group);
      this.read.set(group, reading);
      reading.then(
        (moments) => this.read.has(group) && this.read.set(group, moments),
        (error: unknown) => this.events.failed(error),
      );
    }
    return null;
  }
}
