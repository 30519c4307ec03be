// The base of the lab's four tabs: a start button with options, progress, notes on the result, and export.
import { make, makeButton, makeCheck, say } from "./dom";
import { working, type Format, type Job, type Jobs } from "./jobs";
import type { Axis, Kind, Results, Setting } from "./types";
import { sentence } from "./text";
import { methodText, withNames } from "../panel/methods";
import type { Patch, SceneDocument } from "../link/scene_types";

/// The page around a tab, as the tab uses it.
export interface TabHost {
  jobs: Jobs;
  apply(patch: Patch, what: string): void;
  fail(patch: Patch, what: string): void; ///< shows how the scene blows up with that
  compare(patch: Patch): void; ///< the present settings with these
  problem(title: string, error: Error): void;
  mayEdit(): boolean;
  document(): SceneDocument | null;
}

/// The texts of a tab. `awaits`: shown until there is a result; `file`: the last part of an exported file's name.
interface Texts {
  lead: string;
  start: string;
  awaits: string;
  file: string;
}

const shownNotes = 3; // a longer list of notes is folded
const pauseHint = "Times are true only while nothing else computes; it plays on afterwards.";

export abstract class Tab<K extends Kind> {
  readonly element = make("section", "lab-tab");
  protected readonly options = make("div", "lab-options");
  protected readonly content = make("div", "lab-content");
  private readonly startButton = makeButton("", "lab-primary", () => this.start(false));
  private readonly pause = makeCheck("pause the cloth while measuring", false);
  private readonly optionsButton = makeButton("Options", "lab-fold", () => this.showOptions(this.options.hidden));
  private readonly row = make("div", "lab-start", this.startButton, this.pause.label, this.optionsButton);
  private readonly why = make("p", "lab-why", pauseHint);
  private readonly placeholder: HTMLElement;
  private readonly lead: HTMLElement;
  private readonly running = make("div", "lab-running");
  private readonly bar = make("div", "lab-bar", make("i"));
  private readonly doing = make("span", "lab-doing");
  private readonly cancelButton = makeButton("Cancel", "lab-small", () => void this.host.jobs.cancel(this.kind));
  private readonly badges = make("div", "lab-badges");
  private readonly about = make("p", "lab-fine");
  private readonly notesTitle = make("summary");
  private readonly noteList = make("ul", "lab-notes");
  private readonly notes = make("details", "lab-more", this.notesTitle, this.noteList);
  private readonly exports = make("div", "lab-exports");
  private readonly methodBoxes = new Map<string, HTMLInputElement>();
  private readonly methodList = make("fieldset", "lab-methods", make("legend", "", "Methods"));
  private badgesShown = "";

  constructor(
    readonly kind: K,
    protected readonly host: TabHost,
    private readonly texts: Texts,
  ) {
    this.lead = make("p", "lab-lead", texts.lead);
    this.placeholder = make("p", "lab-placeholder", texts.awaits);
    this.showOptions(false);
    this.pause.label.title = pauseHint;
    this.startButton.textContent = texts.start;
    this.bar.setAttribute("role", "progressbar");
    this.bar.setAttribute("aria-label", `${texts.start}: progress`);
    this.badges.setAttribute("role", "status");
    this.running.append(this.bar, make("div", "lab-running-line", this.doing, this.cancelButton));
    this.exports.append(
      make("span", "", "Export"),
      ...(["svg", "csv", "json"] as Format[]).map((format) =>
        makeButton(format.toUpperCase(), "lab-small", () => void this.download(format)),
      ),
    );
    this.element.append(
      this.lead,
      this.row,
      this.why,
      this.options,
      this.running,
      this.badges,
      this.placeholder,
      this.content,
      this.about,
      this.notes,
      this.exports,
    );
  }

  /// Shows the job's state. Call it once more when the tab is selected.
  update(): void {
    const job = this.host.jobs.of(this.kind);
    const busy = working(job as Job);
    this.element.dataset.state = job.state;
    this.startButton.disabled = busy || !this.host.mayEdit();
    this.startButton.title = this.host.mayEdit() ? "" : "A viewer may look at the cloth, not measure it";
    this.startButton.textContent = job.result && !busy ? "Measure again" : this.texts.start;
    // hidden for good at the first start: the Cancel button must not move under the pointer
    this.lead.hidden = busy || job.result !== null;
    this.row.hidden = busy;
    this.why.hidden = busy || job.state !== "idle";
    this.placeholder.hidden = job.result !== null || job.state === "failed";
    this.running.hidden = !busy;
    if (busy) this.showOptions(false);
    if (busy) this.showProgress(job as Job);
    this.showBadges(job as Job);
    this.content.hidden = this.exports.hidden = this.about.hidden = job.result === null;
    this.notes.hidden = !job.result?.notes.length;
    this.exports.classList.toggle("gone", job.ofJob === null);
    if (!job.result) return;
    const { renderer, complete, notes } = job.result;
    say(
      this.about,
      `${this.extent(job.result as Results[K])}, on ${renderer}.${complete || busy ? "" : " Not complete."}`,
    );
    if (notes.length !== this.noteList.childElementCount) this.notes.open = notes.length <= shownNotes;
    this.notesTitle.textContent = `Notes (${notes.length})`;
    this.noteList.replaceChildren(...notes.map((note) => make("li", "", withNames(note))));
    this.show(job.result as Results[K]);
  }

  /// The scene changed: updates what stands beside the result.
  sceneChanged(): void {
    /* most tabs have nothing to update */
  }

  setMethods(methods: string[]): void {
    this.methodList.hidden = methods.length === 0;
    for (const method of methods) {
      if (this.methodBoxes.has(method) || method === "auto") continue;
      const { label, input } = makeCheck(methodText(method).name, this.byDefault(method));
      this.methodBoxes.set(method, input);
      this.methodList.append(label);
    }
  }

  protected abstract show(result: Results[K]): void;

  /// Parameters of the request, without the methods and those of every tab. Throws an Error that says what is wrong.
  protected abstract params(): Record<string, unknown>;

  /// How much of the motion each run covers, as text.
  protected extent({ time_s }: Results[K]): string {
    return `${Number(time_s.toPrecision(3))} s simulated each time`;
  }

  /// True if the method is measured unless the user chooses otherwise.
  protected byDefault(_method: string): boolean {
    return true;
  }

  protected axis(): Axis {
    return "position";
  }

  protected addMethods(): void {
    this.options.append(this.methodList);
  }

  protected addOptions(...rows: HTMLElement[]): void {
    this.options.append(...rows);
  }

  protected start(afresh: boolean, paused = this.pause.input.checked): void {
    try {
      const params = { ...this.params(), ...this.chosenMethods(), pause: paused, ...(afresh ? { fresh: true } : {}) };
      void this.host.jobs.start(this.kind, params);
    } catch (error) {
      this.showOptions(true);
      this.host.problem("Not measured", error as Error);
    }
  }

  private showOptions(shown: boolean): void {
    this.options.hidden = !shown;
    this.optionsButton.setAttribute("aria-expanded", String(shown));
  }

  // The chosen methods; left out if all are chosen, as that is the server's default.
  private chosenMethods(): { methods?: string[] } {
    const methods = [...this.methodBoxes].filter(([, box]) => box.checked).map(([method]) => method);
    if (!this.options.contains(this.methodList) || methods.length === this.methodBoxes.size) return {};
    if (methods.length === 0) throw new Error("Choose at least one method.");
    return { methods };
  }

  private showProgress(job: Job): void {
    const share = job.total > 0 ? Math.min(1, job.done / job.total) : 0;
    const queued = job.state === "queued" || job.state === "asked";
    (this.bar.firstElementChild as HTMLElement).style.width = `${100 * share}%`;
    this.bar.classList.toggle("waiting", queued);
    this.bar.setAttribute("aria-valuenow", String(Math.round(100 * share)));
    const waits =
      job.ahead > 0
        ? `Waits for ${job.ahead === 1 ? "one other measurement" : `${job.ahead} other measurements`}`
        : "Starting…";
    say(this.doing, queued ? waits : job.doing || "Starting…");
    this.cancelButton.disabled = job.id === null;
  }

  private showBadges(job: Job): void {
    const shown = JSON.stringify([job.state, job.stale, job.cached, job.beside, job.error, job.result === null]);
    if (shown === this.badgesShown) return;
    this.badgesShown = shown;
    const badges: HTMLElement[] = [];
    const badge = (tone: string, text: string, action?: [string, () => void]): void => {
      const line = make("p", `lab-badge ${tone}`, make("span", "", text));
      if (action && !working(job)) line.append(makeButton(action[0], "lab-link", action[1]));
      badges.push(line);
    };
    const error = job.error;
    if (job.state === "failed")
      badge(
        "bad",
        ["Not measured:", sentence(error?.found ?? "the server does not say why"), sentence(error?.allowed ?? "")]
          .join(" ")
          .trim(),
      );
    if (job.state === "cancelled")
      badge(
        "calm",
        job.result ? "Cancelled: this is what had been measured." : "Cancelled before anything was measured.",
      );
    if (job.state === "lost") {
      badge(
        "warn",
        job.result
          ? "The connection was lost, and the measurement with it. What had been found is kept; it may be of another scene."
          : "The connection was lost, and the measurement with it.",
      );
    }
    if (job.result) this.addCautions(job, badge);
    this.badges.replaceChildren(...badges);
  }

  private addCautions(job: Job, badge: (tone: string, text: string, action?: [string, () => void]) => void): void {
    if (job.stale && job.ofJob !== null)
      badge("warn", "Measured for an earlier scene.", ["Measure again", () => this.start(false)]);
    if (job.cached)
      badge("calm", "From the cache: measured before for this very scene.", ["Measure afresh", () => this.start(true)]);
    if (job.beside && !job.cached) {
      badge("calm", "The cloth played on meanwhile: the times may be too long.", [
        "Measure with it paused",
        () => this.start(true, true),
      ]);
    }
  }

  private async download(format: Format): Promise<void> {
    const job = this.host.jobs.of(this.kind);
    try {
      const text =
        job.ofJob !== null ? await this.host.jobs.exported(this.kind, format, this.axis()) : this.kept(format);
      const types = { svg: "image/svg+xml", csv: "text/csv", json: "application/json" };
      const address = URL.createObjectURL(new Blob([text], { type: types[format] }));
      const link = make("a");
      link.href = address;
      link.download = `${job.result?.scene ?? "scene"}-${this.texts.file}.${format}`.replace(/[^\w.-]+/g, "_");
      link.click();
      setTimeout(() => URL.revokeObjectURL(address), 10_000);
    } catch (error) {
      this.host.problem("Not exported", error as Error);
    }
  }

  // The text to export when the job is gone with its connection: from what the page holds. Throws if it holds none.
  private kept(format: Format): string {
    const text =
      format === "json"
        ? JSON.stringify(this.host.jobs.of(this.kind).result, null, 1)
        : format === "svg"
          ? this.drawn()
          : null;
    if (!text) throw new Error("The measurement is gone with the connection. Measure again to export it in this form.");
    return text;
  }

  /// The drawing as the server sent it; null if there is none.
  protected drawn(): string | null {
    return null;
  }
}

/// The setting that the scene is stepped with.
export function presentSetting(document: SceneDocument): Setting {
  const { method, dt, iterations, tolerance } = document.solver;
  const { iterations: iterates } = methodText(method);
  return { method, dt_s: dt, iterations: iterates ? iterations : null, tolerance: iterates?.solves ? tolerance : null };
}
