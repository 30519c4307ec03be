// The buttons that save the scene, as a picture or a video, and the cloths as a model. What they do is loaded
// with the first press.
import { button } from "./dom";
import { noticeError } from "./notices";
import type { ScreenSaver } from "./screen_saver";
import type { Stage } from "../view/stage";

export interface Screen {
  stage: Stage;
  sceneName(): string;
  get(path: string): Promise<ArrayBuffer>; ///< of the session
}

export function bindSaveButtons(screen: Screen): void {
  let loading: Promise<ScreenSaver> | null = null;
  const use = (act: (saver: ScreenSaver) => void): void => {
    loading ??= import("./screen_saver").then((loaded) => new loaded.ScreenSaver(screen));
    loading.then(act).catch((error: Error) => {
      loading = null;
      noticeError("Not saved", error);
    });
  };
  button("save-picture").onclick = () => use((saver) => saver.savePicture());
  button("save-model").onclick = () => use((saver) => void saver.saveModel());
  button("save-video").onclick = () => use((saver) => saver.toggleVideo());
}
