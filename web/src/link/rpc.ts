// JSON-RPC 2.0 over a WebSocket: a request returns a promise, a notification goes to a handler.
import { BadMessage } from "./protocol";
import type { Vec3 } from "./scene_types";

/// An edge or a triangle of a cloth or a body.
export interface CrossingPart {
  cloth?: number; ///< its place in the list of cloths; none: it is a body's
  name: string; ///< the cloth's, or the collider's
  vertices: number[]; ///< as the document numbers them
  at: Vec3[]; ///< [m]
}
/// Edges that meet triangles, which contact between surfaces cannot part.
export interface Crossings {
  when: "start" | "present";
  count: number;
  complete: boolean;
  pairs: { edge: CrossingPart; triangle: CrossingPart; place: Vec3 }[]; ///< the first of them
}

export interface RpcErrorData {
  path?: string;
  found?: string;
  allowed?: string;
  revision?: number;
  crossings?: Crossings;
}

export const errorNotAllowed = -32001;
export const errorNothingThere = -32005;
export const errorGivenUp = -32006; ///< a change was given up while it was built

export class RpcError extends Error {
  constructor(
    readonly code: number,
    message: string,
    readonly data: RpcErrorData = {},
  ) {
    super(message);
  }
}

type Params = Record<string, unknown>;

interface Pending {
  resolve(result: unknown): void;
  reject(error: Error): void;
}

interface Incoming {
  id?: number | string | null;
  method?: string;
  params?: Params;
  result?: unknown;
  error?: { code: number; message: string; data?: RpcErrorData };
}

function parsed(text: string): Incoming {
  let message: unknown = null;
  try {
    message = JSON.parse(text);
  } catch {
    // Text that is no JSON falls through to the error below.
  }
  if (typeof message !== "object" || message === null) throw new BadMessage("a text message is no JSON object");
  return message;
}

export class Rpc {
  private nextId = 1;
  private readonly pending = new Map<number, Pending>();

  constructor(
    private readonly socket: WebSocket,
    private readonly onNotification: (method: string, params: Params) => void,
  ) {}

  request<T = Params>(method: string, params: Params = {}): Promise<T> {
    return new Promise((resolve, reject) => {
      if (this.socket.readyState !== WebSocket.OPEN) {
        reject(new Error("not connected to the server"));
        return;
      }
      const id = this.nextId++;
      this.pending.set(id, { resolve: resolve as (result: unknown) => void, reject });
      this.socket.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
    });
  }

  notify(method: string, params: Params): void {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ jsonrpc: "2.0", method, params }));
  }

  /// Takes one text message of the server; throws a BadMessage if it is no JSON-RPC message.
  receive(text: string): void {
    const message = parsed(text);
    if (message.method !== undefined) {
      this.onNotification(message.method, message.params ?? {});
      return;
    }
    const waiting = this.pending.get(Number(message.id));
    if (!waiting) return;
    this.pending.delete(Number(message.id));
    if (message.error) waiting.reject(new RpcError(message.error.code, message.error.message, message.error.data));
    else waiting.resolve(message.result);
  }

  /// The socket is closed: every pending request fails, as no answer can come.
  close(): void {
    for (const waiting of this.pending.values())
      waiting.reject(new Error("the connection was lost before the server answered"));
    this.pending.clear();
  }
}
