// The way to the scene's text, which is loaded when somebody opens it, drops a scene, or comes by a link with one.
import type { TextDrawer } from "./drawer";
import type { TextHost } from "./host";
import { lateStyle } from "../panel/late_style";
import { noticeError } from "../panel/notices";

type Text = typeof import("./index");

export class TextDoor {
  private drawer: TextDrawer | null = null;
  private loading: Promise<Text> | null = null;

  constructor(private readonly host: TextHost) {
    addEventListener("hashchange", () => this.arrived());
  }

  toggle(): void {
    this.with((_, drawer) => drawer.toggle());
  }

  /// Closes it: something else takes its room.
  shut(): void {
    if (this.drawer?.open) this.drawer.toggle();
  }

  sceneChanged(): void {
    this.drawer?.sceneChanged();
  }

  /// Takes dropped files, one of which is a scene.
  take(files: File[]): void {
    this.with(({ takeScene }, drawer) => takeScene(files, this.host, drawer));
  }

  /// Called when the scene is there, and when the address changes: the address may carry another one.
  arrived(): void {
    if (!location.hash.startsWith("#scene=") && history.state === null) return;
    this.with(async ({ loadKept, offer }) => {
      if (!(await loadKept(this.host)) && location.hash.startsWith("#scene=")) await offer(this.host);
    });
  }

  private with(use: (text: Text, drawer: TextDrawer) => void | Promise<void>): void {
    this.loading ??= this.load();
    this.loading
      .then((text) => use(text, (this.drawer ??= new text.TextDrawer(this.host))))
      .catch((error: Error) => {
        this.loading = null;
        noticeError("The scene's text could not be opened", error);
      });
  }

  private async load(): Promise<Text> {
    const [text] = await Promise.all([import("./index"), lateStyle("text.css")]);
    return text;
  }
}
