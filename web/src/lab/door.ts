// The way to the lab, which is loaded when somebody opens it or applies what a comparison found.
import type { Patch } from "../link/scene_types";
import { button } from "../panel/dom";
import { noticeError } from "../panel/notices";
import type { Lab, LabEvents } from "./drawer";

export class LabDoor {
  private lab: Lab | null = null;
  private loading: Promise<typeof import("./drawer")> | null = null;
  private methods: string[] = [];
  private connected = false;

  constructor(private readonly events: LabEvents) {
    button("lab-open").onclick = () => this.toggle();
  }

  toggle(): void {
    this.with((lab) => lab.toggle());
  }

  /// Closes it: something else takes its room.
  shut(): void {
    this.lab?.shut();
  }

  /// Applies `patch` and shows a notice that says what was changed and offers to undo it.
  apply(patch: Patch, what: string): void {
    this.with((lab) => void lab.apply(patch, what));
  }

  /// Takes what the server tells at first or anew: its methods, and this page's role.
  greeted(methods: string[]): void {
    this.methods = methods;
    this.lab?.setMethods(methods);
    this.lab?.roleChanged();
  }

  sceneChanged(): void {
    this.lab?.sceneChanged();
  }

  link(open: boolean): void {
    this.connected = open;
    this.lab?.link(open);
  }

  /// Takes lab.progress and lab.result.
  told(method: "progress" | "result", params: Record<string, unknown>): void {
    if (method === "progress") this.lab?.progress(params);
    else this.lab?.arrived(params);
  }

  private with(use: (lab: Lab) => void): void {
    this.loading ??= import("./drawer");
    this.loading
      .then(({ Lab }) => use((this.lab ??= this.made(new Lab(this.events)))))
      .catch((error: Error) => {
        this.loading = null;
        noticeError("The lab could not be opened", error);
      });
  }

  private made(lab: Lab): Lab {
    lab.setMethods(this.methods);
    lab.link(this.connected);
    return lab;
  }
}
