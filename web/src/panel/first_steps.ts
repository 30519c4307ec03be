// The first minute: a card that says what the page is, with three things to try, each ticked off when it is done. It
// comes once, and goes when all are done, by a button or by Escape.
import { inBrowser } from "../link/kept";
import type { FirstStepsHost, Step } from "./newcomer";

const goesAfter = 2500; // [ms] from the last tick, so that it is seen

const made = <K extends keyof HTMLElementTagNameMap>(
  tag: K,
  className: string,
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] => {
  const node = document.createElement(tag);
  node.className = className;
  node.append(...children);
  return node;
};

function action(text: string, run: () => void): HTMLButtonElement {
  const node = made("button", "first-do", text);
  node.type = "button";
  node.onclick = run;
  return node;
}

export class FirstSteps {
  private readonly card: HTMLElement;
  private readonly steps: Record<Step, HTMLLIElement>;
  private readonly left: Set<Step>; // that this visitor may do, and has not done
  // Notices and the legend stand above it.
  private readonly size = new ResizeObserver(() => {
    document.body.style.setProperty("--first-steps", `${this.card.offsetHeight + 8}px`);
    this.host.changed();
  });

  constructor(
    private readonly host: FirstStepsHost,
    private readonly gone: () => void,
  ) {
    this.steps = this.makeSteps();
    this.left = new Set<Step>(host.mayEdit() ? ["pull", "mend", "lab"] : ["lab"]);
    this.card = this.makeCard();
    document.getElementById("transport")?.before(this.card);
    inBrowser.set("clothlab-first-steps", "seen");
    this.size.observe(this.card);
    addEventListener("keydown", this.onKey, { capture: true }); // before the lab closes by it
  }

  /// Ticks a step off. After the last one the card goes by itself.
  did(step: Step): void {
    if (!this.left.delete(step)) return;
    this.steps[step].classList.add("done");
    this.steps[step].prepend(made("span", "visually-hidden", "Done: "));
    if (this.left.size === 0) setTimeout(() => this.close(), goesAfter);
  }

  private makeSteps(): Record<Step, HTMLLIElement> {
    const { host } = this;
    const mend = " and see why; then press “Apply the remedy”, and the same cloth stands.";
    const ask = " which method suits this scene, and where each fails.";
    return {
      pull: host.mayEdit()
        ? made("li", "", made("b", "", "Pull it:"), " drag the cloth.")
        : made("li", "", made("b", "", "Pull it"), " by dragging the cloth; an operator may."),
      mend: host.mayEdit()
        ? made("li", "", action("Make it blow up", host.blowUp), made("span", "", mend))
        : made("li", "", made("b", "", "Make it blow up"), " by a time step that is too long; an operator may."),
      lab: made("li", "", action("Ask the lab", host.lab), made("span", "", ask)),
    };
  }

  private makeCard(): HTMLElement {
    const close = made("button", "first-close", "×");
    close.type = "button";
    close.setAttribute("aria-label", "Close the first steps");
    close.onclick = () => this.close();
    const title = made("h2", "", "Cloth, computed live");
    title.id = "first-steps-title";
    const lead = "A server simulates it and streams it here. Whoever opens this page sees the same cloth. To try:";
    const list = made("ol", "", ...Object.values(this.steps));
    const card = made("section", "card first-steps", title, made("p", "", lead), list, close);
    if (this.host.mayEdit()) {
      const scenes = ["drape", "seed"].map((name) => action(name, () => this.host.load(name)));
      card.append(made("span", "first-scenes", "Scenes:", ...scenes, action("all", this.host.gallery)));
    }
    card.id = "first-steps";
    card.setAttribute("aria-labelledby", title.id);
    return card;
  }

  private close(): void {
    if (!this.card.isConnected) return;
    this.size.disconnect();
    removeEventListener("keydown", this.onKey, { capture: true });
    const focused = this.card.contains(document.activeElement);
    this.card.remove();
    document.body.style.removeProperty("--first-steps");
    if (focused) document.getElementById("view")?.focus({ preventScroll: true });
    this.gone();
    this.host.changed();
  }

  private readonly onKey = (event: KeyboardEvent): void => {
    const busy = event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement;
    const behind = document.querySelector("dialog[open]") || !this.card.checkVisibility({ visibilityProperty: true });
    if (event.key === "Escape" && !busy && !behind) this.close();
  };
}
