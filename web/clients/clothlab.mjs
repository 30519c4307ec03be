/**
 * Clothlab from JavaScript: one file, which the server itself serves, so that it fits the server.
 *
 *     curl -O http://127.0.0.1:8080/clothlab.mjs
 *
 *     import { connect } from "./clothlab.mjs";
 *     const cloth = await connect("127.0.0.1:8080", { session: "script" });
 *     await cloth.set({ "/gravity": [0, -1.6, 0] });
 *     for await (const frame of cloth.frames({ rate: 10 })) console.log(frame.time, frame.positions);
 *
 * Browsers and Node from 22 on have a WebSocket. Node 18 and 20 need `npm install ws`, or the option `WebSocket`.
 * Frames are acknowledged as they come and only the newest is kept, so that a slow script sees no old ones.
 *
 * Units are SI: m, s, kg, N; right-handed, y up; indices from 0. A pointer is a JSON Pointer (RFC 6901) into the scene:
 * "/cloths/0/material/bend". What goes wrong is a ClothlabError, whose message says where, what was found and what is
 * allowed.
 *
 * @module
 */

/** @typedef {{ [key: string]: any }} Json An object of JSON. */
/** @typedef {[number, number, number]} Vec3 */
/** @typedef {{ op: "add"|"remove"|"replace"|"move"|"copy"|"test", path: string, from?: string, value?: any }} Operation */
/** @typedef {{ timeout?: number }} Waiting timeout: [s]; left out: that of connect(). Infinity: as long as it takes. */
/** @typedef {"f32" | "q16"} Encoding q16 has a third of the bytes, and 65536 steps across the cloth's box. */
/** @typedef {"strain" | "speed" | "contact"} Field */
/** @typedef {{ encoding?: Encoding, field?: Field }} Form */
/** @typedef {(done: number, total: number) => void} Progress */
/** @typedef {{ playing: boolean, time: number, step: number }} Moment time: [s] */

/** Anything that goes wrong here. */
export class ClothlabError extends Error {
  /** @override */
  name = "ClothlabError";
}

/** The server answered a request with an error. Nothing of the running scene has changed. */
export class Refused extends ClothlabError {
  /** @override */
  name = "Refused";

  /** @param {{ code: number, message: string, data?: any }} error */
  constructor({ code, message, data }) {
    super(message ?? "the server refused this");
    /** Of JSON-RPC: -32601 no such method, -32602 a wrong value, -32001 not allowed, -32002 over a limit, -32003 the
     *  scene has another revision, -32004 diverged. */
    this.code = code;
    /** @type {Json} all that the server said, e.g. { revision: 7 } */
    this.data = typeof data === "object" && data !== null ? data : {};
    /** @type {string} of a wrong value its JSON Pointer, else "" */
    this.path = this.data.path ?? "";
    /** @type {string} */
    this.found = this.data.found ?? "";
    /** @type {any} */
    this.allowed = this.data.allowed ?? "";
  }
}

/** No connection to the server; `reconnect()` makes it anew. */
export class ConnectionLost extends ClothlabError {
  /** @override */
  name = "ConnectionLost";

  /** @param {string} message @param {number} code the WebSocket's, or the status of HTTP */
  constructor(message, code) {
    super(message);
    this.code = code;
  }
}

/** The server did not answer in time; the connection stays as it is. */
export class Timeout extends ClothlabError {
  /** @override */
  name = "Timeout";
}

const headerBytes = 64;
// The most that is taken from a server, whatever it sends.
const mostMessageBytes = 64 * 1024 * 1024; // of a message: a million vertices have less
const mostAnswerBytes = 512 * 1024 * 1024; // over HTTP: a picture, or a mesh as text
const mostHeard = 10_000; // notifications that wait for a measurement; beyond, the oldest are forgotten
const retryTime = 0.5; // [s] between two tries to connect anew

/** What is connected: the same for all frames until another mesh. */
export class Topology {
  /** @param {ArrayBuffer} buffer */
  constructor(buffer) {
    const view = new DataView(buffer);
    this.revision = view.getUint32(4, true);
    /** how many */
    this.vertices = view.getUint32(12, true);
    const count = view.getUint32(headerBytes, true);
    const cloths = view.getUint32(headerBytes + 4, true);
    if (buffer.byteLength !== headerBytes + 8 + 8 * cloths + 12 * count + 8 * this.vertices)
      throw new ClothlabError("a topology that is not as long as it says; fetch the server's own client");
    /** each cloth's vertices, within those of the frame */
    this.cloths = Array.from({ length: cloths }, (_, i) => ({
      first: view.getUint32(headerBytes + 8 + 8 * i, true),
      vertices: view.getUint32(headerBytes + 12 + 8 * i, true),
    }));
    const at = headerBytes + 8 + 8 * cloths;
    /** 3 vertices a triangle, counter-clockwise seen from where its normal points */
    this.triangles = new Uint32Array(buffer, at, 3 * count);
    /** 2 texture coordinates a vertex */
    this.texture = new Float32Array(buffer, at + 12 * count, 2 * this.vertices);
  }
}

/** The cloth at one moment. */
export class Frame {
  /** @param {ArrayBuffer} buffer @param {Topology} topology */
  constructor(buffer, topology) {
    const view = new DataView(buffer);
    if (view.getUint8(1) > 1)
      throw new ClothlabError(`a frame of an encoding that this client does not know: fetch the server's own`);
    /** @type {Encoding} */
    this.encoding = view.getUint8(1) === 0 ? "f32" : "q16";
    /** nothing moves */
    this.asleep = (view.getUint16(2, true) & 1) !== 0;
    /** it has blown up, and this is the last good state */
    this.diverged = (view.getUint16(2, true) & 2) !== 0;
    this.sequence = view.getUint32(8, true);
    /** how many */
    this.vertices = view.getUint32(12, true);
    /** simulated [s] */
    this.time = view.getFloat64(16, true);
    this.step = Number(view.getBigUint64(24, true));
    const bytes = (this.encoding === "f32" ? 24 : 8) + (view.getFloat32(60, true) > 0 ? 1 : 0);
    if (buffer.byteLength !== headerBytes + bytes * this.vertices)
      throw new ClothlabError("a frame that is not as long as it says; fetch the server's own client");
    this.topology = topology;
    /** the bytes as they came, without the header */
    this.payload = new Uint8Array(buffer, headerBytes);
    this._view = view;
  }

  /** 3 coordinates a vertex [m]. @returns {Float32Array} */
  get positions() {
    return this._triples(0, (vertex, axis) => {
      const [low, extent] = [this._view.getFloat32(32 + 4 * axis, true), this._view.getFloat32(44 + 4 * axis, true)];
      return low + (extent * this._view.getUint16(headerBytes + 8 * vertex + 2 * axis, true)) / 65535;
    });
  }

  /** 3 coordinates a vertex, of length 1; of q16 within a degree. @returns {Float32Array} */
  get normals() {
    const normals = this._triples(12, (vertex, axis) => {
      const byte = (/** @type {number} */ i) =>
        Math.max(-1, this._view.getInt8(headerBytes + 8 * vertex + 6 + i) / 127);
      const [x, y] = [byte(0), byte(1)];
      const z = 1 - Math.abs(x) - Math.abs(y);
      if (axis === 2) return z;
      const [own, other] = axis === 0 ? [x, y] : [y, x];
      // The octahedron |x| + |y| + |z| = 1 unfolded to the square, its lower half turned outwards.
      return z >= 0 ? own : (1 - Math.abs(other)) * (own >= 0 ? 1 : -1);
    });
    if (this.encoding === "q16")
      for (let at = 0; at < normals.length; at += 3) {
        const length = Math.hypot(normals[at], normals[at + 1], normals[at + 2]);
        for (let axis = 0; axis < 3; ++axis) normals[at + axis] /= length;
      }
    return normals;
  }

  /** One number a vertex, in 255 levels: the field that was asked for; null without one. @returns {Float32Array | null} */
  get field() {
    const range = this._view.getFloat32(60, true);
    if (!(range > 0)) return null;
    return Float32Array.from(this.payload.subarray(-this.vertices), (level) => (range * level) / 255);
  }

  /** 3 vertices a triangle, those of the topology */
  get triangles() {
    return this.topology.triangles;
  }

  /**
   * @param {number} offset of the floats of an f32 vertex
   * @param {(vertex: number, axis: number) => number} quantised
   */
  _triples(offset, quantised) {
    const all = new Float32Array(3 * this.vertices);
    for (let vertex = 0, at = 0; vertex < this.vertices; ++vertex)
      for (let axis = 0; axis < 3; ++axis, ++at)
        all[at] =
          this.encoding === "f32"
            ? this._view.getFloat32(headerBytes + 24 * vertex + offset + 4 * axis, true)
            : quantised(vertex, axis);
    return all;
  }
}

/**
 * A text message of JSON-RPC, in the form that all below relies on.
 * @param {string} text
 * @returns {Json}
 */
function parsedMessage(text) {
  const isObject = (/** @type {any} */ value) => typeof value === "object" && value !== null && !Array.isArray(value);
  const message = JSON.parse(text);
  if (!isObject(message)) throw new ClothlabError("it sent a message that is no object");
  if (message.method !== undefined && !(typeof message.method === "string" && isObject(message.params ?? {})))
    throw new ClothlabError("it sent a notification without a name, or without named parameters");
  if (message.error && !isObject(message.error)) message.error = { message: String(message.error) };
  return message;
}

/**
 * The body of an answer over HTTP, or as much of it as `most` bytes.
 * @param {Response} answer
 * @param {number} most
 */
async function bodyOf(answer, most) {
  const pieces = [];
  let bytes = 0;
  const reader = answer.body?.getReader();
  while (reader && bytes <= most) {
    const { done, value } = await reader.read();
    if (done) break;
    pieces.push(value);
    bytes += value.length;
  }
  if (bytes > most) reader?.cancel().catch(() => {});
  const body = new Uint8Array(Math.min(bytes, most + 1));
  let at = 0;
  for (const piece of pieces) {
    body.set(piece.subarray(0, body.length - at), at);
    at += Math.min(piece.length, body.length - at);
  }
  return body;
}

/**
 * What is at a JSON Pointer.
 * @param {any} document
 * @param {string} pointer
 */
function at(document, pointer) {
  if (pointer !== "" && !pointer.startsWith("/"))
    throw new ClothlabError(`${JSON.stringify(pointer)} is no JSON Pointer; one starts with /, like "/solver/dt"`);
  let value = document;
  for (const key of pointer.split("/").slice(1)) {
    const name = key.replaceAll("~1", "/").replaceAll("~0", "~");
    value = typeof value === "object" && value !== null && Object.hasOwn(value, name) ? value[name] : undefined;
  }
  return value;
}

/** @param {string} address */
function parsed(address) {
  const text = address.includes("//") ? address : `http://${address}`;
  /** @type {URL | null} */
  let url = null;
  try {
    url = new URL(text);
  } catch {
    // told below
  }
  const secure = { "http:": false, "ws:": false, "https:": true, "wss:": true }[url?.protocol ?? ""];
  if (!url || secure === undefined)
    throw new ClothlabError(`${address} is no address of a server; give one like "http://127.0.0.1:8080"`);
  return { host: url.host, secure, session: url.searchParams.get("session") };
}

/** @returns {Promise<any>} */
async function webSocketClass() {
  const own = /** @type {any} */ (globalThis).WebSocket;
  if (own) return own;
  const name = "ws"; // not a literal: bundlers for browsers must not look for it
  const found = await import(/* webpackIgnore: true */ name).catch(() => {
    throw new ClothlabError(
      "this Node has no WebSocket: npm install ws, or take Node 22, or give connect() the option WebSocket",
    );
  });
  return found.default;
}

/**
 * Opens a session of the server; a new name opens a new one.
 *
 * Throws a ConnectionLost if there is no server or it refuses, a Refused (-32001) if it wants (another) token.
 *
 * @param {string} address "127.0.0.1:8080", or the page's address, whose ?session=NAME counts if no session is given
 * @param {object} [options]
 * @param {string} [options.session] left out: that of the address, else "main"
 * @param {string} [options.token] of --token (operator) or --view-token (may only look)
 * @param {number} [options.timeout] [s] for each answer
 * @param {any} [options.WebSocket] the class to connect with, such as that of `ws` with settings of your own
 * @returns {Promise<Session>}
 */
export async function connect(address = "http://127.0.0.1:8080", options = {}) {
  const { host, secure, session } = parsed(address);
  const Socket = options.WebSocket ?? (await webSocketClass());
  const made = new Session({
    host,
    secure,
    session: options.session ?? session ?? "main",
    token: options.token,
    timeout: options.timeout ?? 30,
    Socket,
  });
  await made.reconnect();
  return made;
}

/**
 * @typedef {object} Setup
 * @property {string} host
 * @property {boolean} secure
 * @property {string} session
 * @property {string} [token]
 * @property {number} timeout
 * @property {any} Socket
 */

/** One connection to a session. Made by connect(). */
export class Session {
  /** @param {Setup} setup */
  constructor(setup) {
    this._setup = setup;
    this._nextId = 1;
    /** @type {Map<string, Set<(params: Json) => void>>} */
    this._listeners = new Map();
    /** What the server said first: versions, methods, limits. @type {Json} */
    this.hello = {};
    /** @type {ConnectionLost | null} */
    this._lost = null;
    /** @type {Map<number, { resolve: (result: any) => void, reject: (error: Error) => void }>} */
    this._pending = new Map();
    /** @type {Set<() => void>} */
    this._checks = new Set();
    /** @type {Topology | null} */
    this._topology = null;
    /** @type {Frame | null} */
    this._frame = null;
    /** @type {Json | null} */
    this._subscribed = null;
    /** @type {any} */
    this._socket = null;
  }

  // The connection

  /**
   * Connects anew, to the same session with the same token. Frames, hands and jobs of before are gone.
   * @param {number} [patience] [s] for how long to try again if there is no server, or it refuses: while one is
   *     started anew, or another takes the session over (the connection was lost with code 1012)
   */
  async reconnect(patience = 0) {
    const until = performance.now() + 1000 * patience;
    for (;;)
      try {
        return await this._connect();
      } catch (error) {
        if (!(error instanceof ConnectionLost) || performance.now() + 1000 * retryTime > until) throw error;
        await new Promise((resolve) => setTimeout(resolve, 1000 * retryTime));
      }
  }

  async _connect() {
    this.close();
    const { host, secure, session, token, timeout, Socket } = this._setup;
    this._lost = this._topology = this._frame = this._subscribed = null;
    const socket = new Socket(
      `${secure ? "wss" : "ws"}://${host}/ws?session=${encodeURIComponent(session)}`,
      "clothlab.v1",
    );
    this._socket = socket;
    socket.binaryType = "arraybuffer";
    let open = false;
    let why = "";
    /** @type {Json | null} */
    let hello = null;
    socket.onopen = () => {
      open = true;
      this._changed();
    };
    socket.onerror = (/** @type {any} */ event) => {
      why = event.message ?? event.error?.message ?? "";
    };
    socket.onclose = (/** @type {any} */ event) => {
      if (socket !== this._socket) return;
      const reason = event.reason || why || (open ? "it broke off" : "no server answers there, or it refuses");
      this._lose(new ConnectionLost(`${host}: the connection is closed (${event.code}): ${reason}`, event.code));
    };
    socket.onmessage = (/** @type {any} */ event) => {
      if (socket === this._socket) this._receive(event.data);
    };
    const greeted = (/** @type {Json} */ params) => {
      hello = params;
    };
    this.on("hello", greeted);
    try {
      await this._until(() => open || null, "the handshake", timeout);
      // Without a token any request is refused at once where one is needed; else the server would say nothing.
      await (token === undefined ? this.request("ping") : this.request("auth", { token }));
      this.hello = await this._until(() => hello, "the server's hello", timeout);
    } catch (error) {
      this.close();
      throw error;
    } finally {
      this.off("hello", greeted);
    }
  }

  /** Ends the connection; the session itself runs on. */
  close() {
    const socket = this._socket;
    if (!socket) return;
    this._socket = null;
    this._lose(new ConnectionLost("this script closed the connection", 1000));
    socket.onerror = () => {};
    socket.close();
  }

  /** True while there is a connection. */
  get connected() {
    return this._socket !== null && this._lost === null;
  }

  /** Of Clothlab on the server, as `clothlab --version` there says it. @returns {string} */
  get version() {
    return this.hello.version;
  }

  /** @returns {"operator" | "viewer"} */
  get role() {
    return this.hello.role;
  }

  /** @param {ConnectionLost} lost */
  _lose(lost) {
    this._lost ??= lost;
    for (const { reject } of this._pending.values()) reject(lost);
    this._pending.clear();
    this._changed();
  }

  _changed() {
    for (const check of [...this._checks]) check();
  }

  /** @param {string | ArrayBuffer} data */
  _receive(data) {
    /** @type {Json} */
    let message;
    try {
      if ((typeof data === "string" ? data.length : data.byteLength) > mostMessageBytes)
        throw new ClothlabError(`a message of more than ${mostMessageBytes} bytes`);
      if (typeof data !== "string") return this._take(data);
      message = parsedMessage(data);
    } catch (error) {
      return this._refuse(/** @type {Error} */ (error));
    }
    if (message.method !== undefined)
      for (const listener of [...(this._listeners.get(message.method) ?? [])]) listener(message.params ?? {});
    const call = this._pending.get(message.id);
    this._pending.delete(message.id);
    if (message.error) call?.reject(new Refused(message.error));
    else call?.resolve(message.result);
    this._changed();
  }

  /** Ends the connection to a server that says what is none of this protocol. @param {Error} error */
  _refuse(error) {
    const socket = this._socket;
    this._socket = null;
    this._lose(new ConnectionLost(`${this._setup.host}: ${error.message}; is it a Clothlab server?`, 1002));
    socket.onerror = () => {};
    socket.close();
  }

  /** @param {ArrayBuffer} buffer */
  _take(buffer) {
    const kind = new DataView(buffer).getUint8(0);
    if (kind === 1) this._topology = new Topology(buffer);
    if (kind !== 2 || !this._topology) return;
    this._frame = new Frame(buffer, this._topology);
    this.notify("stream.ack", { frame: this._frame.sequence });
    this._changed();
  }

  /**
   * What `look` finds, now or when something changes.
   * @template T
   * @param {() => T | null} look
   * @param {string} what
   * @param {number} timeout
   * @returns {Promise<T>}
   */
  _until(look, what, timeout) {
    return new Promise((resolve, reject) => {
      /** @type {any} */
      let timer;
      /** @param {() => void} settle */
      const end = (settle) => {
        this._checks.delete(check);
        clearTimeout(timer);
        settle();
      };
      const check = () => {
        const found = look();
        if (found !== null) end(() => resolve(found));
        else if (this._lost) end(() => reject(this._lost));
      };
      if (timeout < 2e6)
        timer = setTimeout(
          () => end(() => reject(new Timeout(`waited ${timeout} s for ${what}`))),
          Math.max(0, 1000 * timeout),
        );
      this._checks.add(check);
      check();
    });
  }

  // Requests of any kind

  /**
   * Calls any method of the protocol; the server's AsyncAPI document tells which there are. Throws a Refused, a Timeout,
   * a ConnectionLost.
   * @param {string} method
   * @param {Json} [params]
   * @param {Waiting} [waiting]
   * @returns {Promise<any>} its result
   */
  async request(method, params = {}, { timeout = this._setup.timeout } = {}) {
    const id = this._nextId++;
    /** @type {{ result: any } | null} */
    let answer = null;
    /** @type {Error | null} */
    let refusal = null;
    this._pending.set(id, {
      resolve: (result) => (answer = { result }),
      reject: (error) => (refusal = error),
    });
    try {
      this._send({ id, method, params });
      await this._until(() => answer ?? refusal, `the answer to ${method}`, timeout);
    } finally {
      this._pending.delete(id);
    }
    if (refusal) throw refusal;
    return /** @type {any} */ (answer).result;
  }

  /**
   * The value at `key` of the answer to a request, if `is` says that it is of its kind.
   * @param {string} method
   * @param {string} key
   * @param {(value: any) => boolean} is
   * @param {Json} [params]
   */
  async _ask(method, key, is, params) {
    const result = await this.request(method, params);
    if (typeof result === "object" && result !== null && is(result[key])) return result[key];
    throw new ClothlabError(
      `the answer to ${method} has no '${key}', or of another type; fetch the server's own client`,
    );
  }

  /**
   * Sends without waiting for an answer; what is wrong with it comes as a `notice`, if at all.
   * @param {string} method
   * @param {Json} [params]
   */
  notify(method, params = {}) {
    this._send({ method, params });
  }

  /** @param {Json} message */
  _send(message) {
    if (!this.connected) throw this._lost ?? new ConnectionLost("not connected", 0);
    this._socket.send(JSON.stringify({ jsonrpc: "2.0", ...message }));
  }

  /**
   * Calls `listener` with each notification of this name: "sim.status", "sim.diverged", "scene.changed", "notice", ...
   * @param {string} method
   * @param {(params: Json) => void} listener
   */
  on(method, listener) {
    const all = this._listeners.get(method) ?? new Set();
    this._listeners.set(method, all.add(listener));
  }

  /** @param {string} method @param {(params: Json) => void} listener */
  off(method, listener) {
    this._listeners.get(method)?.delete(listener);
  }

  /**
   * The next notification of this name, from now on, that `accept` takes.
   * @param {string} method
   * @param {(params: Json) => boolean} [accept]
   * @param {Waiting} [waiting]
   * @returns {Promise<Json>}
   */
  async wait(method, accept = () => true, { timeout = this._setup.timeout } = {}) {
    /** @type {Json | null} */
    let found = null;
    const listener = (/** @type {Json} */ params) => {
      if (found === null && accept(params)) found = params;
    };
    this.on(method, listener);
    try {
      return await this._until(() => found, method, timeout);
    } finally {
      this.off(method, listener);
    }
  }

  // The scene

  /**
   * The scene, or what is at this pointer in it; undefined where nothing is.
   * @param {string} [pointer]
   * @returns {Promise<any>}
   */
  async get(pointer = "") {
    return at(
      await this._ask("scene.get", "document", (value) => typeof value === "object" && value !== null),
      pointer,
    );
  }

  /**
   * Changes as one patch: all of it or nothing. "/cloths/0/pins/-" adds to a list.
   * @param {{ [pointer: string]: any }} changes
   */
  async set(changes) {
    const scene = await this.get();
    return this.patch(
      Object.entries(changes).map(([path, value]) => ({
        op: at(scene, path) === undefined ? "add" : "replace",
        path,
        value,
      })),
    );
  }

  /**
   * An object is an RFC 7396 merge patch, an array an RFC 6902 patch.
   * @param {Json | Operation[]} patch
   * @param {number} [revision] refused (-32003) if the scene has another
   * @param {{ keepStable?: boolean }} [options] keepStable: the solver changes with it where the cloth would not hold
   * @returns {Promise<{ revision: number, applies: "none" | "uniform" | "kernel" | "cloth", solver?: Json }>} cloth: time
   *     began again
   */
  patch(patch, revision, { keepStable = false } = {}) {
    return this.request("scene.patch", {
      patch,
      ...(revision === undefined ? {} : { revision }),
      ...(keepStable ? { keep_stable: true } : {}),
    });
  }

  /**
   * Another scene from its beginning.
   * @param {string | Json} scene a preset's name, or the document
   * @returns {Promise<{ revision: number, applies: string }>}
   */
  load(scene) {
    return this.request("scene.load", typeof scene === "string" ? { preset: scene } : { scene });
  }

  /** The names of the presets, for load(). @returns {Promise<string[]>} */
  async presets() {
    return this._ask("scene.presets", "presets", Array.isArray);
  }

  /** The measured fabrics, for a cloth's /material/fabric. @returns {Promise<{ name: string, feel: string, source: string }[]>} */
  async fabrics() {
    return this._ask("scene.presets", "fabrics", Array.isArray);
  }

  /**
   * Gives the session a mesh that a cloth or a collider can name: { mesh: { file: name } }.
   * @param {string} name
   * @param {string | Uint8Array} content of an .obj, .ply, .glb or .gltf file, at most 8 MiB
   * @returns {Promise<Json>} what is in it: vertices, triangles, box, ...
   */
  uploadMesh(name, content) {
    if (typeof content === "string") return this.request("mesh.upload", { name, obj: content });
    try {
      return this.request("mesh.upload", { name, obj: new TextDecoder("utf-8", { fatal: true }).decode(content) });
    } catch {
      let bytes = "";
      for (let i = 0; i < content.length; i += 8192) bytes += String.fromCharCode(...content.subarray(i, i + 8192));
      return this.request("mesh.upload", { name, obj: btoa(bytes), encoding: "base64" });
    }
  }

  // The simulation

  /** @returns {Promise<Moment>} */
  play() {
    return this.request("sim.play");
  }

  /** @returns {Promise<Moment>} */
  pause() {
    return this.request("sim.pause");
  }

  /**
   * Pauses, does so many steps, and returns when they are done. Throws a Refused (-32004) if the simulation blows up.
   * @param {number} [steps]
   * @param {Waiting} [waiting] left out: as long as it takes
   * @returns {Promise<Moment>}
   */
  step(steps = 1, { timeout = Infinity } = {}) {
    return this.request("sim.step", { steps }, { timeout });
  }

  /** Back to the start at time 0, playing or pausing as before. @returns {Promise<Moment>} */
  reset() {
    return this.request("sim.reset");
  }

  /** Simulated seconds a second. @param {number} factor */
  speed(factor) {
    return this.request("sim.speed", { factor });
  }

  /** The next `sim.status`, within a tenth of a second: playing, time [s], step, energy [J], max_strain, ... */
  status() {
    return this.wait("sim.status");
  }

  /**
   * A hand takes a vertex of a cloth (as in frames) and pulls it to a place [m], until release().
   * @param {number} vertex
   * @param {Vec3 | number[]} target
   * @param {{ cloth?: number, hand?: number }} [which] hand: 0 to 9
   */
  async grab(vertex, target, { cloth = 0, hand = 0 } = {}) {
    await this.request("grab.start", { cloth, vertex, target, hand });
    return {
      /** @param {Vec3 | number[]} to [m] */
      move: (to) => this.request("grab.move", { target: to, hand }),
      release: () => this.request("grab.end", { hand }),
    };
  }

  // Frames

  /** The cloth now. @param {Form} [form] @returns {Promise<Frame>} */
  async frame({ encoding = "f32", field } = {}) {
    const before = this._subscribed;
    await this._subscribe({ encoding, rate: 120, ...(field ? { field } : {}) });
    try {
      return await this._until(() => this._frame, "a frame", this._setup.timeout);
    } finally {
      if (this.connected) await this._subscribe(before);
    }
  }

  /**
   * Frames as they come, at most `rate` a second, always the newest; what was missed is skipped. While nothing moves none
   * come. Break off whenever you like.
   * @param {Form & Waiting & { rate?: number }} [form]
   * @returns {AsyncGenerator<Frame, void, void>}
   */
  async *frames({ rate = 60, encoding = "f32", field, timeout = Infinity } = {}) {
    await this._subscribe({ encoding, rate, ...(field ? { field } : {}) });
    /** @type {Frame | null} */
    let last = null;
    try {
      while (true) {
        last = await this._until(() => (this._frame === last ? null : this._frame), "a frame", timeout);
        yield last;
      }
    } finally {
      if (this.connected) await this._subscribe(null);
    }
  }

  /** @param {Json | null} wish */
  async _subscribe(wish) {
    // Another form may be on its way until the answer, and only what comes after it counts.
    if (this._subscribed) await this.request("stream.unsubscribe");
    this._subscribed = this._frame = null;
    if (!wish) return;
    await this.request("stream.subscribe", wish);
    this._subscribed = wish;
  }

  // The lab: each waits for its result, as long as it takes; `signal` cancels the job

  /**
   * Every method's cost and error on this scene.
   * @param {Json & { progress?: Progress, signal?: AbortSignal }} [options] methods, iterations, time, budget [s], ...
   * @returns {Promise<Json>} the `lab.result`: { job, state, result, stale, ... }
   */
  chart(options) {
    return this._measure("lab.chart", options);
  }

  /** Where each method becomes unstable. @param {Json} [options] methods, field, from, to, columns, progress, signal */
  stability(options) {
    return this._measure("lab.stability", options);
  }

  /**
   * The cheapest setting whose RMS position error over the cloth's size is at most `tolerance`.
   * @param {number} tolerance
   * @param {Json} [options] methods, time, progress, signal
   */
  choose(tolerance, options) {
    return this._measure("lab.choose", { tolerance, ...options });
  }

  /** Which parts of the model this scene needs. @param {Json} [options] tolerance, time, progress, signal */
  simplify(options) {
    return this._measure("lab.simplify", options);
  }

  /** What a job has found, as a file's text. @param {number} job @param {"svg" | "csv" | "json"} format */
  async export(job, format) {
    return /** @type {string} */ (
      await this._ask("lab.export", "text", (value) => typeof value === "string", { job, format })
    );
  }

  /**
   * @param {string} method
   * @param {Json} [options]
   * @returns {Promise<Json>}
   */
  async _measure(method, { progress, signal, ...params } = {}) {
    /** @type {Json[]} */
    const ended = [];
    let job = 0;
    const keep = (/** @type {Json[]} */ list, /** @type {Json} */ news) => list.push(news) > mostHeard && list.shift();
    const result = (/** @type {Json} */ news) => news.state !== "running" && keep(ended, news);
    /** @type {Json[]} what came with the answer that names the job, before anybody could read it */
    const early = [];
    const told = (/** @type {Json} */ news) => {
      if (job === 0) keep(early, news);
      else if (news.job === job) progress?.(news.done, news.total);
    };
    const cancel = () => this.connected && this.notify("lab.cancel", { job });
    this.on("lab.result", result);
    this.on("lab.progress", told);
    try {
      job = await this._ask(method, "job", Number.isInteger, params);
      early.forEach(told);
      signal?.addEventListener("abort", cancel);
      if (signal?.aborted) cancel();
      const mine = await this._until(() => ended.find((news) => news.job === job) ?? null, method, Infinity);
      if (mine.state === "failed")
        throw new Refused({
          code: -32603,
          message: `${method} failed: ${mine.error?.path ?? ""} ${mine.error?.found ?? ""}`,
          data: mine.error,
        });
      return mine;
    } finally {
      signal?.removeEventListener("abort", cancel);
      this.off("lab.result", result);
      this.off("lab.progress", told);
    }
  }

  // Pictures

  /** A PNG of the cloth now; width and height [pixels]. */
  async picture(width = 1280, height = 720) {
    return this._http("/api/snapshot.png", { width, height });
  }

  /** The cloth now as an .obj file. */
  async mesh() {
    return new TextDecoder().decode(await this._http("/api/mesh.obj"));
  }

  /** @param {string} path @param {Json} [query] */
  async _http(path, query = {}) {
    const { host, secure, session, token } = this._setup;
    const search = new URLSearchParams({ session, ...query });
    try {
      const answer = await fetch(`${secure ? "https" : "http"}://${host}${path}?${search}`, {
        headers: token === undefined ? {} : { authorization: `Bearer ${token}` },
      });
      const most = answer.ok ? mostAnswerBytes : 4096;
      const body = await bodyOf(answer, most);
      if (!answer.ok) {
        const why = new TextDecoder().decode(body.subarray(0, most)).trim();
        throw new ConnectionLost(`${path} (${answer.status}): ${why}`, answer.status);
      }
      if (body.length > most)
        throw new ConnectionLost(`${path}: an answer of more than ${most} bytes; ask for less`, answer.status);
      return body;
    } catch (error) {
      if (error instanceof ClothlabError) throw error;
      throw new ConnectionLost(`${path}: ${/** @type {Error} */ (error).message}`, 0);
    }
  }
}
