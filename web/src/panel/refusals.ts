// Tells what the server refused. For surfaces that cross there are a picture and a way out.
import { tellCrossings } from "./crossings";
import { notice, noticeError } from "./notices";
import { type Crossings, errorGivenUp, RpcError } from "../link/rpc";
import type { Patch, SceneDocument } from "../link/scene_types";

interface Host {
  show(crossings: Crossings): void;
  hide(): void;
  send(patch: Patch): void;
  stored(): SceneDocument | null;
}

export class Refusals {
  private closeCrossings = (): void => undefined;
  private revision = 0;

  constructor(private readonly host: Host) {}

  /// Tells why the server refused a request, or a patch. One that is lost with its connection needs no notice: the
  /// banner reports the loss.
  tell(title: string, error: Error, patch?: Patch): void {
    if (!(error instanceof RpcError)) return;
    if (error.code === errorGivenUp) {
      notice("info", { title: error.message });
      return;
    }
    const close = patch ? tellCrossings(title, error, patch, this.host) : null;
    if (close) this.closeCrossings = close;
    else noticeError(title, error);
  }

  /// The scene is shown at this revision, all of it or what a patch changed. A refusal for crossings of another scene
  /// goes; it stays where a connection that came back brings the same scene again.
  sceneShown(revision: number, whole: boolean): void {
    if (whole && revision !== this.revision) this.closeCrossings();
    this.revision = revision;
  }
}
