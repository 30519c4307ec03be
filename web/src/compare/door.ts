// The way to comparisons, which are loaded when somebody opens one or comes by a link with one.
import type { Comparison } from "./comparison";
import type { CompareHost, Wish } from "./host";
import { lateStyle } from "../panel/late_style";
import { noticeError } from "../panel/notices";

const key = "#compare=";

export class CompareDoor {
  private comparison: Comparison | null = null;
  private loading: Promise<typeof import("./comparison")> | null = null;

  constructor(private readonly host: CompareHost) {
    addEventListener("hashchange", () => this.arrived());
  }

  /// True while a comparison is drawn in the place of the session's cloth.
  get drawn(): boolean {
    return this.comparison?.drawn ?? false;
  }

  toggle(): void {
    this.with((comparison) => comparison.toggle());
  }

  /// Closes it: something else takes its room.
  shut(): void {
    if (this.comparison?.open) this.comparison.toggle();
  }

  /// Opens, with B as the wish says, and starts.
  begin(wish: Partial<Wish>): void {
    this.with((comparison) => comparison.begin(wish));
  }

  /// Called when the scene is there, and when the address changes: the address may carry a comparison.
  arrived(): void {
    // a scene that was put by for this session comes first
    if (!location.hash.startsWith(key) || history.state !== null) return;
    const fragment = location.hash;
    history.replaceState(history.state, "", location.pathname + location.search);
    this.with(async (comparison, { wishIn }) => comparison.propose(await wishIn(fragment, this.host.mostBytes())));
  }

  sceneChanged(): void {
    this.comparison?.sceneChanged();
  }

  /// Takes lab.progress and lab.result.
  told(method: "progress" | "result", params: Record<string, unknown>): void {
    if (params.kind === "compare") this.comparison?.told(method, params);
  }

  lost(): void {
    this.comparison?.lost();
  }

  private with(use: (comparison: Comparison, module: typeof import("./comparison")) => void | Promise<void>): void {
    this.loading ??= Promise.all([import("./comparison"), lateStyle("compare.css")]).then(([module]) => module);
    this.loading
      .then((module) => use((this.comparison ??= new module.Comparison(this.host)), module))
      .catch((error: Error) => {
        this.loading = null;
        noticeError("The comparison could not be opened", error);
      });
  }
}
