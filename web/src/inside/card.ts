// The card of See inside: what is drawn over the cloth, the range of its colours, and the curves.
import { make, makeButton, say } from "../lab/dom";
import type { FieldName } from "../link/protocol";
import type { SceneDocument } from "../link/scene_types";
import { fixedRange, fixRange } from "../view/field_ranges";
import { mostWorst, worstFrom, type Choices, type Overlay } from "./choices";
import { gapColours } from "./contact_pairs";
import { strainText } from "./strain";
import type { Largest } from "./strained_view";
import type { tonesFor } from "./tones";

const labels: Record<Overlay, [label: string, title: string]> = {
  wireframe: ["Wireframe", "the edges of the mesh"],
  normals: ["Normals", "at the vertices, as light sees them"],
  contacts: ["Contact pairs", "what contact keeps apart and is near each other"],
  structural: ["structural", "springs along the mesh"],
  shear: ["shear", "springs across the cells of a grid"],
  bend: ["bend", "springs that resist folds"],
  elements: ["Elements", "the triangles of finite elements"],
};
const springs: Overlay[] = ["structural", "shear", "bend"];
const units: Partial<Record<FieldName, [unit: string, factor: number]>> = { strain: ["%", 100], speed: ["m/s", 1] };

export interface CardHost {
  choices: Choices;
  chosen(): void; ///< `choices` have changed
  recolour(): void; ///< the range of the colours has changed
  close(): void;
}

export class Card {
  readonly element = make("section", "card inside");
  private readonly boxes = new Map<Overlay, { box: HTMLInputElement; label: HTMLLabelElement; swatch: HTMLElement }>();
  private readonly springRow = make("div", "inside-springs");
  private readonly worstRow: HTMLElement;
  private readonly worst = make("input", "inside-number");
  private readonly largest = make("p", "inside-fine");
  private readonly contacts = make("p", "inside-fine");
  private readonly gaps: HTMLElement;
  private readonly range = make("fieldset", "inside-range");
  private readonly curves = make("details", "inside-more");

  constructor(
    private readonly host: CardHost,
    drawn: HTMLElement, // the curves
    run: (running: boolean) => void,
  ) {
    this.element.id = "inside";
    this.element.hidden = true;
    const title = make("h2", "", "See inside");
    title.id = "inside-title";
    this.element.setAttribute("aria-labelledby", title.id);
    const close = makeButton("×", "inside-close", () => host.close());
    close.setAttribute("aria-label", "Close See inside");
    close.title = "Close (I); what is chosen stays";
    this.worstRow = this.makeWorst();
    this.gaps = this.makeGaps();
    this.springRow.setAttribute("role", "group");
    this.springRow.setAttribute("aria-label", "Springs");
    this.springRow.append(make("span", "", "Springs"), ...springs.map((overlay) => this.check(overlay)));
    const draw = make("fieldset", "", make("legend", "", "Draw over the cloth"));
    draw.append(
      make("div", "inside-row", this.check("wireframe"), this.check("normals")),
      this.springRow,
      this.check("elements"),
      this.worstRow,
      this.largest,
      this.check("contacts"),
      this.gaps,
      this.contacts,
    );
    this.curves.open = host.choices.curves;
    this.curves.append(make("summary", "", "Curves of the last minute"), drawn);
    this.curves.ontoggle = () => {
      host.choices.curves = this.curves.open;
      host.chosen();
      run(this.showsCurves);
    };
    this.element.append(
      make("div", "inside-head", title, close),
      make("div", "inside-body", draw, this.range, this.curves),
    );
    this.element.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      host.close();
    });
  }

  get showsCurves(): boolean {
    return !this.element.hidden && this.curves.open;
  }

  focus(): void {
    this.boxes.get("wireframe")?.box.focus();
  }

  private check(overlay: Overlay): HTMLLabelElement {
    const [text, title] = labels[overlay];
    const box = make("input");
    box.type = "checkbox";
    box.checked = this.host.choices[overlay];
    box.onchange = () => {
      this.host.choices[overlay] = box.checked;
      this.host.chosen();
    };
    const swatch = make("i", "inside-swatch");
    const label = make("label", "inside-check", box, swatch, text);
    label.title = title;
    this.boxes.set(overlay, { box, label, swatch });
    return label;
  }

  private makeWorst(): HTMLElement {
    this.worst.type = "number";
    this.worst.min = "0";
    this.worst.max = String(mostWorst);
    this.worst.value = String(this.host.choices.worst);
    this.worst.onchange = () => {
      this.host.choices.worst = worstFrom(this.worst.value, this.host.choices.worst);
      this.worst.value = String(this.host.choices.worst);
      this.host.chosen();
    };
    const label = make("label", "inside-worst", "Mark the worst", this.worst);
    label.title = `The most strained of those that are shown, 0 to ${mostWorst}`;
    return make("div", "", label);
  }

  private makeGaps(): HTMLElement {
    const scale = make("i");
    scale.style.background = `linear-gradient(to right, ${gapColours.join(", ")})`;
    const gaps = make("div", "inside-gaps", make("span", "", "½"), scale, make("span", "", "1½"));
    gaps.setAttribute("role", "img");
    gaps.setAttribute("aria-label", "Colours: gap from half to one and a half of the distance that is kept");
    gaps.title = "Gap, as a share of the distance that contact keeps; in the middle: just that";
    return gaps;
  }

  /// Shows what this scene has.
  sceneChanged({ cloths }: SceneDocument, tones: ReturnType<typeof tonesFor>): void {
    const has = (model: string): boolean => cloths.some(({ material }) => material.model === model);
    this.springRow.hidden = !has("springs");
    const elements = this.boxes.get("elements");
    if (elements) elements.label.hidden = !has("fem");
    for (const [overlay, { swatch }] of this.boxes)
      if (overlay !== "contacts") swatch.style.background = tones[overlay].colour;
      else swatch.hidden = true;
    for (const { swatch } of this.boxes.values()) swatch.style.borderColor = "var(--muted)";
  }

  /// Says what is strained most, and what touches.
  tell(largest: Largest | null, contacts: string): void {
    const rounding = largest ? 100 * largest.rounding : 0;
    say(
      this.largest,
      largest
        ? `Largest strain: ${strainText(largest.strain)} (to ±${rounding.toPrecision(1)} %), ${largest.what}.`
        : "",
    );
    say(this.contacts, contacts);
    const { choices } = this.host;
    this.worstRow.hidden = ![...springs, "elements" as const].some((overlay) => choices[overlay]);
    this.gaps.hidden = !choices.contacts;
  }

  /// Offers to fix the range of the field that colours the cloth.
  showRange(field: FieldName | null): void {
    const unit = field ? units[field] : undefined;
    this.range.replaceChildren(make("legend", "", "Range of the colours"));
    if (!field || !unit) {
      this.range.append(
        make("p", "inside-fine", "Colour by strain or speed, and set here what the last colour means."),
      );
      return;
    }
    const [name, factor] = unit;
    const value = make("input", "inside-number");
    value.type = "text";
    value.inputMode = "decimal";
    value.setAttribute("aria-label", `Largest ${field} [${name}]`);
    const fault = make("p", "inside-fault");
    fault.setAttribute("role", "status");
    const [automatic, fixed] = ["automatic", "fixed"].map((text) => {
      const radio = make("input");
      radio.type = "radio";
      radio.name = "inside-range";
      radio.value = text;
      return radio;
    }) as [HTMLInputElement, HTMLInputElement];
    const range = fixedRange(field);
    automatic.checked = range === undefined;
    fixed.checked = range !== undefined;
    value.value = String(Number((factor * (range ?? (field === "strain" ? 0.05 : 2))).toPrecision(4)));
    const fix = (): void => {
      const typed = Number(value.value.trim().replace(",", "."));
      const wrong = !(typed > 0 && typed <= 1e6) || value.value.trim() === "";
      value.setAttribute("aria-invalid", String(wrong));
      fault.textContent = wrong ? `“${value.value}” is no range: a number above 0, 1000000 ${name} at most.` : "";
      if (wrong) return;
      fixed.checked = true;
      fixRange(field, typed / factor);
      this.host.recolour();
    };
    automatic.onchange = () => {
      fault.textContent = "";
      value.removeAttribute("aria-invalid");
      fixRange(field, undefined);
      this.host.recolour();
    };
    fixed.onchange = value.onchange = fix;
    const choice = make("label", "inside-check", automatic, "automatic");
    choice.title = "Each frame's own largest value, which falls slowly";
    const fixedChoice = make("label", "inside-check", fixed, "0 to");
    fixedChoice.title = "What is more has the last colour";
    this.range.append(choice, make("span", "inside-fixed", fixedChoice, value, ` ${name}`), fault);
  }
}
