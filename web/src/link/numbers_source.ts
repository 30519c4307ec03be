// Learns which vertex in frames each vertex of a mesh's file is, of the cloths for which sim.status says that some have
// another number there.
import { joined, uints } from "./arrays";
import { type Ask, askParts } from "./inspect_parts";
import type { ClothRange, Topology } from "./protocol";

/// In sim.status.
export interface Renumbered {
  topology_revision: number;
  cloths: number[];
}

export interface NumbersHost {
  ask: Ask;
  topology(): Topology | null;
  arrived(): void; ///< ClothRange.numbers of the topology has changed
}

const retryAfter = 2000; // [ms]

export class NumbersSource {
  mayAsk = false; ///< the server answers inspect.vertices: a relay does not
  private readonly asked = new WeakSet<ClothRange>();

  constructor(private readonly host: NumbersHost) {}

  told(renumbered: Renumbered | undefined): void {
    const topology = this.host.topology();
    if (!topology || renumbered?.topology_revision !== topology.revision) return;
    const unknown = topology.cloths.map((range, cloth) => ({ range, cloth })).filter(({ range }) => !range.numbers);
    if (unknown.length === 0) return;
    for (const { range, cloth } of unknown)
      if (!renumbered.cloths.includes(cloth)) range.numbers = "same";
      else if (this.mayAsk && !this.asked.has(range)) void this.ask(topology.revision, cloth, range);
    if (unknown.some(({ range }) => range.numbers)) this.host.arrived();
  }

  private async ask(revision: number, cloth: number, range: ClothRange): Promise<void> {
    this.asked.add(range);
    try {
      const found = await askParts(this.host.ask, "inspect.vertices", revision, { cloth });
      if (!found) return; // there is another cloth by now, with a status of its own
      range.numbers = joined(
        found.map((part) => uints(part.vertices)),
        Uint32Array,
      );
      this.host.arrived();
    } catch {
      // The server is away, or is asked too much: a later status asks again.
      setTimeout(() => this.asked.delete(range), retryAfter);
    }
  }
}
