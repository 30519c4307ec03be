// Notices: what went wrong or changed, in words, with a button for the remedy if there is one.
import { element } from "./dom";
import { RpcError } from "../link/rpc";
import type { Patch } from "../link/scene_types";

export type Level = "info" | "warning" | "error";
export interface Action {
  label: string;
  keeps?: boolean; ///< the notice stays when this is done
  run(): void;
}

const narrow = matchMedia("(max-width: 760px)"); // room for one notice only
const shownAtOnce = (): number => (narrow.matches ? 1 : 3);
const lifetime: Record<Level, number> = { info: 5000, warning: 9000, error: 14000 }; // [ms]

interface Content {
  title: string;
  lines?: string[];
  actions?: Action[];
  stays?: boolean;
  closed?(): void; ///< the notice has gone, in whatever way
}

/// Returns a function that removes the notice.
export function notice(level: Level, content: Content): () => void {
  const holder = element("notices", HTMLElement);
  const box = document.createElement("div");
  box.className = `notice ${level}`;
  box.setAttribute("role", level === "error" ? "alert" : "status");
  const title = document.createElement("strong");
  title.textContent = capitalised(content.title);
  box.append(title);
  for (const line of content.lines ?? []) {
    const paragraph = document.createElement("p");
    paragraph.textContent = line;
    box.append(paragraph);
  }
  const close = document.createElement("button");
  close.className = "close";
  close.setAttribute("aria-label", "Dismiss");
  close.textContent = "×";
  close.onclick = () => remove(box);
  for (const action of content.actions ?? []) box.append(actionButton(action, box));
  box.append(close);
  if (content.closed) closers.set(box, content.closed);
  // The same notice again replaces the old one.
  for (const old of [...holder.children])
    if (old.querySelector("strong")?.textContent === title.textContent) remove(old);
  holder.append(box);
  box.dataset.stays = String(content.stays === true);
  while (holder.children.length > shownAtOnce())
    remove((holder.querySelector('[data-stays="false"]') ?? holder.firstElementChild) as Element);
  if (!content.stays) setTimeout(() => remove(box), lifetime[level]);
  return () => remove(box);
}

const closers = new WeakMap<Element, () => void>();

function remove(box: Element): void {
  box.remove();
  closers.get(box)?.();
  closers.delete(box);
}

// leaves dt as it is
const capitalised = (text: string): string => text.replace(/^[a-z](?=[a-z]{2})/, (letter) => letter.toUpperCase());
export const sentence = (text: string): string => capitalised(text).replace(/\.?$/, ".");

function actionButton(action: Action, box: HTMLElement): HTMLButtonElement {
  const run = document.createElement("button");
  run.className = "action";
  run.textContent = action.label;
  run.onclick = () => {
    if (!action.keeps) remove(box);
    action.run();
  };
  return run;
}

/// Shows an error as a notice: where it is, what was found, what is allowed.
export function noticeError(title: string, error: Error): void {
  if (!(error instanceof RpcError)) {
    notice("error", { title, lines: [error.message] });
    return;
  }
  const { path, found, allowed } = error.data;
  const lines = path ? [`at ${path}`] : [error.message];
  if (found !== undefined) lines.push(`found: ${asText(found)}`);
  if (allowed !== undefined) lines.push(`allowed: ${asText(allowed)}`);
  notice("error", { title, lines });
}

const asText = (value: unknown): string => (typeof value === "string" ? value : JSON.stringify(value));

/// Notification `sim.diverged`.
export interface Diverged {
  reason: string;
  remedy?: { text: string; patch?: Patch };
  /// What the server has compared in the last state [J, s]; null: no finite number. `elastic`: the energy is kinetic
  /// and elastic, else kinetic alone.
  energy?: { allowed: number | null; found: number | null; time: number | null; elastic: boolean };
}

const blewUp = "The simulation blew up";

/// Removes the notice of a blow-up: the simulation runs again.
export function clearDiverged(): void {
  for (const box of element("notices", HTMLElement).querySelectorAll(".notice")) {
    if (box.querySelector("strong")?.textContent === blewUp) remove(box);
  }
}

/// Says why the simulation blew up, with a button for its remedy.
export function showDiverged(
  { reason, remedy }: Diverged,
  apply: (patch: Patch) => Promise<void>,
  show: (() => void) | null,
): void {
  const patch = remedy?.patch;
  const run = (fix: Patch): void =>
    void apply(fix).catch((error: Error) => noticeError("The remedy was refused", error));
  notice("error", {
    title: blewUp,
    lines: [sentence(reason), ...(remedy ? [sentence(`Remedy: ${remedy.text}`)] : [])],
    stays: true,
    actions: [
      ...(patch ? [{ label: "Apply the remedy", run: () => run(patch) }] : []),
      ...(show ? [{ label: "Show how", run: show }] : []),
    ],
  });
}

const depths: Record<string, string> = {
  none: "nothing to change",
  uniform: "applied live",
  kernel: "applied live, kernel rebuilt",
  cloth: "cloth rebuilt, time reset",
};
let appliedTimer = 0;

/// Says at the foot of the panel how much an edit rebuilt.
export function showApplied(depth: string): void {
  const place = element("applied", HTMLElement);
  place.textContent = depths[depth] ?? `applied (${depth})`;
  place.classList.add("shown");
  clearTimeout(appliedTimer);
  appliedTimer = window.setTimeout(() => place.classList.remove("shown"), 1600);
}
