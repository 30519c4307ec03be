// The first minute: a card that says what the page is, with three things to try. It comes once, and goes by a button or
// Escape.
import { remember } from "./newcomer";

export interface FirstStepsHost {
  mayEdit(): boolean;
  blowUp(): void;
  lab(): void;
  changed(): void; ///< the card came, went, or has another size
}

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

/// Shows the card, unless it is there.
export function showFirstSteps(host: FirstStepsHost): void {
  if (document.getElementById("first-steps")) return;
  const close = made("button", "first-close", "×");
  close.type = "button";
  close.setAttribute("aria-label", "Close the first steps");
  const title = made("h2", "", "Cloth, computed live");
  title.id = "first-steps-title";
  const mend = " then press “Apply the remedy”, and it is mended.";
  const ask = " which method suits this scene, and where each fails.";
  const steps = [
    host.mayEdit()
      ? made("li", "", made("b", "", "Pull it:"), " drag the cloth.")
      : made("li", "", made("b", "", "Pull it"), " by dragging the cloth; an operator may."),
    host.mayEdit()
      ? made("li", "", action("Make it blow up", host.blowUp), made("span", "", mend))
      : made("li", "", made("b", "", "Make it blow up"), " by a time step that is too long; an operator may."),
    made("li", "", action("Ask the lab", host.lab), made("span", "", ask)),
  ];
  const lead = "A server simulates it and streams it here. Whoever opens this page sees the same cloth. To try:";
  const card = made("section", "card first-steps", title, made("p", "", lead), made("ol", "", ...steps), close);
  card.id = "first-steps";
  card.setAttribute("aria-labelledby", title.id);
  document.getElementById("transport")?.before(card);
  remember();

  // Notices and the legend stand above it.
  const size = new ResizeObserver(() => {
    document.body.style.setProperty("--first-steps", `${card.offsetHeight + 8}px`);
    host.changed();
  });
  size.observe(card);
  const go = (): void => {
    size.disconnect();
    removeEventListener("keydown", onKey, { capture: true });
    const focused = card.contains(document.activeElement);
    card.remove();
    document.body.style.removeProperty("--first-steps");
    if (focused) document.getElementById("view")?.focus({ preventScroll: true });
    host.changed();
  };
  const onKey = (event: KeyboardEvent): void => {
    const busy = event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement;
    if (
      event.key !== "Escape" ||
      busy ||
      document.querySelector("dialog[open]") ||
      !card.checkVisibility({ visibilityProperty: true })
    )
      return;
    go();
  };
  addEventListener("keydown", onKey, { capture: true }); // before the lab closes by it
  close.onclick = go;
}
