// The button that shares the session and its scene; what it opens is loaded with its first press.
import { button } from "./dom";
import type { SceneDocument } from "../link/scene_types";

export function bindShare(scene: () => SceneDocument | null): void {
  button("share").onclick = async () => {
    const { openShare } = await import("./share");
    const shared = scene();
    if (shared) await openShare(shared);
  };
}
