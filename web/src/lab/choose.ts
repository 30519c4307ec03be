// The tab that asks for a tolerance and answers with the cheapest setting that keeps it.
import { labelled, make, makeNumber, numberIn, say } from "./dom";
import { Drawing } from "./drawing";
import { Picture } from "./picture";
import { applyButton, curveOf, largestOnTheWay, pointTip, PointTable } from "./points";
import { Tab, type TabHost } from "./tab";
import { sizeOf, ToleranceField, toleranceText } from "./tolerance";
import { comparedText, costRange, costText, errorText, settingText } from "./text";
import type { Choice, Point } from "./types";

/// The upper bound of a point's error as text: " (at most 1e-3)"; "" where it is unknown or the same as the error.
function atMost({ largest_position_error: seen, largest_position_error_high: high }: Point): string {
  return high === null || errorText(high) === errorText(seen) ? "" : ` (at most ${errorText(high)})`;
}

export class ChooseTab extends Tab<"choose"> {
  private readonly tolerance = new ToleranceField();
  private readonly time = makeNumber("1", "1");
  private readonly judged = make("p", "lab-fine"); // until when positions are, and why
  private readonly answer = make("p", "lab-answer");
  private readonly cards = make("div", "lab-cards");
  private readonly picture = new Picture({
    tip: (key) => {
      const point = this.point(key);
      return point ? pointTip(point, largestOnTheWay, this.host.mayEdit()) : null;
    },
    choose: (key) => this.applyPoint(this.point(key)),
    compare: (key) => this.comparePoint(this.point(key)),
    order: (key) => {
      const point = this.point(key) as Point;
      return { curve: curveOf(point), along: point.dt_s };
    },
  });
  private readonly drawing = new Drawing(
    "choose",
    this.host.jobs,
    this.picture,
    "What was tried: arrow keys go from point to point, Enter applies one",
    (error) => this.host.problem("The picture could not be drawn", error),
  );
  private readonly table = new PointTable(
    (point) => this.applyPoint(point),
    (point) => this.comparePoint(point),
    "All that was tried",
  );
  private result: Choice | null = null;
  private size: number | null = null; // of the cloth that was measured [m]

  constructor(host: TabHost) {
    super("choose", host, {
      lead: "Say how exact the motion has to be; the lab finds the cheapest method and time step that keep it, with a margin of stability.",
      start: "Find the cheapest",
      file: "choice",
      awaits: "The answer: a setting, the error and the cost to expect of it, the runner-up, and why.",
    });
    this.addMethods();
    this.addOptions(labelled("simulate [s]", this.time, "how much of the motion is judged"));
    this.element.querySelector(".lab-start")?.before(this.tolerance.element);
    this.content.append(this.judged, this.answer, this.cards, this.picture.element, this.table.element);
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

  protected override show(choice: Choice): void {
    this.result = choice;
    const document = this.host.document();
    if (document && !this.host.jobs.of("choose").stale) this.size = sizeOf(document);
    this.answer.classList.toggle("unmet", choice.complete && !choice.met);
    say(this.judged, choice.horizon_reason);
    say(this.answer, choice.complete ? choice.why : "");
    this.cards.hidden = !choice.complete;
    if (choice.complete) this.showCards(choice);
    this.drawing.want(choice, "position");
    this.table.show(choice.tried, largestOnTheWay);
  }

  private showCards(choice: Choice): void {
    const { chosen, runner_up: runnerUp, present } = choice;
    if (settingText(chosen) === settingText(present)) {
      const title = choice.met ? `Present, and the best within ${this.share(choice.tolerance)}` : "Present";
      this.cards.replaceChildren(
        this.card(title, present, null, "present"),
        ...(runnerUp ? [this.card("Runner-up", runnerUp, present, "")] : []),
      );
      return;
    }
    this.cards.replaceChildren(
      this.card(
        choice.met ? `The cheapest within ${this.share(choice.tolerance)}` : "The most accurate found",
        chosen,
        present,
        "chosen",
      ),
      ...(runnerUp ? [this.card("Runner-up", runnerUp, present, "")] : []),
      this.card("Present", present, null, "present"),
    );
  }

  private share(of: number): string {
    return toleranceText(of, this.size);
  }

  private card(title: string, point: Point, against: Point | null, className: string): HTMLElement {
    const blewUp = point.blew_up_at_s !== null;
    const error = point.largest_position_error ?? point.error.position;
    const compared = against ? comparedText(point.ms_a_simulated_s, against.ms_a_simulated_s) : "";
    const cost = `${costText(point.ms_a_simulated_s)}${costRange(point.ms_a_simulated_s)} a simulated second`;
    const facts = blewUp
      ? `blew up after ${Number(point.blew_up_at_s?.toPrecision(2))} s`
      : `expected error ${errorText(error)}${atMost(point)}, ${cost}${compared ? `: ${compared}` : ""}`;
    const card = make(
      "div",
      `lab-card ${className}`,
      make("h3", "", title),
      make("b", "", settingText(point)),
      make("span", "", facts),
    );
    if (className !== "present") {
      const button = applyButton(`Apply ${settingText(point)}`, () => this.applyPoint(point));
      if (className === "chosen") button.className = "lab-primary";
      button.disabled = !this.host.mayEdit();
      card.append(button);
    }
    return card;
  }

  private point(key: string): Point | undefined {
    return this.result?.tried[Number(key)];
  }

  private applyPoint(point: Point | undefined): void {
    if (point) this.host.apply(point.patch, settingText(point));
  }

  private comparePoint(point: Point | undefined): void {
    if (point) this.host.compare(point.patch);
  }
}
