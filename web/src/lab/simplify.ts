// The tab that shows what each part of the scene is worth: error and cost without it, or with it coarser.
import { labelled, make, makeButton, makeNumber, numberIn, say } from "./dom";
import { Drawing } from "./drawing";
import { Picture } from "./picture";
import { applyButton } from "./points";
import { ToleranceField, toleranceText } from "./tolerance";
import { Tab, type TabHost } from "./tab";
import { Table } from "./table";
import { costText, errorText, settingText } from "./text";
import type { Simplification, Variant } from "./types";

/// A ratio of costs as a change: "−38 %", "+2 %".
function savedText(ratio: number | null): string {
  if (ratio === null) return "–";
  const change = Math.round(100 * (ratio - 1));
  return change === 0 ? "±0 %" : change < 0 ? `−${-change} %` : `+${change} %`;
}

/// Cost of a variant against the whole scene, with its range.
function costNode(variant: Variant): Node {
  const cell = make("span", "", variant.measured ? savedText(variant.cost_ratio) : "–");
  if (
    variant.cost_ratio_low !== null &&
    variant.cost_ratio_high !== null &&
    variant.cost_ratio_low < variant.cost_ratio_high
  ) {
    cell.append(make("small", "", `${savedText(variant.cost_ratio_low)} … ${savedText(variant.cost_ratio_high)}`));
  }
  return cell;
}

const isEmpty = (patch: object): boolean => Object.keys(patch).length === 0;

export class SimplifyTab extends Tab<"simplify"> {
  private readonly tolerance = new ToleranceField();
  private readonly time = makeNumber("1", "1");
  private readonly answer = make("p", "lab-answer");
  private readonly applyAll = makeButton("Apply recommended", "lab-primary", () => {
    if (this.result) this.host.apply(this.result.recommended.patch, this.result.recommended.name);
  });
  private readonly stepped = make("p", "lab-fine");
  private readonly table = new Table<Variant>(
    "What each part is worth",
    [
      { title: "Part", text: (variant) => this.nameOf(variant) },
      {
        title: "Changes",
        hint: "RMS distance to the whole scene stepped alike, over the cloth's size",
        text: ({ change }) => errorText(change),
        order: ({ change }) => change,
        className: "number",
      },
      {
        title: "Cost",
        hint: "against the whole scene, and between what it lies as far as the timings tell",
        text: costNode,
        order: (variant) => (variant.measured ? variant.cost_ratio : null),
        className: "number",
      },
      { title: "Verdict", text: (variant) => this.verdict(variant), className: "verdict" },
      { title: "", text: (variant) => this.buttonOf(variant), className: "action" },
    ],
    null,
    (variant) =>
      variant === this.result?.recommended ? "together" : !variant.measured ? "unmeasured" : variant.drop ? "drop" : "",
  );
  private readonly picture = new Picture({
    tip: (key) => {
      const variant = this.result?.variants[Number(key)];
      if (!variant?.measured) return null;
      return {
        title: variant.name,
        lines: [
          `changes the motion by ${errorText(variant.change)}`,
          `cost ${savedText(variant.cost_ratio)}${variant.saves === "cannot tell" ? ", within the noise" : ""}`,
        ],
        action: this.host.mayEdit() ? "Apply" : null,
      };
    },
    choose: (key) => this.applyVariant(this.result?.variants[Number(key)]),
    order: (key) => ({ curve: "", along: Number(key) + 1 }),
  });
  private readonly drawing = new Drawing(
    "simplify",
    this.host.jobs,
    this.picture,
    "What each part is worth: arrow keys go from one to the next",
    (error) => this.host.problem("The picture could not be drawn", error),
  );
  private result: Simplification | null = null;

  constructor(host: TabHost) {
    super("simplify", host, {
      lead:
        "Which parts of this scene does its motion need? Each is left out, or made simpler or coarser, in turn: " +
        "what that changes, and what it saves.",
      start: "Measure the parts",
      file: "parts",
      awaits: "A row for each part: how far the motion changes without it, what that saves, and whether it can go.",
    });
    this.addOptions(labelled("simulate [s]", this.time, "how much of the motion is judged"));
    this.element.querySelector(".lab-start")?.before(this.tolerance.element);
    this.content.append(this.answer, this.applyAll, this.table.element, this.picture.element, this.stepped);
  }

  override sceneChanged(): void {
    this.tolerance.follow(this.host.document());
  }

  protected override drawn(): string | null {
    return this.drawing.text;
  }

  protected override params(): Record<string, unknown> {
    const time = numberIn(this.time);
    return { tolerance: this.tolerance.read(), ...(time === undefined ? {} : { time }) };
  }

  protected override show(result: Simplification): void {
    this.result = result;
    say(this.answer, result.complete ? result.why : "");
    this.applyAll.hidden = !result.complete || isEmpty(result.recommended.patch);
    this.applyAll.disabled = !this.host.mayEdit();
    const { recommended, variants } = result;
    const together =
      result.complete &&
      recommended.measured &&
      !isEmpty(recommended.patch) &&
      variants.every(({ name }) => name !== recommended.name);
    this.table.show([...variants, ...(together ? [recommended] : [])]);
    this.drawing.want(result, "position");
    say(
      this.stepped,
      `All are stepped by ${settingText(result.setting)}. The whole scene costs ` +
        `${costText(result.whole.ms_a_simulated_s)} a simulated second and is ` +
        `${errorText(result.whole.error.position)} off itself; a part may change the motion by ` +
        `${toleranceText(result.tolerance, result.size_m)}.`,
    );
  }

  private verdict(variant: Variant): string {
    if (!variant.measured || variant === this.result?.recommended) return "";
    if (variant.drop) return "drop";
    // Only a variant that changes the motion little enough is worth measuring again on a quieter machine.
    const small = variant.change !== null && this.result !== null && variant.change <= this.result.tolerance;
    return small && variant.saves === "cannot tell" ? "within the noise" : "keep";
  }

  private nameOf(variant: Variant): Node {
    const name = make("span", "", variant.name);
    if (!variant.measured && variant.reason) name.append(make("small", "", variant.reason));
    return name;
  }

  private buttonOf(variant: Variant): Node {
    if (!variant.measured || isEmpty(variant.patch)) return make("span");
    const button = applyButton(`Apply ${variant.name}`, () => this.applyVariant(variant));
    button.disabled = !this.host.mayEdit();
    return button;
  }

  private applyVariant(variant: Variant | undefined): void {
    if (variant && !isEmpty(variant.patch)) this.host.apply(variant.patch, variant.name);
  }
}
