// One comparison at the lab: the request, how far it is, what it has found, and its moments as they come.
import { Moments, type MomentsAnswer } from "./moments";
import type { CompareResult } from "./words";
import type { RpcErrorData } from "../link/rpc";
import { RpcError } from "../link/rpc";
import { sentence } from "../lab/text";
import type { Patch } from "../link/scene_types";

const rate = 25; // moments a simulated second: 40 ms, which most steps divide

interface JobHost {
  request<T>(method: string, params: Record<string, unknown>): Promise<T>;
  changed(): void;
}

interface Told {
  job: number;
  state: "queued" | "running" | "finished" | "cancelled" | "failed";
  ahead?: number;
  doing?: string;
  result?: CompareResult | null;
  error?: RpcErrorData;
}

/// What is wrong, as a sentence or two.
export function faultText({ path = "", found = "", allowed = "" }: RpcErrorData): string {
  const where = path === "truth" ? "No truth" : path === "lab" || path === "" ? "" : path;
  const what = where === "" ? found : `${where}: ${found}`;
  return allowed === "" ? sentence(what) : `${sentence(what)} Allowed, or what to do: ${sentence(allowed)}`;
}

export class Job {
  working = false;
  doing = "";
  wrong = "";
  result: CompareResult | null = null;
  moments: Moments | null = null;
  private id: number | null = null;
  private readonly early: ["progress" | "result", Record<string, unknown>][] = [];
  private run = 0; // which request counts
  private fetching = false;
  private news: CompareResult | null = null; // its moments are not all here yet
  private ended = false;

  constructor(private readonly host: JobHost) {}

  start(params: { patch: Patch; truth: boolean; time: number }): void {
    this.forget();
    const run = ++this.run;
    this.working = true;
    this.doing = "Starting…";
    this.host.changed();
    this.host.request<{ job: number; ahead: number }>("lab.compare", { ...params, rate }).then(
      ({ job, ahead }) => {
        if (run !== this.run) void this.host.request("lab.cancel", { job }).catch(() => undefined);
        else this.take(job, ahead);
      },
      (error: Error) => {
        if (run !== this.run) return;
        this.end(error instanceof RpcError && error.data.path ? faultText(error.data) : error.message);
      },
    );
  }

  cancel(): void {
    if (this.id !== null) void this.host.request("lab.cancel", { job: this.id }).catch(() => undefined);
  }

  /// Ends it, and forgets what it has found.
  forget(): void {
    if (this.working) this.cancel();
    this.run++;
    this.id = null;
    this.early.length = 0;
    this.working = this.ended = false;
    this.wrong = "";
    this.result = this.news = this.moments = null;
  }

  lost(): void {
    if (this.working) this.end("The connection was lost, and the comparison with it: start it again.");
    this.id = null; // nothing more can be asked about it
  }

  told(method: "progress" | "result", params: Record<string, unknown>): void {
    const told = params as unknown as Told;
    if (this.working && this.id === null) this.early.push([method, params]); // the answer names the job
    if (told.job !== this.id) return;
    if (method === "progress") {
      this.doing = told.state === "queued" ? waiting(told.ahead ?? 0) : sentence(told.doing ?? "");
      this.host.changed();
      return;
    }
    this.ended = told.state !== "running";
    if (told.state === "failed") this.wrong = faultText(told.error ?? {});
    if (told.result) this.news = told.result;
    void this.fetch();
  }

  private take(job: number, ahead: number): void {
    this.id = job;
    this.doing = waiting(ahead);
    this.host.changed();
    for (const [method, params] of this.early.splice(0)) this.told(method, params);
  }

  private end(wrong: string): void {
    this.working = false;
    this.wrong = wrong;
    this.host.changed();
  }

  // Asks for the moments that have been told and are not here; then the figures of those are shown.
  private async fetch(): Promise<void> {
    if (this.fetching) return;
    const { run } = this;
    this.fetching = true;
    try {
      while (run === this.run && this.news && this.id !== null) {
        const { news } = this;
        this.moments ??= new Moments(news.rate, news.vertices);
        if (this.moments.count >= news.times_s.length) break;
        const from = this.moments.count;
        const answer = await this.host.request<MomentsAnswer>("lab.moments", { job: this.id, from });
        if (run !== this.run) return;
        this.moments.append(answer);
        this.show();
      }
      if (run === this.run) this.show();
    } catch (error) {
      if (run === this.run) this.end(`The positions did not come: ${(error as Error).message}`);
    } finally {
      this.fetching = false;
      if (run !== this.run && this.news) void this.fetch();
    }
  }

  private show(): void {
    const { news, moments } = this;
    if (news && moments) {
      const here = <T>(of: T[]): T[] => of.slice(0, moments.count);
      this.result = { ...news, times_s: here(news.times_s), rms_m: here(news.rms_m), most_m: here(news.most_m) };
    }
    if (this.ended && (!news || (moments && moments.count >= news.times_s.length))) this.working = false;
    this.host.changed();
  }
}

function waiting(ahead: number): string {
  if (ahead === 0) return "Starting…";
  return `Waits for ${ahead === 1 ? "one other measurement" : `${ahead} other measurements`}.`;
}
