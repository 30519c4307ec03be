// What a comparison has found: the player, the curve, the figures in words and as a table, and how both are drawn.
import { Curve } from "./curve";
import type { Wish } from "./host";
import { Player } from "./player";
import { type CompareResult, presentText, runText, tableOf } from "./words";
import { make, makeButton, say } from "../lab/dom";

interface FindingsEvents {
  arranged(): void; ///< the view was chosen, or both were swapped
  drawn(time: number): void; ///< shows this time [s]
}

export class Findings {
  readonly element = make("div", "compare-shown");
  readonly player: Player;
  mode: Wish["view"] = "side";
  swapped = false;
  private readonly present = make("p", "compare-present");
  private readonly whole = make("p", "lab-fine");
  private readonly notes = make("ul", "lab-list");
  private readonly table = make("details", "lab-more", make("summary", "", "The difference as a table"));
  private readonly curve: Curve;
  private readonly choices: Record<Wish["view"], HTMLInputElement> = { side: make("input"), ghost: make("input") };

  constructor(private readonly events: FindingsEvents) {
    this.player = new Player({ drawn: (time) => this.events.drawn(time) });
    this.curve = new Curve((time) => this.player.go(time));
    const choice = make("div", "lab-axes", this.choice("side", "Side by side"), this.choice("ghost", "Ghost"));
    choice.setAttribute("role", "radiogroup");
    choice.setAttribute("aria-label", "View");
    const swap = makeButton("Swap", "lab-small", () => {
      this.swapped = !this.swapped;
      this.events.arranged();
    });
    swap.title = "A in the place of B, and B in that of A";
    const legend = make(
      "p",
      "compare-legend",
      make("span", "rms", "RMS over the vertices"),
      make("span", "most", "the largest"),
    );
    this.element.append(
      make("div", "text-row", choice, swap),
      this.player.element,
      this.present,
      this.curve.element,
      legend,
      this.whole,
      this.table,
      this.notes,
    );
  }

  private choice(mode: Wish["view"], text: string): HTMLLabelElement {
    const input = this.choices[mode];
    input.type = "radio";
    input.name = "compare-view";
    input.checked = mode === this.mode;
    input.onchange = () => {
      this.mode = mode;
      this.events.arranged();
    };
    return make("label", "", input, make("span", "", text));
  }

  choose(mode: Wish["view"]): void {
    this.mode = mode;
    this.choices[mode].checked = true;
  }

  /// Shows the figures so far; `end` [s]: of the moments that are here.
  show(result: CompareResult, end: number, working: boolean): void {
    this.player.reach(end, result.rate, !working);
    const says = runText(result);
    this.curve.show(result, says);
    say(this.whole, working ? "" : says);
    this.notes.replaceChildren(...result.notes.map((note) => make("li", "", note)));
    this.notes.hidden = result.notes.length === 0;
    this.table.querySelector("table")?.remove();
    this.table.append(tableOf(result));
  }

  /// The present time [s], and the moment whose figures are told.
  mark(time: number, result: CompareResult, moment: number): void {
    this.curve.mark(time);
    const text = presentText(result, moment);
    if (this.present.textContent !== text) this.present.textContent = text;
  }
}
