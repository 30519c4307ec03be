// The timeline: looks at the frames of the last minute again, while the session goes on, and has it go on from one of
// them. Loaded when it is opened first.
import { button, element } from "./dom";
import { takes } from "./keys";
import { notice, noticeError } from "./notices";
import { type Deed, goingOn } from "./undo";
import { longest, mostBytes, type KeptFrame } from "../link/kept_frames";
import type { Key } from "../link/scene_types";
import type { Picture } from "../picture";
import type { Transport } from "./transport";

export interface TimelineHost {
  picture: Picture;
  mayEdit(): boolean;
  resume(to: { step: number } | { undo: true }): Promise<unknown>;
  offerUndo(deed: Deed | null): void; ///< of going back
  transport: Pick<Transport, "playing" | "start">;
  keys(): Key[];
  changed(): void; ///< the card came or went
}

const megabytes = (bytes: number): string => `${(bytes / 1e6).toFixed(1)} MB`;

export class Timeline {
  private readonly card = document.createElement("section");
  private readonly range = document.createElement("input");
  private readonly marks = document.createElement("div");
  private markedAs = "";
  private readonly where = document.createElement("span");
  private readonly size = document.createElement("span");
  private readonly live = document.createElement("button");
  private readonly from = document.createElement("button");
  private frames: KeptFrame[] = []; // while one looks back: those that were there when it began
  private timer = 0;
  private closeNotice = (): void => undefined;
  private goingTo = -1; // the step that this page has the session go back to

  constructor(private readonly host: TimelineHost) {
    this.card.id = "timeline";
    this.card.className = "card timeline";
    this.card.setAttribute("aria-label", "Timeline");
    this.range.type = "range";
    this.range.min = "0";
    this.range.step = "1";
    this.range.setAttribute("aria-label", "Moment of the last minute");
    this.range.oninput = () => this.show(Number(this.range.value));
    this.live.textContent = "Live";
    this.live.onclick = () => this.goLive();
    this.from.textContent = "Go on from here";
    this.from.onclick = () => void this.resume();
    for (const each of [this.live, this.from]) each.type = "button";
    this.where.className = "timeline-where";
    this.size.className = "timeline-size";
    this.marks.className = "timeline-keys";
    this.card.append(this.marks, this.range, this.where, this.size, this.live, this.from);
    element("transport", HTMLElement).before(this.card);
    addEventListener("keydown", (event) => this.key(event), { capture: true });
    host.picture.kept.wentBack = (step) => {
      if (step !== this.goingTo) this.withdraw();
      this.goingTo = -1;
    };
    this.open(true);
  }

  toggle(): void {
    this.open(this.card.hidden);
  }

  private open(open: boolean): void {
    this.card.hidden = !open;
    document.body.classList.toggle("timeline-open", open);
    button("timeline-open").setAttribute("aria-expanded", String(open));
    clearInterval(this.timer);
    if (open) this.timer = window.setInterval(() => this.follow(), 250);
    this.goLive();
    this.host.changed();
  }

  private get looksBack(): boolean {
    return this.frames.length > 0;
  }

  private goLive(): void {
    this.frames = [];
    this.host.picture.lookAt(null);
    this.follow();
  }

  /// While the picture is live the bar grows with what comes.
  private follow(): void {
    const { kept } = this.host.picture;
    const all = this.looksBack ? this.frames : kept.all;
    if (!this.looksBack) {
      this.range.max = String(Math.max(0, all.length - 1));
      this.range.value = this.range.max;
    }
    this.live.disabled = !this.looksBack;
    this.from.disabled = !this.looksBack || !this.host.mayEdit();
    const seconds = all.length > 0 ? ((all.at(-1) as KeptFrame).at - (all[0] as KeptFrame).at) / 1000 : 0;
    this.size.textContent = `${seconds.toFixed(0)} s, ${megabytes(kept.bytes)}`;
    this.size.title = `Kept in this page: the last ${longest / 1000} s, at most ${megabytes(mostBytes)}`;
    if (!this.looksBack) this.tell(all.at(-1), "live");
    this.mark(all);
  }

  /// Marks where the scene's keyframes are among the frames.
  private mark(frames: KeptFrame[]): void {
    const timeAt = (index: number): number => frames[index]?.frame.header.time ?? Number.NaN;
    const first = timeAt(0),
      last = timeAt(frames.length - 1);
    const marks = this.host.keys().flatMap(({ of, at }) =>
      at
        .filter(([time]) => time >= first && time <= last)
        .map(([time]) => {
          const index = frames.findIndex(({ frame }) => frame.header.time >= time);
          return { share: index / Math.max(1, frames.length - 1), says: `${of} at ${time} s` };
        }),
    );
    const now = JSON.stringify(marks);
    if (now === this.markedAs) return;
    this.markedAs = now;
    this.marks.replaceChildren(
      ...marks.map(({ share, says }) => {
        const mark = document.createElement("span");
        mark.style.setProperty("--share", share.toFixed(4));
        mark.title = says;
        return mark;
      }),
    );
  }

  private show(index: number): void {
    if (!this.looksBack) this.frames = this.host.picture.kept.all;
    const at = Math.min(Math.max(0, index), this.frames.length - 1);
    const shown = this.frames[at];
    if (!shown) return;
    this.range.max = String(this.frames.length - 1);
    this.range.value = String(at);
    this.host.picture.lookAt(shown.frame);
    const ago = (performance.now() - shown.at) / 1000;
    this.tell(shown, `${ago.toFixed(1)} s ago`);
    this.follow();
  }

  private tell(shown: KeptFrame | undefined, when: string): void {
    const header = shown?.frame.header;
    const text = header ? `${header.time.toFixed(3)} s, ${when}` : when;
    if (this.where.textContent !== text) this.where.textContent = text;
    this.range.setAttribute("aria-valuetext", header ? `${text}, step ${header.step}` : text);
  }

  private key(event: KeyboardEvent): void {
    if (this.card.hidden || event.ctrlKey || event.metaKey || event.altKey) return;
    if (document.querySelector("dialog[open]") || takes(event.target, event.key)) return;
    const by = { ",": -1, ".": 1 }[event.key];
    if (by === undefined ? event.key !== "Escape" || !this.looksBack : by > 0 && !this.looksBack) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    if (by === undefined) this.goLive();
    else this.show(Number(this.range.value) + by);
  }

  private async resume(): Promise<void> {
    const shown = this.frames[Number(this.range.value)];
    if (!shown) return;
    const { step, time } = shown.frame.header;
    const left = this.host.picture.kept.all;
    const until = left.at(-1)?.frame.header.time ?? time;
    const { playing } = this.host.transport;
    this.from.disabled = true;
    this.goingTo = step;
    try {
      await this.host.resume({ step });
      this.goLive();
      this.withdraw();
      const undo = (): void => this.undo(left, playing);
      this.host.offerUndo({ name: `${goingOn} ${time.toFixed(2)} s`, undo });
      this.closeNotice = notice("info", {
        title: `Back at ${time.toFixed(3)} s`,
        lines: ["Paused there. Play goes on from it."],
        actions: [{ label: `Undo: to ${until.toFixed(3)} s`, run: undo }],
        stays: true,
      });
    } catch (error) {
      this.goingTo = -1;
      this.follow();
      noticeError("Not gone back", error as Error);
    }
  }

  // The server undoes the last going back alone, whoever went.
  private withdraw(): void {
    this.closeNotice();
    this.host.offerUndo(null);
  }

  // The frames that were left come back with the run.
  private undo(left: KeptFrame[], play: boolean): void {
    this.withdraw();
    this.host.resume({ undo: true }).then(
      () => {
        this.host.picture.kept.restore(left);
        this.goLive();
        if (play) this.host.transport.start();
      },
      (error: Error) => noticeError("Not undone", error),
    );
  }
}
