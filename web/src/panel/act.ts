// Adds or removes a part of the scene, and offers the way back.
import { notice } from "./notices";
import type { Deed } from "./parts";
import { inverse } from "../link/json_patch";
import type { Patch, SceneDocument } from "../link/scene_types";

interface Host {
  stored(): SceneDocument | null;
  send(patch: Patch): Promise<unknown>;
  refused(title: string, error: Error, patch: Patch): void;
}

const toUndo = 14_000; // [ms]
let closeLast = (): void => undefined; // only the last change can be undone: others have moved its places in the lists

export function act({ says, change }: Deed, host: Host): void {
  const stored = host.stored();
  if (!stored) return;
  const send = (patch: Patch, done: () => void): void =>
    void host.send(patch).then(done, (error: Error) => host.refused("Not done", error, patch));
  const patch = change(stored);
  const back = patch.flatMap((operation) => inverse(stored, operation) ?? []).reverse();
  const undo = { label: "Undo", run: () => send(back, () => undefined) };
  send(patch, () => {
    closeLast();
    // A phone has room for one notice: a warning that comes meanwhile must not take the way back.
    const close = (closeLast = notice("info", {
      title: says,
      lines: ["For everybody here."],
      actions: [undo],
      stays: true,
    }));
    setTimeout(close, toUndo);
  });
}
