// Values that browser tests read; nothing in the page depends on them.
import type { Frame } from "./link/protocol";
import type { SceneDocument } from "./link/scene_types";
import type { Stage } from "./view/stage";

interface TestHook {
  framesReceived: number;
  framesDrawn: number;
  simTime: number; ///< of the last frame drawn [s]
  step: number;
  lastFrame: Frame | null;
  firstFrameAt: number; ///< [ms] since navigation; 0 before the first frame
  document: SceneDocument | null;
  stage: Stage | null;
}

declare global {
  interface Window {
    clothlab: TestHook;
  }
}

export const hook: TestHook = (window.clothlab = {
  framesReceived: 0,
  framesDrawn: 0,
  simTime: 0,
  step: 0,
  lastFrame: null,
  firstFrameAt: 0,
  document: null,
  stage: null,
});
