// What a comparison needs of the page.
import type { Operation, Patch, SceneDocument } from "../link/scene_types";
import type { Stage } from "../view/stage";

export interface CompareHost {
  request<T>(method: string, params: Record<string, unknown>): Promise<T>;
  document(): SceneDocument | null; ///< the scene as it is shown, with the numbers that it leaves to fabrics
  stored(): SceneDocument | null; ///< as the server keeps it
  addressed(operations: Operation[]): Operation[]; ///< operations on the first as ones on the second
  stage(): Stage;
  methods(): string[];
  mayEdit(): boolean;
  mostBytes(): number; ///< of a message: hello.limits.message_bytes
  use(patch: Patch, what: string): void; ///< changes the session's scene, and offers the way back
  toggled(open: boolean): void; ///< the free part of the window changes
  returned(): void; ///< the session's cloth is drawn again
}

/// What B is made of, and what is shown.
export interface Wish {
  patch: Patch; ///< makes B of the scene
  truth: boolean; ///< A is the truth about B
  time: number; ///< to simulate [s]
  view: "side" | "ghost";
}

export const standard: Wish = { patch: [], truth: false, time: 5, view: "side" };
