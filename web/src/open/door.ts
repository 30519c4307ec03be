// The way to opening files: the button's choice of files, and what is dropped anywhere on the page. What asks about
// them is loaded then.
import type { Crossings } from "../link/rpc";
import type { Patch, SceneDocument } from "../link/scene_types";
import { lateStyle } from "../panel/late_style";
import { noticeError } from "../panel/notices";

export interface OpenHost {
  request<T>(method: string, params: Record<string, unknown>): Promise<T>;
  mayEdit(): boolean;
  stored(): SceneDocument | null;
  fabrics(): string[];
  presets(): string[];
  refused(title: string, error: Error, patch: Patch): void;
  showCrossings(crossings: Crossings): void;
  hideCrossings(): void;
  pause(): void;
  play(): void;
  fit(): void; ///< the scene has other cloths: all of it is to be seen
  scene(files: File[]): void; ///< one of these is a scene
}

async function load(): Promise<typeof import("./index")> {
  const [open] = await Promise.all([import("./index"), lateStyle("open.css")]);
  return open;
}

export class OpenDoor {
  private dragging = 0; // elements that the pointer with files is over

  constructor(private readonly host: OpenHost) {
    const carriesFile = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
    addEventListener("dragenter", (event) => {
      if (carriesFile(event) && ++this.dragging === 1) this.picture(true);
    });
    addEventListener("dragleave", (event) => {
      if (carriesFile(event) && --this.dragging === 0) this.picture(false);
    });
    addEventListener("dragover", (event) => {
      if (carriesFile(event)) event.preventDefault(); // else the browser would open the file
    });
    addEventListener("drop", (event) => {
      if (!carriesFile(event)) return;
      event.preventDefault();
      this.dragging = 0;
      this.picture(false);
      this.take([...(event.dataTransfer?.files ?? [])]);
    });
  }

  /// Lets the user choose files.
  choose(): void {
    const input = document.createElement("input");
    Object.assign(input, { type: "file", multiple: true, accept: ".obj,.ply,.glb,.gltf,.bin,.json" });
    input.onchange = () => this.take([...(input.files ?? [])]);
    input.click();
  }

  private take(files: File[]): void {
    if (files.length === 0) return;
    if (files.some(({ name }) => /\.json$/i.test(name))) {
      this.host.scene(files);
      return;
    }
    load()
      .then(({ openFiles }) => openFiles(files, this.host))
      .catch((error: Error) => noticeError("The files could not be opened", error));
  }

  // Where the files go, while they hang over the page.
  private picture(shown: boolean): void {
    load().then(
      ({ showDropPicture }) => showDropPicture(shown && this.dragging > 0, this.host.mayEdit()),
      () => undefined, // dropped, they say what failed
    );
  }
}
