// What the scene's text needs of the page.
import type { Operation, SceneDocument } from "../link/scene_types";

export interface TextHost {
  session: string;
  request<T>(method: string, params: Record<string, unknown>): Promise<T>;
  stored(): { document: SceneDocument; revision: number } | null; ///< the scene as the server keeps it
  preset(name: string): SceneDocument | null; ///< with the defaults filled in, as the server keeps it
  mayEdit(): boolean;
  mostBytes(): number; ///< of a message: hello.limits.message_bytes
  applied(depth: string): void;
  toggled(open: boolean): void; ///< the free part of the window changes
}

export interface Applied {
  revision: number;
  applies: string;
}

/// What a message has besides the patch or the scene in it [bytes], generously.
const envelope = 200;
const bytes = (value: unknown): number => new TextEncoder().encode(JSON.stringify(value)).length;

/// Why a scene or a patch is too large to be sent; "" if it is not.
export function tooLarge(value: SceneDocument | Operation[], host: TextHost): string {
  const size = bytes(value) + envelope;
  const most = host.mostBytes();
  if (size <= most) return "";
  return `It has ${size} bytes, and a message may have ${most}. Put a large mesh into an .obj file, and name it.`;
}
