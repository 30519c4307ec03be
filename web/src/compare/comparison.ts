// Compare: a drawer beside the cloth that has two settings of the scene stepped together from the start, draws both,
// and shows how far apart they are. The lab steps them (lab.compare), so that no session is changed or made.
import { Findings } from "./findings";
import { Form } from "./form";
import { type CompareHost, standard, type Wish } from "./host";
import { Job } from "./job";
import { linkOf } from "./link";
import { Views } from "./views";
import { sideText } from "./words";
import { make, makeButton, say } from "../lab/dom";
import { takes } from "../panel/keys";
import type { Operation, SceneDocument } from "../link/scene_types";
import type { Topology } from "../link/protocol";

export { wishIn } from "./link";

const narrow = matchMedia("(max-width: 760px)");

export class Comparison {
  private readonly drawer = make("aside", "card lab compare");
  private readonly form = new Form(() => this.host.document());
  private readonly lead = make(
    "p",
    "lab-lead",
    "Two settings of this scene, stepped together from its start: how far do they come apart?",
  );
  private readonly settings = make("details", "lab-more", make("summary", "", "A and B"), this.form.element);
  private readonly start = makeButton("Start together", "lab-primary", () => this.begun());
  private readonly cancel = makeButton("Cancel", "lab-small", () => this.job.cancel());
  private readonly doing = make("span", "lab-doing");
  private readonly wrong = make("p", "text-wrong");
  private readonly done = make("p", "lab-fine");
  private readonly output = make("textarea", "compare-more");
  private readonly stale = make("p", "lab-badge warn");
  private readonly useB = makeButton("Use B", "lab-small", () => this.use());
  private readonly found = new Findings({ arranged: () => this.arrange(), drawn: (time) => this.draw(time) });
  private readonly job = new Job({
    request: (method, params) => this.host.request(method, params),
    changed: () => this.jobChanged(),
  });
  private view: Views | null = null;
  private asked: { patch: Operation[]; scene: SceneDocument; topology: Topology } | null = null; // when it was started
  private opener: HTMLElement | null = null;

  constructor(private readonly host: CompareHost) {
    const title = make("h2", "", "Compare");
    title.id = "compare-title";
    this.drawer.id = "compare";
    this.drawer.hidden = true;
    this.drawer.setAttribute("aria-labelledby", title.id);
    this.wrong.setAttribute("role", "alert");
    this.settings.open = true;
    this.output.readOnly = this.output.hidden = true;
    this.output.setAttribute("aria-label", "Copied link");
    this.done.setAttribute("role", "status");
    const close = makeButton("×", "lab-close", () => this.toggle());
    close.setAttribute("aria-label", "Close the comparison");
    close.title = "Close (C)";
    const head = make("div", "lab-head", title, make("span", "text-space"), close);
    this.drawer.append(head, this.body());
    (document.getElementById("lab") as HTMLElement).after(this.drawer);
    addEventListener("keydown", (event) => this.key(event), { capture: true });
    for (const each of [this.wrong, this.done, this.stale, this.doing]) say(each, "");
    this.form.setMethods(host.methods());
    this.jobChanged();
  }

  private body(): HTMLElement {
    const copy = makeButton("Copy link", "lab-small", () => void this.copyLink());
    copy.title = "The scene, A and B in a link";
    return make(
      "div",
      "lab-body compare-body",
      this.lead,
      this.settings,
      make("div", "text-row", this.start, this.cancel, this.doing, make("span", "text-space"), this.useB, copy),
      this.wrong,
      this.done,
      this.output,
      this.stale,
      this.found.element,
    );
  }

  get open(): boolean {
    return !this.drawer.hidden;
  }

  get drawn(): boolean {
    return this.view !== null;
  }

  toggle(): void {
    if (!this.open) {
      this.reveal();
      return;
    }
    this.job.forget();
    this.leave();
    this.drawer.hidden = true;
    document.body.classList.remove("lab-open");
    this.host.toggled(false);
    const back = this.opener?.isConnected && this.opener !== document.body ? this.opener : null;
    back?.focus({ preventScroll: true });
    if (back === null || document.activeElement !== back)
      document.getElementById("view")?.focus({ preventScroll: true });
  }

  private reveal(): void {
    if (this.open) return;
    this.opener = document.activeElement as HTMLElement | null;
    this.drawer.hidden = false;
    document.body.classList.add("lab-open"); // what makes room for the lab makes room for this
    this.form.setMethods(this.host.methods());
    this.jobChanged();
    this.host.toggled(true);
    this.start.focus({ preventScroll: true });
  }

  /// Opens, fills the form in, and starts.
  begin(wish: Partial<Wish>): void {
    if (this.filledIn(wish)) this.begun();
  }

  /// Opens, fills the form in, and leaves the start to the user: a link starts nothing by itself.
  propose(wish: Partial<Wish>): void {
    if (!this.filledIn(wish)) return;
    this.settings.open = true;
    say(this.done, "This comes by a link. Nothing runs until you start it.");
    this.start.focus({ preventScroll: true });
  }

  /// False if B does not fit the scene, which is told.
  private filledIn(wish: Partial<Wish>): boolean {
    const whole = { ...standard, view: this.found.mode, ...wish };
    this.reveal();
    this.found.choose(whole.view);
    try {
      this.form.take(whole);
    } catch (error) {
      say(this.wrong, `B does not fit this scene: ${(error as Error).message}`);
      return false;
    }
    return true;
  }

  sceneChanged(): void {
    this.form.sceneChanged();
    const { asked } = this;
    const stored = this.host.stored();
    const changed = asked !== null && this.drawn && JSON.stringify(stored) !== JSON.stringify(asked.scene);
    say(this.stale, changed ? "The scene has changed since. Start together compares with the scene as it is now." : "");
  }

  told(method: "progress" | "result", params: Record<string, unknown>): void {
    this.job.told(method, params);
  }

  lost(): void {
    this.job.lost();
  }

  private begun(): void {
    const topology = this.host.stage().cloth.topology;
    const scene = this.host.stored();
    say(this.done, "");
    this.output.hidden = true;
    if (!this.host.mayEdit() || !topology || !scene) return;
    try {
      const { patch, truth, time } = this.form.asked();
      const addressed = this.host.addressed(patch);
      this.leave();
      this.asked = { patch, scene, topology };
      say(this.stale, "");
      this.job.start({ patch: addressed, truth, time });
    } catch (error) {
      say(this.wrong, (error as Error).message);
    }
  }

  private jobChanged(): void {
    const { job } = this;
    const mayEdit = this.host.mayEdit();
    this.start.disabled = job.working || !mayEdit;
    this.start.textContent = job.result && !job.working ? "Start again" : "Start together";
    this.cancel.hidden = !job.working;
    this.useB.disabled = !mayEdit;
    say(this.doing, job.working ? job.doing : "");
    say(this.wrong, mayEdit ? job.wrong : "You are a viewer of this session: only operators may have the lab compare.");
    const { result, moments } = job;
    const there = result !== null && moments !== null && moments.count > 0;
    this.found.element.hidden = !there;
    this.lead.hidden = there || job.working;
    if (there) this.showResult();
  }

  private showResult(): void {
    const { result, moments } = this.job;
    if (!result || !moments || !this.asked) return;
    if (!this.view) this.enter(this.asked);
    if (!this.view) return;
    this.view.setLabels(sideText("A", result), sideText("B", result));
    this.found.show(result, moments.end, this.job.working);
  }

  private enter({ scene, topology }: { scene: SceneDocument; topology: Topology }): void {
    if (topology.vertexCount !== this.job.result?.vertices) {
      say(this.wrong, "The session has another cloth by now: start again.");
      return;
    }
    // its keys are the comparison's now
    if (document.body.classList.contains("timeline-open")) document.getElementById("timeline-open")?.click();
    document.body.classList.add("comparing");
    if (narrow.matches) this.settings.open = false; // the picture and the curve need the room
    this.view = new Views(this.host.stage(), topology);
    this.view.setScene(scene);
    this.arrange();
    this.found.player.restart();
    this.host.toggled(true); // what the session's bar had of the window is free
  }

  // The session's cloth is drawn again.
  private leave(): void {
    this.found.player.stop();
    if (!this.view) return;
    this.view.close();
    this.view = null;
    document.body.classList.remove("comparing");
    this.host.returned();
    this.host.toggled(this.open);
  }

  private arrange(): void {
    this.view?.arrange(this.found.mode, this.found.swapped);
  }

  private draw(time: number): void {
    const { moments, result } = this.job;
    if (!moments || !result || !this.view || moments.count === 0) return;
    const place = moments.place(time);
    const moving = moments.moving[place.index] ?? [];
    this.view.show(moments.positions("a", place), moments.positions("b", place), time, moving);
    this.found.mark(time, result, place.index);
  }

  private key(event: KeyboardEvent): void {
    if (!this.open || event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    if (event.key === "Escape") this.toggle();
    else if (!this.drawn || takes(event.target, event.key)) return;
    else if (event.key === " ") this.found.player.toggle();
    else if (event.key === "," || event.key === ".") this.found.player.move(event.key === "." ? 1 : -1);
    else if (event.key.toLowerCase() === "r") this.found.player.restart();
    else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  private use(): void {
    try {
      const { patch } = this.form.asked();
      this.toggle();
      this.host.use(patch, "B of the comparison");
    } catch (error) {
      say(this.wrong, (error as Error).message);
    }
  }

  private async copyLink(): Promise<void> {
    const scene = this.host.stored();
    try {
      if (!scene) throw new Error("The scene has not come yet.");
      const { patch, truth, time } = this.form.asked();
      const link =
        location.origin + location.pathname + (await linkOf(scene, { patch, truth, time, view: this.found.mode }));
      this.output.hidden = false;
      this.output.value = link;
      this.output.rows = 3;
      await navigator.clipboard.writeText(link).then(
        () => say(this.done, "Copied: whoever opens it is asked where to load the scene, and sees this comparison."),
        // only pages by HTTPS or from this machine may write to the clipboard
        () => {
          this.output.select();
          say(this.done, "Press Ctrl+C to copy this:");
        },
      );
    } catch (error) {
      say(this.wrong, `Not copied: ${(error as Error).message}`);
    }
  }
}
