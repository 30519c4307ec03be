// See inside: puts the views over the cloth of the frame on screen, and the card beside it. Loaded when it is used.
import { button, element } from "../panel/dom";
import { noticeError } from "../panel/notices";
import { inBrowser } from "../link/kept";
import { Card } from "./card";
import { choicesKey, overlays, readChoices } from "./choices";
import type { ContactsAnswer } from "./contact_pairs";
import { ContactsView } from "./contacts_view";
import { Curves } from "./curves";
import type { InsideHost } from "./door";
import { fetchElements, fetchSprings } from "./elements_source";
import { MeshView } from "./mesh_view";
import { ShownPlaces } from "./shown_places";
import { StrainedView } from "./strained_view";
import { tonesFor } from "./tones";

const settled = 400; // [ms] after the last change of the cloths: then their springs are asked for anew
const words = 200; // [ms] between two changes of the card's words
const lowWindow = 860; // [CSS pixels]: no room for the figures above the card
const narrowWindow = 760; // the same

export class Inside {
  private readonly choices = readChoices(inBrowser.get(choicesKey));
  private readonly mesh = new MeshView();
  private readonly strained = new StrainedView();
  private readonly contacts: ContactsView;
  private readonly curves: Curves;
  private readonly card: Card;
  private readonly label = document.createElement("span");
  private shown: ShownPlaces | null = null;
  private revision = -1; // of the topology that the views have
  private asked = ""; // what the springs and elements that are here, or on their way, are of
  private cloths = ""; // of the document
  private askTimer = 0;
  private saidAt = 0;
  private sayTimer = 0;
  private foldedFigures = false;

  constructor(private readonly host: InsideHost) {
    this.curves = new Curves(host.log);
    this.contacts = new ContactsView({
      ask: (most) => host.ask("inspect.contacts", { most }) as Promise<ContactsAnswer>,
      arrived: () => this.redraw(),
    });
    const run = (running: boolean): void => this.curves.run(running);
    this.card = new Card(
      {
        choices: this.choices,
        chosen: () => this.chosen(),
        recolour: () => host.recolour(),
        close: () => this.toggle(),
      },
      this.curves.element,
      run,
    );
    const hud = element("hud", HTMLElement);
    hud.after(this.card.element);
    new ResizeObserver(() =>
      this.card.element.style.setProperty("--below", `${hud.offsetTop + hud.offsetHeight}px`),
    ).observe(hud);
    this.label.className = "inside-label";
    this.label.setAttribute("aria-hidden", "true"); // the card says it
    this.label.hidden = true;
    element("view", HTMLCanvasElement).after(this.label);
    const { stage } = host;
    stage.overlays.add(this.mesh.object, this.strained.object, this.contacts.object);
    stage.onShow = () => this.show();
    stage.onDraw = () => this.placeLabel();
    this.sceneChanged();
    this.coloured();
    this.chosen();
  }

  get open(): boolean {
    return !this.card.element.hidden;
  }

  /// `byKey`: the focus goes along.
  toggle(byKey = false): void {
    const open = !this.open;
    const figures = element("figures", HTMLDetailsElement);
    const focused = this.card.element.contains(document.activeElement);
    this.card.element.hidden = !open;
    if (open) this.foldedFigures = figures.open && (innerHeight < lowWindow || innerWidth <= narrowWindow);
    if (this.foldedFigures) figures.open = !open;
    document.body.classList.toggle("inside-open", open);
    button("inside-open").setAttribute("aria-expanded", String(open));
    this.curves.run(this.card.showsCurves);
    this.say();
    this.host.changed();
    if (open && byKey) this.card.focus();
    if (!open && focused) button("inside-open").focus();
  }

  /// The document has changed.
  sceneChanged(): void {
    const document = this.host.document();
    if (!document) return;
    const tones = tonesFor(document);
    for (const view of [this.mesh, this.strained]) view.paint(tones);
    this.card.sceneChanged(document, tones);
    this.cloths = JSON.stringify(document.cloths);
    this.source(settled);
    this.host.stage.invalidate();
  }

  /// The field that colours the cloth is another.
  coloured(): void {
    this.card.showRange(this.host.field());
  }

  private chosen(): void {
    inBrowser.set(choicesKey, JSON.stringify(this.choices));
    this.contacts.want(this.choices.contacts);
    this.host.stage.showsMeshBelow = overlays.some((overlay) => this.choices[overlay]);
    this.source(0);
    this.saidAt = 0;
    this.redraw();
  }

  // What is shown of the frame on screen is another.
  private redraw(): void {
    this.show();
    this.host.stage.invalidate();
  }

  private show(): void {
    const { stage } = this.host;
    const { frame } = stage;
    if (!frame) return;
    this.follow(frame.header.topologyRevision, frame.header.vertexCount);
    if (!this.shown) return;
    if (overlays.some((overlay) => this.choices[overlay])) this.shown.take(frame);
    this.mesh.show(this.shown, this.choices);
    this.strained.show(this.shown, this.choices);
    this.contacts.show(this.shown, this.host.live());
    this.say();
  }

  private follow(revision: number, vertexCount: number): void {
    const { topology } = this.host.stage.cloth;
    if (revision === this.revision || topology?.revision !== revision) return;
    this.revision = revision;
    this.shown = new ShownPlaces(vertexCount);
    this.mesh.take(topology);
    this.strained.take(null, null);
    this.source(0);
  }

  // Not at each frame, but of the last one at any rate.
  private say(): void {
    clearTimeout(this.sayTimer);
    const early = words - (performance.now() - this.saidAt);
    if (!this.open) return;
    if (early > 0) {
      this.sayTimer = window.setTimeout(() => this.say(), early);
      return;
    }
    this.saidAt = performance.now();
    const past = this.choices.contacts && !this.host.live();
    this.card.tell(this.strained.largest, past ? "Of the present alone: go back to live." : this.contacts.text);
  }

  // Asks for springs and elements if they are shown and not those that are here.
  private source(wait: number): void {
    const { structural, shear, bend, elements } = this.choices;
    const springs = structural || shear || bend;
    clearTimeout(this.askTimer);
    if (this.revision < 0 || (!springs && !elements)) return;
    const wanted = `${this.revision} ${springs} ${elements} ${this.cloths}`;
    if (wanted === this.asked) return;
    this.askTimer = window.setTimeout(() => void this.fetch(wanted, springs, elements), wait);
  }

  private async fetch(wanted: string, springs: boolean, elements: boolean): Promise<void> {
    this.asked = wanted;
    const ask = this.host.ask.bind(this.host);
    try {
      const [found, triangles] = await Promise.all([
        springs ? fetchSprings(ask, this.revision) : null,
        elements ? fetchElements(ask, this.revision) : null,
      ]);
      if (this.asked !== wanted) return; // something else is wanted meanwhile
      if ((springs && !found) || (elements && !triangles)) this.asked = "";
      this.strained.take(found, triangles);
      this.saidAt = 0;
      this.redraw();
    } catch (error) {
      this.asked = "";
      noticeError("Springs cannot be shown", error as Error);
    }
  }

  private placeLabel(): void {
    const { camera, canvas, overlays: drawn } = this.host.stage;
    const { clientWidth: width, clientHeight: height } = canvas;
    for (const view of [this.strained, this.contacts]) view.resize(width, height);
    const at = drawn.visible ? this.strained.label(camera, width, height) : null;
    this.label.hidden = !at;
    if (!at) return;
    if (this.label.textContent !== at.text) this.label.textContent = at.text;
    this.label.style.transform = `translate(${at.x.toFixed(1)}px, ${at.y.toFixed(1)}px)`;
  }
}
