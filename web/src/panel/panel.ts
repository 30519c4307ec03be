// The panel: made from the scene document, kept equal to it, and turning moved controls into patches.
import GUI, { type Controller } from "lil-gui";
import { Explanation } from "../explain/explanation";
import type { Guide } from "../explain/guide";
import { type Field, type Note, operationsFor, readField, type Section, type SolverFacts } from "./field";
import { sectionsOf } from "./fields";
import { keyedPlace, keyOf, keyOperations } from "./keying";
import { type Convergence, ConvergenceGauge } from "./convergence_gauge";
import { Gauge, type Stability } from "./gauge";
import type { Fabric } from "../link/fabrics";
import type { Operation, SceneDocument } from "../link/scene_types";
import { type Offer, offers } from "./offers";
import type { Deed } from "./parts";
import { SliderController } from "./slider";
import { timeStep } from "./solver_section";

export interface PanelEvents {
  edit(operations: Operation[], keepStable?: boolean): void;
  busy(path: string): boolean;
  time(): number; ///< that the picture shows [s]
  loadPreset(name: string): void;
  openText(): void;
  openCompare(): void;
  openGallery(): void;
  openFiles(): void;
  act(deed: Deed): void;
  handles(cloth: number): void; ///< this cloth is to be moved, turned, scaled
}

interface Control {
  field: Field;
  controller: Controller;
  held: boolean;
  reset: HTMLButtonElement;
  back: Operation[]; ///< brings the value back to how it was loaded; empty: it is so
}

const focusable = (row: HTMLElement): HTMLElement | null => row.querySelector("input, select");

export class Panel {
  private gui: GUI | null = null;
  private shape = "";
  private controls: Control[] = [];
  private values: Record<string, unknown> = {};
  private presets: string[] = [];
  private fabrics: Fabric[] = [];
  private methods: string[] = [];
  private stability: Stability | null = null;
  private facts: SolverFacts = {};
  private notes: (() => void)[] = [];
  private readonly convergence = new ConvergenceGauge();
  private readonly gauge = new Gauge((dt) => this.events.edit([{ op: "replace", path: timeStep, value: dt }]));
  private document: SceneDocument | null = null;
  private stored: SceneDocument | null = null; // the same as the server keeps it
  private readonly explanation: Explanation;
  private readonly differences = document.createElement("p");
  private readonly actions = offers([
    {
      text: "Open files",
      title: "A garment or a body of your own, as .obj, .ply, .glb or .gltf; or drop it anywhere",
      run: () => this.events.openFiles(),
    },
    { text: "Gallery", title: "The presets with pictures", run: () => this.events.openGallery() },
    { text: "Edit as text, save, share", title: "The scene as JSON (J)", run: () => this.events.openText() },
    { text: "Compare", title: "Two settings of the scene side by side (C)", run: () => this.events.openCompare() },
  ]);
  private readonly folded = new Map<string, boolean>();
  private preset: Controller | null = null;

  constructor(
    private readonly container: HTMLElement,
    private readonly events: PanelEvents,
    private readonly guide: Guide,
  ) {
    this.explanation = new Explanation(container);
    this.differences.className = "differences";
  }

  /// Marks what differs from the scene as loaded: called when that is known.
  mark(): void {
    if (!this.stored) return;
    const ways = this.guide.waysBack(
      this.controls.map(({ field }) => field),
      this.stored,
    );
    for (const [i, control] of this.controls.entries()) {
      control.back = ways[i] ?? [];
      const differs = control.back.length > 0;
      control.controller.domElement.classList.toggle("differs", differs);
      if (control.reset.hidden === !differs) continue;
      const was = differs ? this.guide.formerly(control.field, this.stored) : "";
      const says = `Reset ${control.field.label}${was && ` to ${was}`}`;
      control.reset.setAttribute("aria-label", says);
      control.reset.title = says;
      if (!differs && document.activeElement === control.reset) focusable(control.controller.domElement)?.focus();
      control.reset.hidden = !differs;
    }
    this.tellDifferences();
  }

  /// Takes the scenes and the fabrics that come with the server.
  setOffers(presets: string[], fabrics: Fabric[]): void {
    this.presets = presets;
    this.fabrics = fabrics;
    this.rebuildIfNeeded();
  }

  setMethods(methods: string[]): void {
    this.methods = methods;
    this.rebuildIfNeeded();
  }

  /// Takes the longest stable time step that the server computed.
  showStability(stability: Stability): void {
    this.stability = stability;
    this.moveGauge();
  }

  /// Takes how far the server has measured steps to be from solved.
  showConvergence(convergence: Convergence | null): void {
    this.convergence.show(convergence);
  }

  /// Takes what the server tells about the solver.
  showSolver(facts: SolverFacts): void {
    this.facts = facts;
    this.accompany();
  }

  /// Sets the controls to the document, except those that the user is moving or whose edits are unanswered.
  show(document: SceneDocument, stored: SceneDocument): void {
    this.document = document;
    this.stored = stored;
    this.rebuildIfNeeded();
    for (const { field, controller, held } of this.controls) {
      if (held || field.paths.some((path) => this.events.busy(path))) continue;
      const value = readField(field, document);
      if (this.values[field.key] === value) continue;
      this.values[field.key] = value;
      controller.updateDisplay();
    }
    this.values.preset = this.presets.includes(document.name) ? document.name : "";
    this.preset?.updateDisplay();
    this.accompany();
    this.mark();
  }

  /// Resets the controls to the server's document after a rejected edit.
  snapBack(): void {
    for (const control of this.controls) control.held = false;
    if (this.document && this.stored) this.show(this.document, this.stored);
  }

  private rebuildIfNeeded(): void {
    if (!this.document) return;
    const sections = sectionsOf(this.document, this.methods, this.fabrics);
    const shape = JSON.stringify([sections, this.presets], (key, value: unknown) =>
      key === "open" ? undefined : value,
    );
    if (shape === this.shape) return;
    this.shape = shape;
    const scroll = this.container.scrollTop;
    const { activeElement } = document;
    const inside = this.container.contains(activeElement);
    const focused = activeElement?.getAttribute("aria-label");
    this.explanation.close();
    this.gui?.destroy();
    this.controls = [];
    this.notes = [];
    this.values = { preset: this.presets.includes(this.document.name) ? this.document.name : "" };
    this.gui = new GUI({ container: this.container, title: "Scene", injectStyles: false });
    this.addPresets(this.gui);
    for (const section of sections) this.addSection(this.gui, section);
    this.accompany();
    this.mark();
    this.container.scrollTop = scroll;
    const again = focused && this.container.querySelector<HTMLElement>(`[aria-label="${CSS.escape(focused)}"]`);
    if (again) again.focus();
    else if (inside) focusable(this.container)?.focus({ preventScroll: true }); // what had it is gone
  }

  private addPresets(gui: GUI): void {
    this.preset = null;
    gui.$children.append(this.actions);
    if (this.presets.length === 0) return;
    const choices = this.values.preset === "" ? ["", ...this.presets] : this.presets;
    this.preset = gui.add(this.values, "preset", choices).name("preset");
    this.preset.onChange((name: string) => name && this.events.loadPreset(name));
    this.preset.domElement.querySelector("select")?.setAttribute("aria-label", "preset");
    gui.$children.append(this.actions, this.differences);
  }

  private addSection(parent: GUI, section: Section): void {
    const folder = parent.addFolder(section.title);
    if (!(this.folded.get(section.key) ?? section.open)) folder.close();
    folder.onOpenClose((changed) => {
      if (changed === folder) this.folded.set(section.key, !folder._closed);
    });
    for (const field of section.fields) this.addField(folder, field);
    const actions = this.actionsOf(section);
    if (actions.length > 0) folder.$children.append(offers(actions));
    for (const inner of section.sections) this.addSection(folder, inner);
  }

  /// The buttons below a section's fields.
  private actionsOf({ deeds = [], handles }: Section): Offer[] {
    const all = deeds.map((deed): Offer => ({ text: deed.label, run: () => this.events.act(deed) }));
    if (handles === undefined) return all;
    const title = "Move, turn and scale it at the start: the simulation is paused and goes back to it";
    return [{ text: "Move by handles", title, run: () => this.events.handles(handles) }, ...all];
  }

  private addField(folder: GUI, field: Field): void {
    this.values[field.key] = readField(field, this.document as SceneDocument);
    const controller = this.controllerFor(folder, field);
    const control: Control = { field, controller, held: false, reset: this.resetButton(), back: [] };
    this.controls.push(control);
    control.reset.onclick = () => this.events.edit(control.back, field.keepStable);
    if (controller instanceof SliderController) controller.allowed = () => this.rangeOf(field);
    const place = keyedPlace(field, this.document as SceneDocument);
    if (place !== null) controller.domElement.append(this.keyButton(field, place));
    controller.domElement.append(control.reset); // last: the row of a checkbox is a label, of the first control in it
    this.explanation.attach(controller.domElement, controller.$name, () =>
      this.document && this.stored ? this.guide.explain(field, this.document, this.stored) : null,
    );
    if (field.note) this.addNote(folder, { ...field, note: field.note });
    if (field.key === timeStep) folder.$children.append(this.gauge.element, this.convergence.element);
    controller.onChange((value: unknown) => {
      control.held = field.onRelease === true;
      if (!field.onRelease) this.edit(field, value);
      this.accompany();
    });
    controller.onFinishChange((value: unknown) => {
      if (field.onRelease && control.held) this.edit(field, value);
      control.held = false;
    });
  }

  /// What the scene allows there, in words; "" before that is known.
  private rangeOf(field: Field): string {
    const told = this.document && this.stored ? this.guide.explain(field, this.document, this.stored) : null;
    return told?.facts.find(([name]) => name === "Range")?.[1] ?? "";
  }

  /// Marked while its value has a key.
  private keyButton(field: Field, place: string): HTMLButtonElement {
    const key = document.createElement("button");
    key.type = "button";
    key.className = "key";
    key.textContent = "◆";
    key.onclick = () => {
      if (this.document) this.events.edit(keyOperations(place, this.document, this.events.time()));
    };
    this.notes.push(() => {
      const there = this.document ? keyOf(place, this.document) : undefined;
      const times = there?.at.map(([time]) => `${time} s`).join(", ");
      const says = `Key ${field.label} at the present time${times === undefined ? "" : `: has keys at ${times}`}`;
      if (key.title === says) return;
      key.title = says;
      key.setAttribute("aria-label", says);
      key.classList.toggle("keyed", there !== undefined);
    });
    return key;
  }

  private resetButton(): HTMLButtonElement {
    const reset = document.createElement("button");
    reset.type = "button";
    reset.className = "reset";
    reset.hidden = true;
    reset.textContent = "↺";
    return reset;
  }

  // How many values differ from the scene as loaded, and a button that brings all of them back.
  private tellDifferences(): void {
    const all = this.controls.flatMap(({ back }) => back);
    const count = this.controls.filter(({ back }) => back.length > 0).length;
    this.differences.hidden = count === 0;
    if (count === 0) return;
    const name = this.guide.baseline.name;
    const says = `${count} ${count === 1 ? "value differs" : "values differ"} from ${name}.`;
    const reset = document.createElement("button");
    reset.type = "button";
    reset.className = "offer";
    reset.textContent = "Reset all";
    reset.onclick = () => this.events.edit(all);
    this.differences.replaceChildren(says, " ", reset);
  }

  private edit(field: Field, value: unknown): void {
    if (this.document) this.events.edit(operationsFor(field, value, this.document), field.keepStable);
  }

  private controllerFor(folder: GUI, field: Field): Controller {
    switch (field.kind) {
      case "number":
        return new SliderController(folder, this.values, field.key, field.label, field.scale);
      case "color":
        return folder.addColor(this.values, field.key).name(field.label);
      case "toggle":
        return folder.add(this.values, field.key).name(field.label);
      case "choice":
        return this.choice(folder, field);
    }
  }

  private choice(folder: GUI, field: Field & { kind: "choice" }): Controller {
    const choices = Object.fromEntries(field.choices.map((value) => [field.names?.[value] ?? value, value]));
    const controller = folder.add(this.values, field.key, choices).name(field.label);
    controller.domElement.querySelector("select")?.setAttribute("aria-label", field.label);
    return controller;
  }

  /// Adds a line below a control that explains its present value.
  private addNote(folder: GUI, { note: says, keepStable }: Field & { note: NonNullable<Field["note"]> }): void {
    const line = document.createElement("p");
    line.className = "note";
    folder.$children.append(line);
    let shown = "";
    this.notes.push(() => {
      const note = says(this.values, this.facts);
      const now = JSON.stringify(note);
      if (now === shown) return;
      shown = now;
      line.hidden = note.text === "";
      line.replaceChildren(note.text, ...this.offer(note, keepStable));
    });
  }

  private offer({ offer }: Note, keepStable = false): HTMLElement[] {
    if (!offer) return [];
    const button = document.createElement("button");
    button.type = "button";
    button.className = "offer";
    button.textContent = offer.text;
    button.onclick = () => this.events.edit(offer.operations, keepStable);
    return [button];
  }

  /// Updates the notes and the gauge to the controls' values.
  private accompany(): void {
    for (const update of this.notes) update();
    this.moveGauge();
  }

  private moveGauge(): void {
    if (!this.stability) return;
    this.gauge.show(Number(this.values[timeStep]), this.stability);
    const control = this.controls.find(({ field }) => field.key === timeStep);
    if (control?.controller instanceof SliderController) control.controller.mark(this.stability.dt_limit);
  }
}
