// The button of See inside, which is loaded with its first press, or at once if something of it was shown last time.
import { button } from "../panel/dom";
import { lateStyle } from "../panel/late_style";
import { noticeError } from "../panel/notices";
import type { StatusLog } from "../panel/status_log";
import { inBrowser } from "../link/kept";
import type { FieldName } from "../link/protocol";
import type { SceneDocument } from "../link/scene_types";
import type { Stage } from "../view/stage";
import type { Inside } from "./inside";

export interface InsideHost {
  stage: Stage;
  log: StatusLog;
  ask(method: string, params: Record<string, unknown>): Promise<unknown>;
  document(): SceneDocument | null;
  field(): FieldName | null; ///< that colours the cloth
  live(): boolean; ///< the frame on screen is of the present
  recolour(): void; ///< the range of the colours is another
  changed(): void; ///< the card came or went
}

export class InsideDoor {
  private loading: Promise<Inside> | null = null;
  private there: Inside | null = null;

  constructor(private readonly host: InsideHost) {
    button("inside-open").onclick = ({ detail }) => this.toggle(detail === 0);
    if (/"(?!curves)\w+":true/.test(inBrowser.get("clothlab-inside") ?? "")) void this.load();
  }

  toggle(byKey = true): void {
    void this.load()?.then((inside) => inside.toggle(byKey));
  }

  sceneChanged(): void {
    this.there?.sceneChanged();
  }
  coloured(): void {
    this.there?.coloured();
  }

  private load(): Promise<Inside> | null {
    this.loading ??= Promise.all([import("./inside"), lateStyle("inside.css")]).then(([loaded]) => {
      this.there = new loaded.Inside(this.host);
      return this.there;
    });
    this.loading.catch((error: Error) => {
      this.loading = null;
      noticeError("See inside could not be loaded", error);
    });
    return this.loading;
  }
}
