// Loads a whole scene that came from outside, and offers the way back to the one before.
import { type Applied, type TextHost, tooLarge } from "./host";
import { notice, noticeError } from "../panel/notices";
import type { SceneDocument } from "../link/scene_types";

/// Throws an Error that says why it is not loaded; the scene before then runs on.
export async function load(scene: SceneDocument, host: TextHost): Promise<void> {
  if (!host.mayEdit()) throw new Error("You are a viewer of this session: only operators may load a scene.");
  const large = tooLarge(scene, host);
  if (large) throw new Error(large);
  const before = host.stored()?.document;
  await host.request<Applied>("scene.load", { scene });
  const back = (): void =>
    void host
      .request("scene.load", { scene: before })
      .catch((error: Error) => noticeError("The scene before was refused", error));
  notice("info", {
    title: `${scene.name || "The scene"} is loaded`,
    lines: ["For everybody in this session."],
    actions: before ? [{ label: "Back to the scene before", run: back }] : [],
  });
}
