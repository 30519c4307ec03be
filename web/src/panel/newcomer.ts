// A browser that has not been here: it gets a scene that shows what this is, where nobody misses the one that is there,
// and the first steps, which the help's button brings back.
import { button, element } from "./dom";
import type { FirstSteps } from "./first_steps";
import { inBrowser } from "../link/kept";
import type { Patch, SceneDocument } from "../link/scene_types";

/// pull: the cloth was pulled; mend: it blew up and stands again; lab: the lab was opened.
export type Step = "pull" | "mend" | "lab";

export interface FirstStepsHost {
  mayEdit(): boolean;
  blowUp(): void;
  lab(): void;
  load(preset: string): void;
  gallery(): void;
  changed(): void; ///< the card came, went, or has another size
}

export interface FirstSceneHost {
  alone(): boolean; ///< nobody else watches the session
  patch(patch: Patch, revision: number, name: string): Promise<unknown>;
  hold(held: boolean): void; ///< frames are not drawn: another scene comes
}

/// The preset of a first visit: within a second cloth falls over a ball. It computes in real time without a GPU, and
/// has a longest stable step, beyond which the second step goes.
const firstScene = "drape";

export class Newcomer {
  private due = inBrowser.get("clothlab-first-steps") === null; // a browser that keeps nothing shows them each time
  private sceneDue = false;
  private card: FirstSteps | null = null;

  constructor(
    private readonly host: FirstStepsHost,
    private readonly scenes: FirstSceneHost,
  ) {
    button("first-steps-again").onclick = () => {
      element("help-dialog", HTMLDialogElement).close();
      void this.show();
    };
  }

  /// To be called once the server has told this page's role. `untouched`: nobody has chosen the session's scene, and
  /// nobody has been there. Who names a session or a scene in the address has come for that.
  welcome(untouched: boolean): void {
    if (!this.due) return;
    this.due = false;
    this.sceneDue = untouched && this.host.mayEdit() && !location.search.includes("session=") && location.hash === "";
    if (this.sceneDue) this.scenes.hold(true);
    void this.show();
  }

  /// The session's scene has come, in this revision.
  async arrived(revision: number): Promise<void> {
    if (!this.sceneDue) return;
    this.sceneDue = false;
    try {
      const known = await fetch("scenes.json");
      const value = ((await known.json()) as { presets: Record<string, SceneDocument> }).presets[firstScene];
      // The server refuses the patch if anybody has changed the scene since.
      if (value && this.scenes.alone())
        await this.scenes.patch([{ op: "replace", path: "", value }], revision, `Load ${firstScene}`);
    } catch {
      // the scene stays that was there
    } finally {
      this.scenes.hold(false);
    }
  }

  did(step: Step): void {
    this.card?.did(step);
  }

  private async show(): Promise<void> {
    if (this.card) return;
    const { FirstSteps } = await import("./first_steps");
    this.card ??= new FirstSteps(this.host, () => (this.card = null));
  }
}
