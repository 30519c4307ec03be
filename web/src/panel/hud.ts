// The card with figures: what is drawn, what arrives, how the simulation keeps up, and which passes run.
import { element } from "./dom";
import { reading, type Stability } from "./gauge";
import type { RecordingFacts } from "./record_button";

/// Notification `sim.status`; every part may be missing.
export interface Status {
  playing?: boolean;
  time?: number;
  step?: number;
  speed?: number;
  real_time_factor?: number;
  energy?: { kinetic: number; elastic: number; gravitational: number };
  max_strain?: number;
  max_speed?: number;
  contacts?: number;
  memory_bytes?: number;
  surface?: { pairs: number; cuts: number; not_taken: number; searches: number } | null;
  asleep?: boolean;
  recording?: RecordingFacts;
  diverged?: boolean;
  stability?: Stability | null;
  passes?: string[];
  terms?: string[];
  skipped?: { name: string; reason: string }[];
  pass_seconds?: Record<string, number>;
}

/// The session has new frames to send, as fast as they are asked for.
export const keepsUp = ({ playing, asleep, real_time_factor: factor = 1, speed = 1 }: Status): boolean =>
  playing === true && !asleep && factor >= 0.9 * speed;

const rows = [
  ["drawn", "Drawn", "frames this page draws each second"],
  ["received", "Received", "frames that arrive each second"],
  ["time", "Simulated", "simulated time"],
  ["rtf", "Real time", "simulated seconds a second takes; ×1.00 keeps up"],
  ["latency", "Latency", "round trip of a message to the server"],
  ["rate", "Data", "everything received, a second"],
  ["strain", "Strain", "largest stretch of any spring"],
  ["contacts", "Contacts", "vertices that touch something"],
  ["surface", "Surface", "pairs of edges and triangles that can meet, and steps of vertices that were cut short"],
  ["vertices", "Vertices", "vertices of all cloths"],
  ["memory", "Memory", "what the session takes of the memory that its server computes in"],
  ["viewers", "Viewers", "pages and scripts that watch this session"],
  ["renderer", "Server", "what the server computes on"],
  ["version", "Version", "of Clothlab on the server"],
] as const;
type Row = (typeof rows)[number][0];

/// ×1.00; ×0.004: a slow simulation must not read as 0.
const factorText = (factor: number): string =>
  `×${factor >= 0.1 || factor === 0 ? factor.toFixed(2) : factor.toPrecision(1)}`;

const megabytes = (bytes: number): string => `${Number((bytes / 1e6).toPrecision(bytes < 1e9 ? 2 : 3))} MB`;
const compact = new Intl.NumberFormat("en", { notation: "compact" });
const short = (count: number): string => compact.format(count);

export class Hud {
  private readonly cells = new Map<Row, HTMLElement>();
  private drawn = 0;
  private received = 0;
  private bytes = 0;
  private since = performance.now();
  private passes = "";
  private readonly passTimes = new Map<string, HTMLElement>();
  private passSeconds: Record<string, number> = {};
  private timeShownAt = 0;
  private stability: Stability | null = null;
  dt = 0; ///< time step of the scene [s]

  constructor() {
    const list = element("stats", HTMLDListElement);
    for (const [key, label, title] of rows) {
      const row = document.createElement("div");
      row.title = title;
      const name = document.createElement("dt");
      name.textContent = label;
      const value = document.createElement("dd");
      value.className = key;
      value.textContent = "–";
      row.append(name, value);
      list.append(row);
      this.cells.set(key, value);
    }
    this.showSurface(null);
  }

  set(row: Row, text: string): void {
    const cell = this.cells.get(row);
    if (cell && cell.textContent !== text) cell.textContent = text;
  }

  /// Sets a row's tooltip.
  explain(row: Row, title: string): void {
    const line = this.cells.get(row)?.parentElement;
    if (line) line.title = title;
  }

  /// Shows the renderer's name without versions and buses; the tooltip has all of it.
  setRenderer(name: string): void {
    this.set("renderer", name.split(/ \(|\//)[0] ?? name);
    const cell = this.cells.get("renderer");
    if (cell) cell.title = name;
  }

  countDrawn(): void {
    this.drawn++;
  }
  countReceived(): void {
    this.received++;
  }

  /// Shows the time ten times a second at most: that is enough to read, and repainting costs a slow machine a frame.
  setTime(seconds: number): void {
    const now = performance.now();
    if (now - this.timeShownAt < 100) return;
    this.timeShownAt = now;
    this.showTime(seconds);
  }

  private showTime(seconds: number): void {
    this.set("time", `${seconds.toFixed(2)} s`);
  }

  showStatus(status: Status): void {
    // the last frame may have come too soon after another to be shown
    if (status.playing === false && status.time !== undefined) this.showTime(status.time);
    if (status.real_time_factor !== undefined) {
      const text = status.playing === false ? "paused" : factorText(status.real_time_factor);
      this.set("rtf", status.asleep ? "at rest" : text);
      element("headline-rtf", HTMLElement).textContent = status.asleep ? "at rest" : text;
    }
    this.showStable(status);
    if (status.max_strain !== undefined) this.set("strain", `${(100 * status.max_strain).toFixed(1)} %`);
    if (status.contacts !== undefined) this.set("contacts", String(status.contacts));
    if (status.memory_bytes !== undefined) this.set("memory", megabytes(status.memory_bytes));
    if (status.surface !== undefined) this.showSurface(status.surface);
    if (status.passes) this.showPasses(status.passes, status.terms ?? [], status.skipped ?? []);
    if (status.pass_seconds) this.passSeconds = status.pass_seconds;
  }

  /// The verdict of the stability gauge, for the scene's time step [s].
  private showStable({ diverged, stability }: Status): void {
    this.stability = stability ?? this.stability;
    if (!this.stability || this.dt <= 0) return;
    const { verdict, word } = diverged
      ? ({ verdict: "beyond", word: "Blown up" } as const)
      : reading(this.dt, this.stability.dt_limit);
    const cell = element("headline-stable", HTMLElement);
    cell.dataset.verdict = verdict;
    if (cell.textContent !== word) cell.textContent = word;
  }

  // Only contact between surfaces has these counts.
  private showSurface(counts: Status["surface"]): void {
    const row = this.cells.get("surface")?.parentElement;
    if (row) row.hidden = !counts;
    if (!counts) return;
    const missed = counts.not_taken > 0 ? `, ${short(counts.not_taken)} steps not taken` : "";
    this.set("surface", `${short(counts.pairs)} pairs, ${short(counts.cuts)} cut${missed}`);
  }

  /// Turns the counts since the last call into rates. Call it about once a second.
  tick(bytesReceived: number): void {
    const now = performance.now();
    const seconds = (now - this.since) / 1000;
    const rate = (count: number) => (count / seconds).toFixed(0);
    this.set("drawn", `${rate(this.drawn)} /s`);
    this.set("received", `${rate(this.received)} /s`);
    element("headline-fps", HTMLElement).textContent = rate(this.drawn);
    const kilobits = (8 * (bytesReceived - this.bytes)) / seconds / 1000;
    this.set("rate", kilobits < 10000 ? `${kilobits.toFixed(0)} kbit/s` : `${(kilobits / 1000).toFixed(1)} Mbit/s`);
    for (const [pass, cell] of this.passTimes) {
      const spent = this.passSeconds[pass];
      cell.textContent =
        spent === undefined ? "" : spent < 1e-3 ? `${(1e6 * spent).toFixed(0)} µs` : `${(1e3 * spent).toFixed(1)} ms`;
    }
    this.drawn = this.received = 0;
    this.bytes = bytesReceived;
    this.since = now;
  }

  private showPasses(running: string[], terms: string[], skipped: { name: string; reason: string }[]): void {
    const text = JSON.stringify([running, terms, skipped]);
    if (text === this.passes) return;
    this.passes = text;
    element("passes-count", HTMLElement).textContent = `${running.length} run, with ${terms.length} terms`;
    this.passTimes.clear();
    const item = (name: string, kind: string, more?: HTMLElement): HTMLLIElement => {
      const entry = document.createElement("li");
      entry.textContent = name.replaceAll("_", " ");
      entry.className = kind;
      if (more) entry.append(more);
      return entry;
    };
    const timed = (name: string): HTMLElement => {
      const time = document.createElement("b");
      time.title = "the time that the GPU spends on this pass in a step; the method's includes all terms";
      this.passTimes.set(name, time);
      return time;
    };
    const because = (reason: string): HTMLElement => {
      const why = document.createElement("span");
      why.textContent = reason;
      return why;
    };
    element("passes", HTMLUListElement).replaceChildren(
      ...running.map((name) => item(name, "pass", timed(name))),
      ...terms.map((name) => item(name, "term")),
      ...skipped.map(({ name, reason }) => item(name, "skipped", because(reason))),
    );
  }
}
