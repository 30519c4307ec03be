// The keyboard: one key, one command. Keys do nothing while the user types or a dialog is open.

export type Commands = Record<
  "toggle" | "step" | "reset" | "fit" | "hide" | "help" | "lab" | "text" | "compare" | "inside" | "mesh",
  () => void
>;

const bindings: Record<string, keyof Commands> = {
  " ": "toggle",
  ".": "step",
  r: "reset",
  f: "fit",
  h: "hide",
  l: "lab",
  i: "inside",
  m: "mesh",
  j: "text",
  c: "compare",
  "?": "help",
};

/// True if the focused element needs this key itself.
export function takes(target: EventTarget | null, key: string): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target instanceof HTMLInputElement) return target.type === "checkbox" ? key === " " : target.type !== "range";
  if (target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement || target.isContentEditable)
    return true;
  return key === " " && target.closest("button, summary") !== null;
}

export function bindKeys(commands: Commands): void {
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || (event.repeat && event.key !== ".")) return;
    if (document.querySelector("dialog[open]") || takes(event.target, event.key)) return;
    const command = bindings[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!command) return;
    event.preventDefault();
    commands[command]();
  });
}
