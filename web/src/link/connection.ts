// The link to the server: connects, authenticates, subscribes, measures the round trip, and reconnects after a loss.
import { canInflate } from "./inflate";
import { inTab } from "./kept";
import { PackedFrames } from "./packed_frames";
import { BadMessage, decode, isPacked, type FieldName, type Frame, type Topology } from "./protocol";
import { refusalOf } from "./refusal";
import { errorNotAllowed, Rpc, RpcError } from "./rpc";

export type LinkState = "connecting" | "open" | "waiting" | "unauthorised";

export interface LinkEvents {
  state(state: LinkState, retryInSeconds: number, why: string): void;
  notification(method: string, params: Record<string, unknown>): void;
  topology(topology: Topology): void;
  frame(frame: Frame, field: FieldName | null): void;
  latency(milliseconds: number): void;
  problem(error: Error): void;
}

const subprotocol = "clothlab.v1";
const firstDelay = 0.25; // [s]: a restarted server is usually back at once
const longestDelay = 8; // [s]
const pingEvery = 1000; // [ms]
const silenceLimit = 8000; // [ms] without a byte: sim.status alone comes 10 times a second
const closeBadMessage = 4002; // a page may not send 1002, "protocol error"

export class Connection {
  bytesReceived = 0;
  private socket: WebSocket | null = null;
  private rpc: Rpc | null = null;
  private delay = firstDelay;
  private retryTimer = 0;
  private lastHeard = 0;
  private refused = false;
  private greeted = false; // the handshake was accepted
  private turn = 0; // rises with each try to connect
  private field: FieldName | null = null;
  private agreed: FieldName | null = null; // what the frames that come now have
  private encoding: "q16" | "c16" = "q16"; // as WebGL takes it, or in fewer bytes, which a thread of the page's unpacks
  private canUnpack = canInflate();
  private readonly packed = new PackedFrames({
    refused: (error) => this.distrust(error),
    broken: () => {
      this.canUnpack = false;
      this.encoding = "q16";
      this.tryLater("compressed frames cannot be read here"); // those under way are lost, and would be waited for
    },
  });

  constructor(
    private readonly session: string,
    private readonly events: LinkEvents,
  ) {
    setInterval(() => this.beat(), pingEvery);
  }

  get open(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  connect(): void {
    ++this.turn;
    this.greeted = false;
    clearTimeout(this.retryTimer);
    this.refused = false;
    this.events.state("connecting", 0, "");
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(
      `${scheme}//${location.host}/ws?session=${encodeURIComponent(this.session)}`,
      subprotocol,
    );
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.rpc = new Rpc(socket, (method, params) => this.events.notification(method, params));
    this.lastHeard = performance.now();
    socket.onopen = () => {
      this.greeted = true;
      void this.greet(this.rpc as Rpc);
    };
    socket.onmessage = (event) => this.receive(event.data as string | ArrayBuffer);
    socket.onclose = (event) => this.closed(socket, event);
  }

  request<T = Record<string, unknown>>(method: string, params: Record<string, unknown> = {}): Promise<T> {
    return this.rpc ? this.rpc.request<T>(method, params) : Promise.reject(new Error("not connected to the server"));
  }

  /// Asks for frames with this field, or without one, now and on every later link.
  setField(field: FieldName | null): void {
    this.field = field;
    // a refusal, of this or of the link, is told where the link is made
    if (this.rpc && this.open) this.subscribe(this.rpc).catch(() => undefined);
  }

  /// Asks for compressed frames, now and on every later link. False: this browser cannot read them.
  compress(): boolean {
    if (!this.canUnpack || this.encoding === "c16") return this.canUnpack;
    this.encoding = "c16";
    if (this.rpc && this.open) this.subscribe(this.rpc).catch(() => undefined);
    return true;
  }

  // Every frame after the answer has the field.
  private async subscribe(rpc: Rpc): Promise<void> {
    const { field, encoding } = this;
    await rpc.request("stream.subscribe", { encoding, rate: 60, in_flight: 2, ...(field ? { field } : {}) });
    this.agreed = field;
  }

  /// The answer of the HTTP API, e.g. at `/api/scene`, for this session.
  async get(path: string, query: Record<string, string> = {}): Promise<ArrayBuffer> {
    const token = inTab.get("clothlab-token");
    const answer = await fetch(`${path}?${new URLSearchParams({ session: this.session, ...query }).toString()}`, {
      headers: token === null ? {} : { authorization: `Bearer ${token}` },
    });
    if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
    return answer.arrayBuffer();
  }

  notify(method: string, params: Record<string, unknown>): void {
    this.rpc?.notify(method, params);
  }

  acknowledge(sequence: number): void {
    this.rpc?.notify("stream.ack", { frame: sequence });
  }

  /// Stores the token for this tab and connects with it.
  authenticate(token: string): void {
    inTab.set("clothlab-token", token);
    this.abandon();
    this.connect();
  }

  // Sends everything at once: the first frame needs no second round trip.
  private async greet(rpc: Rpc): Promise<void> {
    const token = inTab.get("clothlab-token");
    try {
      const authenticated = token ? rpc.request("auth", { token }) : Promise.resolve();
      await Promise.all([authenticated, this.subscribe(rpc)]);
      this.delay = firstDelay;
      this.events.state("open", 0, "");
    } catch (error) {
      if (error instanceof RpcError && error.code === errorNotAllowed)
        this.refuse(
          token === null ? "This server asks for a token." : `The server did not accept this token: ${error.message}.`,
        );
      // too many of something, such as sessions: that passes
      else if (error instanceof RpcError) this.tryLater(error.message);
    }
  }

  private tryLater(why: string): void {
    this.abandon();
    this.retry(why);
  }

  private refuse(why: string): void {
    inTab.remove("clothlab-token");
    this.refused = true;
    this.abandon();
    this.events.state("unauthorised", 0, why);
  }

  private receive(data: string | ArrayBuffer): void {
    this.lastHeard = performance.now();
    try {
      if (typeof data === "string") {
        this.bytesReceived += data.length;
        this.rpc?.receive(data);
        return;
      }
      this.bytesReceived += data.byteLength;
      const { agreed } = this;
      if (isPacked(data)) this.packed.unpack(data, (buffer) => this.take(buffer, agreed));
      else this.take(data, agreed);
    } catch (error) {
      if (error instanceof BadMessage) this.distrust(error);
      else this.events.problem(error as Error);
    }
  }

  private take(message: ArrayBuffer, field: FieldName | null): void {
    const read = decode(message);
    if ("topology" in read) {
      this.packed.take(read.topology);
      this.events.topology(read.topology);
    } else {
      this.events.frame(read.frame, field);
    }
  }

  // Reconnects, as later messages might be misread, too; but late, as the server may well send the same again.
  private distrust(error: BadMessage): void {
    this.abandon(closeBadMessage, error.message);
    this.delay = longestDelay;
    this.retry(`the server sent something unexpected: ${error.message}`);
  }

  private beat(): void {
    if (!this.open || !this.rpc) return;
    if (performance.now() - this.lastHeard > silenceLimit) {
      const socket = this.socket as WebSocket;
      this.abandon();
      this.retry(`no answer for ${silenceLimit / 1000} s from ${new URL(socket.url).host}`);
      return;
    }
    const sent = performance.now();
    this.rpc.request("ping", { t: sent }).then(
      () => this.events.latency(performance.now() - sent),
      () => undefined,
    );
  }

  /// Closes the link for good: it does not reconnect.
  close(): void {
    ++this.turn;
    clearTimeout(this.retryTimer);
    this.abandon();
  }

  private abandon(code = 1000, reason = ""): void {
    if (!this.socket) return;
    this.socket.onopen = this.socket.onmessage = this.socket.onclose = null;
    this.socket.close(code, reason.slice(0, 123)); // a close frame holds at most this many bytes
    this.rpc?.close();
    this.packed.forget();
    this.socket = this.rpc = null;
  }

  private closed(socket: WebSocket, event: CloseEvent): void {
    if (socket !== this.socket) return;
    const { greeted } = this;
    this.abandon();
    if (this.refused) return;
    if (event.code === 1006 && !greeted) void this.retryRefused();
    else this.retry(event.reason || (event.code === 1006 ? "" : `closed with code ${event.code}`));
  }

  // The handshake has failed.
  private async retryRefused(): Promise<void> {
    const turn = ++this.turn;
    const why = await refusalOf(this.session);
    if (turn === this.turn && !this.socket) this.retry(why);
  }

  private retry(why: string): void {
    const wait = this.delay * (0.8 + 0.4 * Math.random()); // spread out: all viewers lost the server at the same time
    this.delay = Math.min(this.delay * 1.6, longestDelay);
    this.events.state("waiting", wait, why);
    this.retryTimer = window.setTimeout(() => this.connect(), wait * 1000);
  }
}
