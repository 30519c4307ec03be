// The scenes that come with the server: asked for once, in the panel's list and in the gallery.
import { openGallery } from "../gallery/door";
import type { Fabric } from "../link/fabrics";

/// The answer to `scene.presets`.
interface Answer {
  presets: string[];
  about?: Record<string, string>; ///< a sentence of each
  fabrics?: Fabric[];
}

export interface PresetsHost {
  ask(): Promise<Answer>;
  arrived(presets: string[], fabrics: Fabric[]): void;
  current(): string; ///< the name of the scene
  mayEdit(): boolean;
  load(name: string): void;
}

export class Presets {
  private presets: string[] = [];
  private about: Record<string, string> = {};

  constructor(private readonly host: PresetsHost) {}

  fetch(): void {
    this.host.ask().then(
      ({ presets, about = {}, fabrics = [] }) => {
        this.presets = presets;
        this.about = about;
        this.host.arrived(presets, fabrics);
      },
      () => undefined,
    );
  }

  openGallery(): void {
    openGallery({
      presets: this.presets.map((name) => ({ name, about: this.about[name] ?? "" })),
      current: this.host.current(),
      mayEdit: this.host.mayEdit(),
      load: (name) => this.host.load(name),
    });
  }
}
