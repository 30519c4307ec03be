// The ways to have the scene blow up: each is told to the show, which does it while the session stands still.
import type { Cause } from "./door";
import type { Patch, SceneDocument } from "../link/scene_types";
import { beyond } from "../panel/gauge";
import { methodText } from "../panel/methods";
import { notice } from "../panel/notices";

export interface ProvokedHost {
  begin(cause: Cause): void;
  request<T>(method: string, params: Record<string, unknown>): Promise<T>;
  stored(): SceneDocument | null;
  limit(): number | null | undefined; ///< the longest stable step [s]; null: any is
}

/// The method that a scene goes on with whose own method holds at any time step.
const fails = "symplectic_euler";

export class Provoked {
  static readonly preset = "blowup";

  constructor(private readonly host: ProvokedHost) {}

  /// Takes steps beyond the limit. A method that has none holds: what else would blow up is said, and waits for a
  /// press.
  beyondLimit(): void {
    const limit = this.host.limit();
    if (typeof limit === "number") {
      this.host.begin({ apply: () => this.stepsBeyond(limit), more: () => this.longerSteps() });
      return;
    }
    const name = methodText(this.host.stored()?.solver.method ?? "").name;
    notice("info", {
      title: `${name} holds at any time step`,
      lines: [`This scene blows up with ${methodText(fails).name}. Undo brings ${name} back.`],
      stays: true,
      actions: [{ label: `Go on with ${methodText(fails).name}`, run: () => this.otherMethod() }],
    });
  }

  /// Has the scene blow up with a setting that the lab has found to fail.
  setting(patch: Patch, name: string): void {
    this.host.begin({ apply: () => this.host.request("scene.patch", { patch, name }) });
  }

  /// Loads the preset that is beyond its limit.
  load(): void {
    this.host.begin({ apply: () => this.host.request("scene.load", { preset: Provoked.preset }) });
  }

  /// Looks again at how the scene has blown up.
  again(): void {
    const failed = this.host.stored();
    if (failed) this.host.begin({ apply: () => Promise.resolve(), failed });
  }

  private otherMethod(): void {
    this.host.begin({
      apply: async (limit) => {
        await this.host.request("scene.patch", { patch: { solver: { method: fails } }, name: `Method: ${fails}` });
        await this.stepsBeyond(await limit());
      },
    });
  }

  // Where no step is stable, the present one fails, too, if slowly.
  private async stepsBeyond(limit: number): Promise<void> {
    if (limit > 0) await this.step(beyond(limit));
  }

  /// Beyond the limit of explicit Euler the fastest vibration grows with the square of the step.
  private async longerSteps(): Promise<void> {
    const { document } = await this.host.request<{ document: SceneDocument }>("scene.get", {});
    await this.step(2 * document.solver.dt);
  }

  private step(dt: number): Promise<unknown> {
    return this.host.request("scene.patch", { patch: { solver: { dt } }, name: "Blow up: time step" });
  }
}
