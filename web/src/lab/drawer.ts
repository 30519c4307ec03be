// The lab: a drawer beside the cloth with four tabs. Nothing of it is stored in the browser.
import { button, element } from "../panel/dom";
import { formerly } from "./apply";
import { ChartTab } from "./chart";
import { ChooseTab } from "./choose";
import { make } from "./dom";
import { Jobs } from "./jobs";
import { SimplifyTab } from "./simplify";
import { StabilityTab } from "./stability";
import type { TabHost } from "./tab";
import type { Arrival, Kind, Progress } from "./types";
import { notice, noticeError } from "../panel/notices";
import type { Patch, SceneDocument } from "../link/scene_types";

export interface LabEvents {
  request<T>(method: string, params: Record<string, unknown>): Promise<T>;
  document(): SceneDocument | null;
  /// A patch of the document as the server keeps it that does what `patch` does to the one that is shown.
  addressed(patch: Patch): Patch;
  undo(revision: number): void; ///< undoes the change that made this revision, if it was the last
  mayEdit(): boolean;
  applied(depth: string): void;
  compare(patch: Patch): void;
  fail(patch: Patch, what: string): void; ///< shows how the scene blows up with that
  toggled(open: boolean): void; ///< changes the free part of the window
}

const titles: Record<Kind, string> = { chart: "Chart", stability: "Stability", choose: "Choose", simplify: "Simplify" };

export class Lab {
  private readonly drawer = element("lab", HTMLElement);
  private readonly opener = button("lab-open");
  private readonly jobs = new Jobs({
    request: (method, params) => this.events.request(method, params),
    changed: (kind) => this.changed(kind),
    refused: (error) => noticeError("The lab refused this", error),
  });
  private readonly host: TabHost = {
    jobs: this.jobs,
    apply: (patch, what) => void this.apply(patch, what),
    compare: (patch) => this.events.compare(patch),
    fail: (patch, what) =>
      this.events.fail(this.events.addressed(patch), `Lab: ${what}`.replace(/[^ -~]/g, "").slice(0, 80)),
    problem: (title, error) => noticeError(title, error),
    mayEdit: () => this.events.mayEdit(),
    document: () => this.events.document(),
  };
  private readonly tabs = {
    chart: new ChartTab(this.host),
    stability: new StabilityTab(this.host),
    choose: new ChooseTab(this.host),
    simplify: new SimplifyTab(this.host),
  };
  private readonly heads = new Map<Kind, HTMLButtonElement>();
  private active: Kind = "chart";
  private connected = false;

  constructor(private readonly events: LabEvents) {
    const list = element("lab-tabs", HTMLElement);
    const body = element("lab-body", HTMLElement);
    for (const kind of Object.keys(titles) as Kind[]) {
      list.append(this.head(kind));
      const tab = this.tabs[kind].element;
      tab.id = `lab-${kind}`;
      tab.setAttribute("role", "tabpanel");
      tab.setAttribute("aria-labelledby", `lab-head-${kind}`);
      body.append(tab);
    }
    list.addEventListener("keydown", (event) => this.walk(event));
    this.opener.onclick = () => this.toggle();
    button("lab-close").onclick = () => this.toggle();
    this.drawer.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.toggle();
    });
    this.select("chart");
  }

  get open(): boolean {
    return !this.drawer.hidden;
  }

  toggle(): void {
    const open = !this.open;
    this.drawer.hidden = !open;
    document.body.classList.toggle("lab-open", open);
    this.opener.setAttribute("aria-expanded", String(open));
    this.events.toggled(open);
    if (open) this.tabs[this.active].sceneChanged();
    (open ? this.heads.get(this.active) : this.opener)?.focus({ preventScroll: true });
  }

  /// Closes it: something else takes its room.
  shut(): void {
    if (this.open) this.toggle();
  }

  setMethods(methods: string[]): void {
    for (const tab of Object.values(this.tabs)) tab.setMethods(methods);
  }

  /// Called when the server tells this page's role, at first or anew.
  roleChanged(): void {
    for (const kind of Object.keys(titles) as Kind[]) this.changed(kind);
  }

  sceneChanged(): void {
    this.jobs.sceneChanged();
    for (const tab of Object.values(this.tabs)) tab.sceneChanged();
  }

  link(open: boolean): void {
    if (this.connected && !open) this.jobs.lost();
    this.connected = open;
  }

  progress(params: Record<string, unknown>): void {
    this.jobs.progress(params as unknown as Progress);
  }
  arrived(params: Record<string, unknown>): void {
    this.jobs.arrived(params as unknown as Arrival);
  }

  private head(kind: Kind): HTMLButtonElement {
    const head = make("button", "", titles[kind], make("i"));
    head.type = "button";
    head.id = `lab-head-${kind}`;
    head.setAttribute("role", "tab");
    head.setAttribute("aria-controls", `lab-${kind}`);
    head.onclick = () => this.select(kind);
    this.heads.set(kind, head);
    return head;
  }

  private select(kind: Kind): void {
    this.active = kind;
    for (const [other, head] of this.heads) {
      head.setAttribute("aria-selected", String(other === kind));
      head.tabIndex = other === kind ? 0 : -1;
      this.tabs[other].element.hidden = other !== kind;
    }
    this.tabs[kind].update();
    this.tabs[kind].sceneChanged();
  }

  private walk(event: KeyboardEvent): void {
    const kinds = [...this.heads.keys()];
    const at = kinds.indexOf(this.active);
    const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: kinds.length - 1 }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    this.select(kinds[(to + kinds.length) % kinds.length] as Kind);
    this.heads.get(this.active)?.focus();
  }

  private changed(kind: Kind): void {
    const { state } = this.jobs.of(kind);
    const head = this.heads.get(kind);
    if (head) head.dataset.state = state;
    this.tabs[kind].update();
  }

  /// Applies `patch` and shows a notice that says what was changed and offers to undo it.
  async apply(patch: Patch, what: string): Promise<void> {
    const before = this.events.document();
    if (!before || !this.events.mayEdit()) return;
    const was = formerly(before, patch);
    const revision = await this.send(this.events.addressed(patch), `Lab: ${what}`);
    if (revision === null) return;
    notice("info", {
      title: `Applied: ${what}`,
      lines: was === "" ? [] : [`Before: ${was}.`],
      actions: [{ label: "Undo", run: () => this.events.undo(revision) }],
    });
  }

  // Returns the scene's new revision, or null if the server refused.
  private async send(patch: Patch, what: string): Promise<number | null> {
    try {
      const name = what.replace(/[^ -~]/g, "").slice(0, 80); // the server counts bytes
      const { applies, revision } = await this.events.request<{ applies: string; revision: number }>("scene.patch", {
        patch,
        name,
      });
      this.events.applied(applies);
      return revision;
    } catch (error) {
      noticeError("Not applied", error as Error);
      return null;
    }
  }
}
