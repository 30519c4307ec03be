// The pins of the scene as one points at them: which vertices they hold, and the one that is chosen, to be taken off.
import { heldInFrame } from "./pins";
import type { Picker } from "./picking";
import { Places } from "./places";
import type { Operation, SceneDocument } from "../link/scene_types";

export interface PinnedVertex {
  cloth: number;
  vertex: number; ///< in the frame
}

export class PinChoice {
  chosen: PinnedVertex | null = null;

  constructor(
    private readonly picker: Picker,
    private readonly document: () => SceneDocument | null,
  ) {}

  /// All that pins hold.
  get all(): PinnedVertex[] {
    const ranges = this.picker.topology?.cloths ?? [];
    return (this.document()?.cloths ?? []).flatMap((of, cloth) => {
      const range = ranges[cloth];
      if (!range) return [];
      return [...heldInFrame(of, range)].map((vertex) => ({ cloth, vertex }));
    });
  }

  get vertices(): Set<number> {
    return new Set(this.all.map(({ vertex }) => vertex));
  }

  /// The pin that is seen nearest to this point of the canvas, within `reach` [CSS pixels].
  at(x: number, y: number, reach: number): PinnedVertex | null {
    const { frame } = this.picker;
    if (!frame) return null;
    const places = new Places(frame);
    let best: PinnedVertex | null = null;
    let least = reach;
    for (const pin of this.all) {
      const at = this.picker.onScreen(places.of(pin.vertex));
      const far = at ? Math.hypot(at.x - x, at.y - y) : Infinity;
      if (far <= least) [best, least] = [pin, far];
    }
    return best;
  }

  next(): PinnedVertex | null {
    const pins = this.all;
    const at = pins.findIndex(({ vertex }) => vertex === this.chosen?.vertex);
    return pins[(at + 1) % pins.length] ?? null;
  }

  /// The pin in the list of its cloth that holds what is chosen, the last if there are several, taken off whole: it may
  /// hold a row.
  removal(): Operation[] {
    const of = this.chosen && this.document()?.cloths[this.chosen.cloth];
    const range = this.chosen && this.picker.topology?.cloths[this.chosen.cloth];
    if (!this.chosen || !of || !range) return [];
    const { cloth, vertex } = this.chosen;
    const holds = of.pins.map((pin) => heldInFrame({ ...of, pins: [pin] }, range).has(vertex));
    const index = holds.lastIndexOf(true);
    return index < 0 ? [] : [{ op: "remove", path: `/cloths/${cloth}/pins/${index}` }];
  }
}
