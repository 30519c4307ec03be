// The page's copy of the scene: what the server last said, and the edits on their way to it.
// Edits to the same place are coalesced to one message per `sendEvery`; the last value is always sent.
import { applyPatch, valueAt } from "./json_patch";
import type { Operation, Patch, SceneDocument } from "./scene_types";

const sendEvery = 50; // [ms]
const oneChange = 2000; // [ms] between edits that are one change to a person: a slider that is dragged

export interface StoreEvents {
  send(patch: Patch): Promise<{ revision?: number; applies?: string }>;
  fetch(): Promise<void>;
  changed(document: SceneDocument, whole: boolean): void;
  applied(depth: string): void;
  wayBack(operations: Operation[]): void; ///< of the changes that this page made last
  rejected(error: Error): void;
}

export class SceneStore {
  document: SceneDocument | null = null;
  revision = 0;
  private readonly queue = new Map<string, Operation>();
  private inFlight: Operation[] | null = null;
  private timer = 0;
  private lastSent = -Infinity;
  private readonly before = new Map<string, Operation>(); // the last change, undone

  constructor(private readonly events: StoreEvents) {}

  /// The whole document came: `scene` or the answer of `scene.get`.
  replace(document: SceneDocument, revision: number): void {
    this.document = document;
    this.revision = revision;
    this.events.changed(document, true);
  }

  /// A patch came, ours or somebody else's; each revision is applied once, whichever message tells of it first.
  patched(revision: number, patch: Patch): void {
    if (!this.document || revision <= this.revision) return;
    // Defaults the server filled in are not in the patch: anything but plain values is fetched whole.
    if (revision !== this.revision + 1 || !isPlain(patch)) {
      void this.events.fetch();
      return;
    }
    this.document = applyPatch(this.document, patch);
    this.revision = revision;
    this.events.changed(this.document, false);
  }

  edit(operations: Operation[]): void {
    for (const operation of operations) {
      for (const path of this.queue.keys()) {
        if (path === operation.path || path.startsWith(operation.path + "/")) this.queue.delete(path);
      }
      this.queue.set(operation.path, operation);
    }
    this.schedule();
  }

  /// True while a change at or below `path` has not been answered yet: the control there leads, the document follows.
  busy(path: string): boolean {
    const touches = (operation: Operation) => operation.path === path || path.startsWith(operation.path + "/");
    return [...this.queue.values()].some(touches) || (this.inFlight?.some(touches) ?? false);
  }

  /// The connection was lost: what was not sent is dropped, the next `scene` tells the truth.
  forget(): void {
    this.queue.clear();
    clearTimeout(this.timer);
    this.timer = 0;
  }

  private schedule(): void {
    if (this.timer || this.inFlight || this.queue.size === 0) return;
    const wait = Math.max(0, this.lastSent + sendEvery - performance.now());
    this.timer = window.setTimeout(() => void this.flush(), wait);
  }

  private remember(operations: Operation[]): void {
    for (const operation of operations) {
      if (!this.document || this.before.has(operation.path)) continue;
      const back = inverse(this.document, operation);
      if (back) this.before.set(operation.path, back);
    }
  }

  private async flush(): Promise<void> {
    this.timer = 0;
    if (performance.now() - this.lastSent > oneChange) this.before.clear();
    this.lastSent = performance.now();
    const operations = [...this.queue.values()];
    this.queue.clear();
    this.inFlight = operations;
    this.remember(operations);
    try {
      const answer = await this.events.send(operations);
      this.inFlight = null;
      if (answer.revision !== undefined) this.patched(answer.revision, operations);
      if (answer.applies) this.events.applied(answer.applies);
      this.events.wayBack([...this.before.values()].reverse());
    } catch (error) {
      this.inFlight = null;
      this.events.rejected(error as Error);
    }
    this.schedule();
  }
}

/// The operation that brings back what one changes; null where it cannot be told.
function inverse(document: SceneDocument, { op, path }: Operation): Operation | null {
  if (op !== "replace" && op !== "add" && op !== "remove") return null;
  const value = valueAt(document, path);
  if (value === undefined) return { op: "remove", path };
  return { op: op === "remove" ? "add" : "replace", path, value };
}

const isScalar = (value: unknown): boolean => typeof value !== "object" || value === null;

function isPlain(patch: Patch): boolean {
  if (Array.isArray(patch)) return patch.every((operation) => operation.op === "replace" && isScalar(operation.value));
  return Object.values(patch).every(
    (value) =>
      value !== null && (Array.isArray(value) ? value.every(isScalar) : isScalar(value) || isPlain(value as Patch)),
  );
}
