// Adds or removes a part of the scene, and offers the way back.
import { keptText } from "./kept_stable";
import { notice } from "./notices";
import type { Deed, Room } from "./parts";
import type { Patch, SceneDocument } from "../link/scene_types";

/// The answer to the patch. `solver`: the server has changed it, too, so that the cloth holds.
interface Done {
  revision: number;
  solver?: SceneDocument["solver"];
}

interface Host {
  room(): Room | null;
  stored(): SceneDocument | null;
  choose(body: number): void; ///< gives it handles, once it is there
  request<T>(method: string, params: Record<string, unknown>): Promise<T>;
  refused(title: string, error: Error, patch?: Patch): void;
}

const toUndo = 14_000; // [ms]
let closeLast = (): void => undefined; // the button of the last change is the only one

export function act({ says, change, keepStable, body }: Deed, host: Host): void {
  const stored = host.stored();
  if (!stored) return;
  const patch = change(stored, host.room() ?? { wide: () => 0, taken: () => [] });
  const done = ({ revision, solver }: Done): void => {
    // Of this change alone: after another one the server refuses it.
    const back = (): void =>
      void host
        .request("scene.undo", { revision })
        .catch((error: Error) => host.refused("The scene has changed since", error));
    closeLast();
    // A phone has room for one notice: a warning that comes meanwhile must not take the way back.
    const undo = { label: "Undo", run: back };
    const close = notice("info", {
      title: says,
      lines: ["For everybody here.", ...(solver ? [keptText(solver)] : [])],
      actions: [undo],
      stays: true,
    });
    closeLast = close;
    if (body) host.choose(stored.colliders.length);
    setTimeout(close, toUndo);
  };
  host
    .request<Done>("scene.patch", { patch, ...(keepStable && { keep_stable: true }) })
    .then(done, (error: Error) => host.refused("Not done", error, patch));
}
