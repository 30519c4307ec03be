// The page's own copy of the scene, kept in this tab. A server that has restarted without its state, or a session that
// has ended meanwhile, begins with another scene: the page then offers its copy.
import { notice, noticeError } from "./notices";
import type { Transport } from "./transport";
import { inTab } from "../link/kept";
import type { SceneDocument } from "../link/scene_types";

interface Copy {
  revision: number;
  scene: SceneDocument;
}

export interface OwnCopyHost {
  mayEdit(): boolean;
  load(scene: SceneDocument): Promise<unknown>;
  transport: Pick<Transport, "playing" | "start" | "stop">;
}

const most = 1_000_000; // characters: a tab keeps about 5 million
const writtenEvery = 1000; // [ms]

function read(text: string | null): Copy | null {
  try {
    return text === null ? null : (JSON.parse(text) as Copy);
  } catch {
    return null; // not this page's
  }
}

export class OwnCopy {
  private copy: Copy | null;
  private readonly key: string;
  private playing = true; // when the link was lost
  private offered = false; // now
  private timer = 0;

  constructor(
    session: string,
    private readonly host: OwnCopyHost,
  ) {
    this.key = `clothlab-scene-${session}`;
    this.copy = read(inTab.get(this.key));
  }

  lost(): void {
    this.playing = this.host.transport.playing;
  }

  /// The session's scene has come. Revisions only rise as long as a session lives.
  arrived(scene: SceneDocument, revision: number): void {
    const { copy } = this;
    if (copy && revision < copy.revision && JSON.stringify(copy.scene) !== JSON.stringify(scene)) this.offer(copy);
  }

  /// What the server has of the scene now.
  keep(scene: SceneDocument, revision: number): void {
    if (this.offered) return;
    this.copy = { revision, scene };
    this.timer ||= window.setTimeout(() => this.write(), writtenEvery);
  }

  private write(): void {
    this.timer = 0;
    const text = JSON.stringify(this.copy);
    if (text.length <= most) inTab.set(this.key, text);
    else inTab.remove(this.key);
  }

  private offer({ scene }: Copy): void {
    if (this.offered || !this.host.mayEdit()) return;
    const restore = (): void => {
      this.host.load(scene).then(
        () => (this.playing ? this.host.transport.start() : this.host.transport.stop()),
        (error: Error) => noticeError("Not restored", error),
      );
    };
    this.offered = true;
    notice("warning", {
      title: "The server no longer has your scene",
      lines: [`It has begun anew. This page has a copy of ${scene.name || "your scene"} as it was.`],
      actions: [{ label: "Restore my scene", run: restore }],
      stays: true,
      closed: () => (this.offered = false),
    });
  }
}
