// Tells what the server refused. For surfaces that cross there are a picture and a way out.
import { tellCrossings } from "./crossings";
import { noticeError } from "./notices";
import { type Crossings, RpcError } from "../link/rpc";
import type { Patch } from "../link/scene_types";

interface Host {
  show(crossings: Crossings): void;
  hide(): void;
  send(patch: Patch): void;
}

export class Refusals {
  private closeCrossings = (): void => undefined;

  constructor(private readonly host: Host) {}

  /// Tells why the server refused a request, or a patch. One that is lost with its connection needs no notice: the
  /// banner reports the loss.
  tell(title: string, error: Error, patch?: Patch): void {
    if (!(error instanceof RpcError)) return;
    const close = patch ? tellCrossings(title, error, patch, this.host) : null;
    if (close) this.closeCrossings = close;
    else noticeError(title, error);
  }

  /// Another scene is shown: a refusal for crossings of the last one goes.
  forget(): void {
    this.closeCrossings();
  }
}
