// Makes HTML elements for the lab's drawer.
import { withNames } from "../panel/methods";

type Child = Node | string;

export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  className = "",
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  if (className !== "") made.className = className;
  made.append(...children);
  return made;
}

export function makeButton(text: string, className: string, run: () => void): HTMLButtonElement {
  const made = make("button", className, text);
  made.type = "button";
  made.onclick = run;
  return made;
}

/// Sets the text of `place`, with the methods' common names, only when it changed: a screen reader reads a status again
/// each time it is written.
export function say(place: HTMLElement, words: string): void {
  const text = withNames(words);
  place.hidden = text === "";
  if (place.textContent !== text) place.textContent = text;
}

/// A checkbox with its text.
export function makeCheck(
  text: string,
  checked: boolean,
  changed: (checked: boolean) => void = () => undefined,
): { label: HTMLLabelElement; input: HTMLInputElement } {
  const input = make("input");
  input.type = "checkbox";
  input.checked = checked;
  input.onchange = () => changed(input.checked);
  return { label: make("label", "lab-check", input, text), input };
}

/// A labelled control in a row of options.
export function labelled(text: string, control: HTMLElement, title = ""): HTMLLabelElement {
  const label = make("label", "lab-field", make("span", "", text), control);
  label.title = title;
  return label;
}

/// A field for a number; a field left empty yields undefined.
export function makeNumber(placeholder: string, value = ""): HTMLInputElement {
  const input = make("input", "lab-number");
  input.type = "text";
  input.inputMode = "decimal";
  input.spellcheck = false;
  input.placeholder = placeholder;
  input.value = value;
  return input;
}

export function numberIn(input: HTMLInputElement): number | undefined {
  const typed = input.value.trim().replace(",", ".");
  return typed === "" ? undefined : Number(typed);
}

export function makeSelect(choices: [value: string, text: string][], value: string): HTMLSelectElement {
  const select = make("select");
  for (const [of, text] of choices) select.add(new Option(text, of, false, of === value));
  return select;
}
