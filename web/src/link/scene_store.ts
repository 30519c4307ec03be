// The page's copy of the scene: the server's last document, and the edits on their way to the server.
// Edits to the same place are merged into one message per `sendEvery`; the last value is always sent.
import { addressed, type LeftToFabric, withFabrics } from "./fabrics";
import { applyPatch } from "./json_patch";
import type { Operation, Patch, SceneDocument } from "./scene_types";

const sendEvery = 50; // [ms]

/// To a patch. `solver`: the server has changed it, too, so that the cloth holds.
interface Answer {
  revision?: number;
  applies?: string;
  solver?: SceneDocument["solver"];
}

export interface StoreEvents {
  send(patch: Patch, keepStable: boolean): Promise<Answer>;
  fetch(): Promise<void>;
  changed(document: SceneDocument, whole: boolean): void;
  applied(depth: string): void;
  kept(solver: SceneDocument["solver"], revision: number): void; ///< stable, by another solver
  rejected(error: Error, operations: Operation[]): void;
}

export class SceneStore {
  document: SceneDocument | null = null; ///< as it is shown, with the numbers that it leaves to fabrics
  stored: SceneDocument | null = null; ///< as the server keeps it
  revision = 0;
  private left: LeftToFabric[] = [];
  private readonly queue = new Map<string, Operation>();
  private inFlight: Operation[] | null = null;
  private keepStable = false;
  private timer = 0;
  private lastSent = -Infinity;

  constructor(private readonly events: StoreEvents) {}

  /// Takes a whole document, from `scene` or from the answer to `scene.get`.
  replace(document: SceneDocument, revision: number): void {
    this.take(document, revision, true);
  }

  private take(stored: SceneDocument, revision: number, whole: boolean): void {
    this.stored = stored;
    this.revision = revision;
    this.document = withFabrics(stored, this.left);
    this.events.changed(this.document, whole);
  }

  /// Takes the numbers that the document leaves to fabrics.
  fabricsGive(left: LeftToFabric[]): void {
    if (JSON.stringify(left) === JSON.stringify(this.left)) return;
    this.left = left;
    if (this.stored) this.take(this.stored, this.revision, false);
  }

  /// Takes a patch, this page's or another viewer's. A revision is applied once, though several messages may tell it.
  patched(revision: number, patch: Patch): void {
    if (!this.stored || revision <= this.revision) return;
    // A patch lacks the defaults that the server filled in: anything but plain values in places of plain values makes
    // the page fetch the document.
    if (revision !== this.revision + 1 || !isPlain(patch, this.stored)) {
      void this.events.fetch();
      return;
    }
    this.take(applyPatch(this.stored, patch), revision, false);
  }

  /// `keepStable`: the server may change the solver with it, so that the cloth holds.
  edit(operations: Operation[], keepStable = false): void {
    this.keepStable ||= keepStable;
    for (const operation of operations) {
      for (const path of this.queue.keys()) {
        if (path === operation.path || path.startsWith(operation.path + "/")) this.queue.delete(path);
      }
      this.queue.set(operation.path, operation);
    }
    this.schedule();
  }

  /// The document as it will be shown once the edits on their way are applied: what another edit is made for.
  get expected(): SceneDocument | null {
    const more = [...(this.inFlight ?? []), ...this.queue.values()];
    if (!this.document || more.length === 0) return this.document;
    try {
      return applyPatch(this.document, more);
    } catch {
      return this.document; // one of them is in a place that the server alone knows
    }
  }

  /// True while a change at or below `path` is unanswered: the control there keeps its value until the answer comes.
  busy(path: string): boolean {
    const touches = (operation: Operation) => operation.path === path || path.startsWith(operation.path + "/");
    return [...this.queue.values()].some(touches) || (this.inFlight?.some(touches) ?? false);
  }

  /// Waits until all edits are answered, so that what undoes the last change meets it; for one that has been sent, at
  /// most `longest` [ms].
  async settled(longest = Infinity): Promise<void> {
    const since = performance.now();
    while (this.queue.size > 0 || (this.inFlight && performance.now() - since < longest))
      await new Promise((resolve) => setTimeout(resolve, sendEvery / 2));
  }

  /// The connection was lost: drops unsent edits, as the next `scene` brings the server's document.
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

  /// Operations on `document` as ones on `stored`.
  addressed(operations: Operation[]): Operation[] {
    return this.stored && this.document ? addressed(this.stored, this.document, operations) : operations;
  }

  private async flush(): Promise<void> {
    this.timer = 0;
    this.lastSent = performance.now();
    const operations = this.addressed([...this.queue.values()]);
    this.queue.clear();
    this.inFlight = operations;
    const { keepStable } = this;
    this.keepStable = false;
    try {
      const { solver, ...answer } = await this.events.send(operations, keepStable);
      this.inFlight = null;
      const more = Object.entries(solver ?? {}).map(
        ([key, value]): Operation => ({ op: "replace", path: `/solver/${key}`, value }),
      );
      if (answer.revision !== undefined) this.patched(answer.revision, [...operations, ...more]);
      if (answer.revision !== undefined && solver) this.events.kept(solver, answer.revision);
      if (answer.applies) this.events.applied(answer.applies);
    } catch (error) {
      this.inFlight = null;
      this.events.rejected(error as Error, operations);
    }
    this.schedule();
  }
}

const isScalar = (value: unknown): boolean => typeof value !== "object" || value === null;

function isPlain(patch: Patch, document: SceneDocument): boolean {
  if (Array.isArray(patch)) return patch.every((operation) => operation.op === "replace" && isScalar(operation.value));
  const replaces = (value: unknown, present: unknown): boolean => {
    if (value === null || present === undefined) return false;
    if (Array.isArray(value)) return value.every(isScalar);
    if (isScalar(value)) return true;
    if (typeof present !== "object" || present === null) return false;
    return Object.entries(value as object).every(([key, of]) =>
      replaces(of, (present as Record<string, unknown>)[key]),
    );
  };
  return replaces(patch, document);
}
