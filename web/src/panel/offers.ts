// Rows of small buttons in the panel.
export interface Offer {
  text: string;
  title?: string;
  run(): void;
}

export function offers(all: Offer[]): HTMLElement {
  const row = document.createElement("p");
  row.className = "scene-actions";
  for (const { text, title = "", run } of all) {
    const made = document.createElement("button");
    Object.assign(made, { type: "button", className: "offer", textContent: text, title, onclick: run });
    made.setAttribute("aria-label", text); // by which it gets the focus back when the panel is made anew
    row.append(made);
  }
  return row;
}
