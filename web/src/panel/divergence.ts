// The notice of a simulation that has blown up: comes and goes with the server's status. While the show of it is on,
// that tells it.
import { saferStep } from "./gauge";
import type { Status } from "./hud";
import { clearDiverged, showDiverged, type Diverged } from "./notices";
import type { Patch } from "../link/scene_types";

export interface DivergenceHost {
  send(patch: Patch): Promise<unknown>;
  shown(): boolean; ///< the show is on
  mayShow(): boolean;
  show(): void; ///< begins it
  mended(): void; ///< the simulation runs again
}

export class Divergence {
  private toldOf = false;
  private diverged = false; // in the last status

  constructor(private readonly host: DivergenceHost) {}

  get now(): boolean {
    return this.diverged;
  }

  tell(diverged: Diverged): void {
    this.toldOf = true;
    // Once the patch is applied, the server continues from the last good state by itself.
    const show = this.host.mayShow() ? () => this.host.show() : null;
    showDiverged(diverged, async (patch) => void (await this.host.send(patch)), show);
  }

  // Shows and clears the notice by the status: another viewer may have applied the remedy, or the scene blew up before
  // this page was opened.
  follow({ diverged, stability }: Status): void {
    if (this.diverged && !diverged) {
      clearDiverged();
      this.toldOf = false;
      if (!this.host.shown()) this.host.mended();
    }
    this.diverged = diverged === true;
    if (!this.diverged || this.toldOf || this.host.shown()) return;
    const limit = stability?.dt_limit;
    const dt = limit ? saferStep(limit) : 0;
    this.tell({
      reason: "It stopped at its last good state before this page was opened",
      ...(dt > 0 ? { remedy: { text: `set dt to ${dt} s, below its limit`, patch: { solver: { dt } } } } : {}),
    });
  }
}
