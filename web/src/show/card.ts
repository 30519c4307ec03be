// The card of the show: why the cloth blew up, its energy, a slider over the moments, and the remedy.
import { EnergyChart, type EnergyCurve } from "./chart";
import { make, makeButton, say } from "../lab/dom";
import { type Diverged, sentence } from "../panel/notices";
import { gradient } from "../view/fields";

export interface CardHost {
  seek(index: number): void;
  again(): void;
  remedy(): void;
  close(): void;
  resized(): void;
}

const joules = (value: number): string => `${Number(value.toPrecision(3))} J`;

export class ShowCard {
  private readonly says = make("p", "show-says");
  private readonly body = make("div", "show-body");
  private readonly chart = new EnergyChart();
  private readonly range = make("input");
  private readonly where = make("span", "show-where");
  private readonly card = make("section", "card show");
  private readonly opener = document.activeElement;

  constructor(private readonly host: CardHost) {
    const title = make("h2", "", "How it blows up");
    title.id = "show-title";
    const close = makeButton("×", "lab-close", () => host.close());
    close.setAttribute("aria-label", "Close the blow-up");
    this.says.setAttribute("role", "status");
    this.body.hidden = true;
    this.card.id = "show";
    this.card.setAttribute("aria-labelledby", title.id);
    this.card.append(make("div", "show-head", title, close), this.says, this.body);
    this.card.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      host.close();
    });
    document.getElementById("hud")?.after(this.card);
    new ResizeObserver(() => host.resized()).observe(this.card);
  }

  say(text: string): void {
    say(this.says, text);
  }

  present({ reason, remedy }: Diverged, curve: EnergyCurve, moments: number): void {
    this.say(sentence(reason));
    const limit = curve.allowed === null ? "" : ` The dashed line is the most that a run that holds has: `;
    const most = Math.max(...curve.energy);
    const told = `Energy on a logarithmic scale: it ends at ${joules(most)}.`;
    const legend = make("p", "show-legend", "The growing mode: a vertex stands still ", make("i"), " swings most");
    const scale = legend.querySelector("i");
    if (scale) scale.style.background = gradient("growth");
    this.range.type = "range";
    Object.assign(this.range, { min: "0", max: String(moments - 1), step: "1" });
    this.range.setAttribute("aria-label", "Moment of the blow-up");
    this.range.oninput = () => this.host.seek(Number(this.range.value));
    const apply = makeButton("Apply the remedy", "lab-primary", () => this.host.remedy());
    const again = makeButton("Again, at a tenth of the speed", "lab-small", () => this.host.again());
    this.body.append(
      this.chart.element,
      make(
        "p",
        "show-legend show-energy",
        `Energy of motion${limit && "."}${limit}${limit && joules(curve.allowed as number)}.`,
      ),
      legend,
      make("div", "show-row", this.range, this.where),
      ...(remedy ? [make("p", "", sentence(`Remedy: ${remedy.text}`))] : []),
      make("div", "show-row", ...(remedy?.patch ? [apply] : []), again),
    );
    this.body.hidden = false;
    this.chart.show(curve, `${told}${limit}${limit && joules(curve.allowed as number)}.`);
  }

  at(index: number, milliseconds: number, step: number): void {
    this.range.value = String(index);
    const text = `step ${step}`;
    this.where.textContent = text;
    this.range.setAttribute("aria-valuetext", text);
    this.chart.mark(milliseconds);
  }

  remove(): void {
    const focused = this.card.contains(document.activeElement);
    this.card.remove();
    const back = this.opener instanceof HTMLElement && this.opener.checkVisibility() ? this.opener : null;
    if (focused) (back ?? document.getElementById("view"))?.focus({ preventScroll: true });
  }
}
