// Undo and redo: the buttons, the keys, and what anybody in the session has undone. The server keeps the changes.
import { button } from "./dom";
import { notice, noticeError, showApplied } from "./notices";
import { errorNothingThere, RpcError } from "../link/rpc";

/// Notification `scene.history`.
export interface History {
  undo: string | null;
  redo: string | null;
  last: { what: "change" | "undo" | "redo"; name: string; by: number } | null;
}

export interface UndoHost {
  request<T>(method: string, params: Record<string, unknown>): Promise<T>;
  settled(longest?: number): Promise<void>; ///< this page's own edits have been answered, or are under way so long [ms]
  told(history: History): void;
}

type Way = "undo" | "redo";
const words = {
  undo: { verb: "Undo", done: "Undone", keys: "Ctrl+Z" },
  redo: { verb: "Redo", done: "Redone", keys: "Ctrl+Shift+Z" },
};

/// An edit that is built for longer [ms] is given up by the server for an undo, which takes nothing else back.
const kept = 1000;

/// A text field undoes what is typed in it itself.
const isText = (target: EventTarget | null): boolean =>
  (target instanceof HTMLInputElement && !["range", "checkbox", "button"].includes(target.type)) ||
  target instanceof HTMLTextAreaElement ||
  (target instanceof HTMLElement && target.isContentEditable);

function wayOf({ key, shiftKey }: KeyboardEvent): Way | null {
  if (key.toLowerCase() === "z") return shiftKey ? "redo" : "undo";
  return key.toLowerCase() === "y" ? "redo" : null;
}

/// What was done last, and is no change of the scene.
export interface Deed {
  name: string;
  undo(): void;
}
/// The server names so the change of the scene that comes with going back.
export const goingOn = "Go on from";

export class Undo {
  private history: History | null = null;
  private deed: Deed | null = null;
  private enabled = false;
  private client = 0;

  constructor(private readonly host: UndoHost) {
    for (const way of ["undo", "redo"] as const) button(way).onclick = () => void this.go(way);
    // In the capture phase, as the panel keeps the keys of its rows to itself.
    addEventListener("keydown", (event) => this.key(event), { capture: true });
    this.show();
  }

  private key(event: KeyboardEvent): void {
    const way = wayOf(event);
    if (!way || !(event.ctrlKey || event.metaKey) || event.altKey || isText(event.target)) return;
    if (document.querySelector("dialog[open]")) return;
    event.preventDefault();
    void this.go(way);
  }

  /// The number of this client, and whether it may change anything.
  greeted(client: number): void {
    this.client = client;
    this.history = null; // the next to come tells nothing new
  }

  enable(enabled: boolean): void {
    this.enabled = enabled;
    this.show();
  }

  told(history: History): void {
    const { last } = history;
    if (this.history && last) this.name(last);
    if (last && !last.name.startsWith(goingOn)) this.deed = null;
    this.history = history;
    this.show();
    this.host.told(history);
  }

  // What others do is named, and this viewer's own undoing: his changes he sees in the panel.
  private name({ what, name, by }: NonNullable<History["last"]>): void {
    const another = by !== this.client;
    if (what === "change") {
      if (another) notice("info", { title: `${name}, by another viewer` });
    } else notice("info", { title: `${words[what].done}: ${name}`, lines: another ? ["By another viewer."] : [] });
  }

  /// This is the next to undo, until the scene changes; null: nothing but changes of the scene is.
  offer(deed: Deed | null): void {
    this.deed = deed;
    this.show();
  }

  /// Undoes or redoes a change. With a revision only if nobody has changed the scene since.
  async go(way: Way, revision?: number): Promise<void> {
    await this.host.settled(way === "undo" ? kept : undefined);
    if (!this.enabled) return;
    if (way === "undo" && this.deed && revision === undefined) return this.deed.undo();
    try {
      const { applies } = await this.host.request<{ applies: string }>(`scene.${way}`, revision ? { revision } : {});
      showApplied(applies);
    } catch (error) {
      // What is told of the history may be older than a key that is pressed twice.
      if (error instanceof RpcError && error.code === errorNothingThere) return;
      noticeError(`Not ${words[way].done.toLowerCase()}`, error as Error);
    }
  }

  private show(): void {
    for (const way of ["undo", "redo"] as const) {
      const { verb, keys } = words[way];
      const name = (way === "undo" && this.deed?.name) || (this.history?.[way] ?? null);
      const control = button(way);
      // Stays a place for the focus when there is nothing left to undo.
      control.disabled = !this.enabled;
      control.setAttribute("aria-disabled", String(name === null));
      control.setAttribute("aria-label", name === null ? verb : `${verb}: ${name}`);
      control.title = `${name === null ? `Nothing to ${way}` : `${verb}: ${name}`} (${keys})`;
    }
  }
}
