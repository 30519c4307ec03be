// The page's copy of the scene: what the server last said, and the edits on their way to it.
// Edits to the same place are coalesced to one message per `sendEvery`; the last value is always sent.
import { applyPatch } from "./json_patch";
import type { Operation, Patch, SceneDocument } from "./scene_types";

const sendEvery = 50;  // [ms]

export interface StoreEvents {
  send(patch: Patch): Promise<{ revision?: number; applies?: string }>;
  fetch(): Promise<void>;
  changed(document: SceneDocument, whole: boolean): void;
  applied(depth: string): void;
  rejected(error: Error): void;
}

export class SceneStore {
  document: SceneDocument | null = null;
  revision = 0;
  private readonly queue = new Map<string, Operation>();
  private inFlight: Operation[] | null = null;
  private timer = 0;
  private lastSent = -Infinity;

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

  private async flush(): Promise<void> {
    this.timer = 0;
    this.lastSent = performance.now();
    const operations = [...this.queue.values()];
    this.queue.clear();
    this.inFlight = operations;
    try {
      const answer = await this.events.send(operations);
      this.inFlight = null;
      if (answer.revision !== undefined) this.patched(answer.revision, operations);
      if (answer.applies) this.events.applied(answer.applies);
    } catch (error) {
      this.inFlight = null;
      this.events.rejected(error as Error);
    }
    this.schedule();
  }
}

const isScalar = (value: unknown): boolean => typeof value !== "object" || value === null;

function isPlain(patch: Patch): boolean {
  if (Array.isArray(patch)) return patch.every((operation) => operation.op === "replace" && isScalar(operation.value));
  return Object.values(patch).every((value) =>
    value !== null && (Array.isArray(value) ? value.every(isScalar) : isScalar(value) || isPlain(value as Patch)));
}
