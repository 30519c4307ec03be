// The drawers that share the room beside the cloth: the lab, the comparison and the scene's text. At most one is open.
import { CompareDoor } from "./compare/door";
import { LabDoor } from "./lab/door";
import type { SceneStore } from "./link/scene_store";
import type { Patch, SceneDocument } from "./link/scene_types";
import { showApplied } from "./panel/notices";
import { TextDoor } from "./text/door";
import type { Stage } from "./view/stage";

type Params = Record<string, unknown>;

export interface DrawersHost {
  session: string;
  store: SceneStore;
  request<T>(method: string, params: Params): Promise<T>;
  preset(name: string): SceneDocument | null; ///< with the defaults filled in, as the server keeps it
  stage(): Stage;
  mayEdit(): boolean;
  fail(patch: Patch, what: string): void; ///< shows how the scene fails with that
  undo(revision: number): void; ///< undoes the change that made this revision, if it was the last
  toggled(open: boolean): void; ///< the free part of the window changes
  returned(): void; ///< the session's cloth is drawn again
}

export class Drawers {
  private readonly lab: LabDoor;
  private readonly compare: CompareDoor;
  private readonly text: TextDoor;
  private methods: string[] = [];
  private messageBytes = 65536; // the most that a message may have

  constructor(private readonly host: DrawersHost) {
    const { store } = host;
    const shared = {
      request: <T>(method: string, params: Params) => host.request<T>(method, params),
      mayEdit: () => host.mayEdit(),
      applied: showApplied,
    };
    this.lab = new LabDoor({
      ...shared,
      document: () => store.document,
      addressed: (patch) => (Array.isArray(patch) ? store.addressed(patch) : patch),
      undo: (revision) => host.undo(revision),
      compare: (patch) => this.compare.begin({ patch }),
      fail: (patch, what) => host.fail(patch, what),
      toggled: (open) => this.toggled(this.lab, open),
    });
    this.compare = new CompareDoor({
      ...shared,
      document: () => store.document,
      stored: () => store.stored,
      addressed: (operations) => store.addressed(operations),
      stage: () => host.stage(),
      methods: () => this.methods,
      mostBytes: () => this.messageBytes,
      use: (patch, what) => this.lab.apply(patch, what),
      toggled: (open) => this.toggled(this.compare, open),
      returned: () => host.returned(),
    });
    this.text = new TextDoor({
      ...shared,
      session: host.session,
      stored: () => store.stored && { document: store.stored, revision: store.revision },
      preset: (name) => host.preset(name),
      mostBytes: () => this.messageBytes,
      toggled: (open) => this.toggled(this.text, open),
    });
  }

  /// True while a comparison is drawn in the place of the session's cloth.
  get compared(): boolean {
    return this.compare.drawn;
  }

  /// Closes what is open: the picture needs the room.
  shut(): void {
    for (const each of [this.lab, this.compare, this.text]) each.shut();
  }

  toggle(which: "lab" | "compare" | "text"): void {
    this[which].toggle();
  }

  /// Takes dropped files, one of which is a scene.
  take(files: File[]): void {
    this.text.take(files);
  }

  link(open: boolean): void {
    this.lab.link(open);
    if (!open) this.compare.lost();
  }

  greeted(methods: string[], messageBytes: number | undefined): void {
    this.methods = methods;
    this.messageBytes = messageBytes ?? this.messageBytes;
    this.lab.greeted(methods);
  }

  /// Called when the session's scene has come: the address may carry another one, or a comparison.
  arrived(): void {
    this.text.arrived();
    this.compare.arrived();
  }

  sceneChanged(): void {
    for (const each of [this.lab, this.text, this.compare]) each.sceneChanged();
  }

  /// Takes lab.progress and lab.result.
  told(method: "progress" | "result", params: Params): void {
    this.lab.told(method, params);
    this.compare.told(method, params);
  }

  // One of them opened, which closes the others, or closed.
  private toggled(drawer: { shut(): void }, open: boolean): void {
    if (open) {
      for (const other of [this.lab, this.compare, this.text]) if (other !== drawer) other.shut();
      document.body.classList.add("lab-open");
    }
    this.host.toggled(open);
  }
}
