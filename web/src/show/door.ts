// The way to the show of a blow-up, which is loaded when there is something to show.
import type { Frame } from "../link/protocol";
import type { SceneDocument } from "../link/scene_types";
import type { Status } from "../panel/hud";
import { type Diverged, noticeError } from "../panel/notices";
import { lateStyle } from "../panel/late_style";
import type { Picture } from "../picture";
import type { Show } from "./show";

/// What makes the scene fail, done while the session stands still.
export interface Cause {
  /// Resolves when the scene stands that will fail. `limit` waits for the longest stable step [s] of the scene as it is
  /// then.
  apply(limit: () => Promise<number>): Promise<unknown>;
  /// Makes it worse: the scene has held for a while.
  more?: () => Promise<unknown>;
  failed?: SceneDocument; ///< it has failed already, as this scene: the show goes back and looks again
}

export interface ShowHost {
  request<T>(method: string, params?: Record<string, unknown>): Promise<T>;
  picture: Picture;
  remedy(diverged: Diverged): Promise<unknown>;
  play(): void;
  opened(): void; ///< the show begins: the picture needs the room
  changed(): void; ///< its card came, went, or has another size
  ended(diverged: Diverged | null): void; ///< `diverged`: nobody has applied the remedy
}

export class ShowDoor {
  private show: Show | null = null;
  private loading = false;

  constructor(private readonly host: ShowHost) {}

  /// True while the session is stepped to be looked at, or what was seen is on screen.
  get on(): boolean {
    return this.loading || this.show !== null;
  }

  begin(cause: Cause): void {
    if (this.on) return;
    this.loading = true;
    Promise.all([import("./show"), lateStyle("show.css")])
      .then(([{ Show }]) => {
        this.show = new Show(this.host, () => (this.show = null));
        return this.show.run(cause);
      })
      .catch((error: Error) => noticeError("The blow-up could not be shown", error))
      .finally(() => (this.loading = false));
  }

  frame(frame: Frame): void {
    this.show?.frame(frame);
  }
  status(status: Status): void {
    this.show?.status(status);
  }
  diverged(diverged: Diverged): void {
    this.show?.diverged(diverged);
  }
  lost(): void {
    this.show?.close();
  }
}
