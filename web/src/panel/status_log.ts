// What sim.status told in the last minute, for the curves of See inside.
import type { Status } from "./hud";

const longest = 60_000; // [ms]

/// A status that came at a time on the clock of performance.now() [ms].
export interface Told {
  at: number;
  status: Status;
}

export class StatusLog {
  told: Told[] = []; ///< the oldest first

  take({ time, playing, real_time_factor, energy, max_strain }: Status, at = performance.now()): void {
    this.told.push({ at, status: { time, playing, real_time_factor, energy, max_strain } });
    while (at - (this.told[0] as Told).at > longest) this.told.shift();
  }
}
