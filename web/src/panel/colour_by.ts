// What the cloth's colours show: the choice beside the speed, kept in this browser, and the legend above it.
import { element } from "./dom";
import { fields, gradient, isField } from "../view/fields";
import { fixedRange } from "../view/field_ranges";
import { inBrowser } from "../link/kept";
import type { FieldName, ShownField } from "../link/protocol";

const key = "clothlab-colour-by";

export class ColourBy {
  private readonly choice = element("colour-by", HTMLSelectElement);
  private readonly legend = element("legend", HTMLElement);
  private readonly most = element("legend-most", HTMLElement);
  private shown: ShownField | null = null;

  /// `chosen` gets the choice at once, then every other one; `resized` is called when the legend comes or goes.
  constructor(
    chosen: (field: FieldName | null) => void,
    private readonly resized: () => void,
  ) {
    const stored = inBrowser.get(key);
    this.choice.value = isField(stored) ? stored : "";
    this.choice.onchange = () => {
      inBrowser.set(key, this.choice.value);
      chosen(this.chosen);
    };
    if (this.chosen) chosen(this.chosen);
  }

  get chosen(): FieldName | null {
    return isField(this.choice.value) ? this.choice.value : null;
  }

  /// Says what the colours of the frame on screen mean.
  show(field: ShownField | null, range: number): void {
    const fixed = field ? fixedRange(field) : undefined;
    const text = field ? `${fixed ? "≥ " : ""}${fields[field].most(fixed ?? range)}` : "";
    if (this.most.textContent !== text) this.most.textContent = text;
    if (field === this.shown) return;
    this.shown = field;
    if (field) {
      element("legend-name", HTMLElement).textContent = fields[field].title;
      element("legend-least", HTMLElement).textContent = fields[field].least;
      element("legend-scale", HTMLElement).style.background = gradient(field);
    }
    this.legend.hidden = !field;
    document.body.classList.toggle("coloured", field !== null);
    this.resized();
  }
}
