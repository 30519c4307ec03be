// The lab's jobs as this page knows them: at most one of each kind, from the request to its result.
import type { RpcErrorData } from "../link/rpc";
import { RpcError } from "../link/rpc";
import type { Arrival, Axis, Kind, Progress, Results } from "./types";

/// asked: the server has not answered yet; lost: the connection closed, and the job ended with it.
export type State = "idle" | "asked" | "queued" | "running" | "finished" | "cancelled" | "failed" | "lost";
export type Format = "json" | "csv" | "svg";

export interface Job<K extends Kind = Kind> {
  kind: K;
  state: State;
  id: number | null;
  ahead: number; ///< jobs before it in the queue
  done: number;
  total: number;
  doing: string;
  stale: boolean;
  cached: boolean;
  beside: boolean;
  result: Results[K] | null; ///< while the next job is measured, still the result of the last one
  ofJob: number | null; ///< the job that `result` comes from
  error: RpcErrorData | null;
}

export const working = ({ state }: Job): boolean => state === "asked" || state === "queued" || state === "running";

export interface JobEvents {
  request<T>(method: string, params: Record<string, unknown>): Promise<T>;
  changed(kind: Kind): void;
  refused(error: RpcError): void;
}

const kinds: Kind[] = ["chart", "stability", "choose", "simplify"];
const staleDelay = 300; // [ms] after a change: by then a moved slider is at rest

function fresh<K extends Kind>(kind: K): Job<K> {
  return {
    kind,
    state: "idle",
    id: null,
    ahead: 0,
    done: 0,
    total: 1,
    doing: "",
    stale: false,
    cached: false,
    beside: false,
    result: null,
    ofJob: null,
    error: null,
  };
}

export class Jobs {
  private readonly jobs = Object.fromEntries(kinds.map((kind) => [kind, fresh(kind)])) as { [K in Kind]: Job<K> };
  private timer = 0;

  constructor(private readonly events: JobEvents) {}

  of<K extends Kind>(kind: K): Job<K> {
    return this.jobs[kind];
  }

  async start(kind: Kind, params: Record<string, unknown>): Promise<void> {
    const job = this.of(kind) as Job;
    const before = { ...job };
    Object.assign(job, { state: "asked", id: null, ahead: 0, done: 0, total: 1, doing: "", error: null });
    this.events.changed(kind);
    try {
      const { job: id, ahead } = await this.events.request<{ job: number; ahead: number; cached: boolean }>(
        `lab.${kind}`,
        params,
      );
      if (job.state === "asked") Object.assign(job, { id, ahead, state: ahead > 0 ? "queued" : "running" });
    } catch (error) {
      if (job.state !== "asked") return; // the job was lost with the connection, and the page says so already
      Object.assign(job, before);
      if (error instanceof RpcError) this.events.refused(error);
    }
    this.events.changed(kind);
  }

  async cancel(kind: Kind): Promise<void> {
    const { id } = this.of(kind);
    if (id === null) return;
    await this.events.request("lab.cancel", { job: id }).catch((error: unknown) => {
      // otherwise the job had ended before the request arrived
      if (error instanceof RpcError && working(this.of(kind) as Job)) this.events.refused(error);
    });
  }

  /// The result so far, as the text of a file.
  async exported(kind: Kind, format: Format, axis: Axis): Promise<string> {
    const { text } = await this.events.request<{ text: string }>("lab.export", {
      job: this.of(kind).ofJob,
      format,
      axis,
    });
    return text;
  }

  progress(progress: Progress): void {
    const job = this.adopt(progress.kind, progress.job);
    if (!job || !working(job)) return;
    const { state, ahead, done, total, doing, stale } = progress;
    Object.assign(job, { state, ahead, done, total, doing });
    if (job.ofJob === job.id) job.stale = stale;
    this.events.changed(job.kind);
  }

  arrived(arrival: Arrival): void {
    const job = this.adopt(arrival.kind, arrival.job);
    if (!job) return;
    const { state, stale, cached, beside, error = null, result } = arrival;
    Object.assign(job, { state, error });
    // A job that was cancelled or failed before its first result leaves the earlier result in place.
    if (result && hasContent(arrival)) Object.assign(job, { result, ofJob: arrival.job, stale, cached, beside });
    this.events.changed(job.kind);
  }

  /// The connection closed: its jobs end, the results they found stay.
  lost(): void {
    for (const kind of kinds) {
      const job = this.of(kind) as Job;
      if (!working(job) && job.ofJob === null) continue;
      Object.assign(job, { state: "lost", id: null, ofJob: null });
      this.events.changed(kind);
    }
  }

  /// Asks, `staleDelay` later, which results belong to an earlier scene.
  sceneChanged(): void {
    clearTimeout(this.timer);
    if (kinds.some((kind) => this.of(kind).ofJob !== null))
      this.timer = window.setTimeout(() => void this.refreshStale(), staleDelay);
  }

  private async refreshStale(): Promise<void> {
    type Listed = { jobs: { job: number; stale: boolean }[] };
    const listed = await this.events.request<Listed>("lab.jobs", {}).catch(() => null);
    for (const { job: id, stale } of listed?.jobs ?? []) {
      const job = kinds.map((kind) => this.of(kind) as Job).find(({ ofJob }) => ofJob === id);
      if (!job || job.stale === stale) continue;
      job.stale = stale;
      this.events.changed(job.kind);
    }
  }

  // Finds the job with this id. Its first message may arrive before the answer to the request, which names the id.
  private adopt(kind: Kind, id: number): Job | null {
    const job = this.jobs[kind] as Job | undefined;
    if (!job) return null;
    if (job.id === null && job.state === "asked") job.id = id;
    return job.id === id ? job : null;
  }
}

/// True if the result holds something to show.
function hasContent({ kind, result, state }: Arrival): boolean {
  if (state === "finished") return true;
  switch (kind) {
    case "chart":
      return ((result as Results["chart"]).points ?? []).length > 0;
    case "stability":
      return ((result as Results["stability"]).methods ?? []).some(({ columns }) => columns.length > 0);
    case "choose":
      return ((result as Results["choose"]).tried ?? []).length > 0;
    case "simplify":
      return ((result as Results["simplify"]).variants ?? []).length > 0;
  }
}
