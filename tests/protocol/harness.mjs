// A server process and its clients, over real sockets.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import http from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import WebSocket from "ws";
import { cacheIn } from "../caches.mjs";
import { decode } from "./decode.mjs";

const program = process.env.CLOTHLAB;
if (!program) throw new Error("CLOTHLAB must name the program to test");

/// [ms], generous: a busy machine under a sanitizer must not fail a test.
export const patience = 120_000;
/// The same for what the lab tells: it works at the lowest priority, and where others are busy it takes long.
export const labPatience = 8 * patience;

export const sleep = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

export function withTimeout(promise, what, milliseconds = patience) {
  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error(`waited ${milliseconds / 1000} s for ${what}`)), milliseconds);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

/// Runs the program to its end.
export async function runProgram(args) {
  const child = spawn(program, args, { stdio: ["ignore", "pipe", "pipe"] });
  let stdout = "",
    stderr = "";
  child.stdout.on("data", (data) => (stdout += data));
  child.stderr.on("data", (data) => (stderr += data));
  const [code] = await withTimeout(once(child, "close"), `clothlab ${args.join(" ")} to end`).catch((error) => {
    child.kill("SIGKILL");
    throw error;
  });
  return { code, stdout, stderr };
}

/// The lab's cache of results is each test file's own.
const cacheHome = mkdtempSync(join(tmpdir(), "clothlab-cache-"));
process.on("exit", () => rmSync(cacheHome, { recursive: true, force: true }));
/// For the program, and for programs that start it.
export const cacheEnvironment = cacheIn(cacheHome);

/// A test that fails stops before it ends its server, which would keep the test file's process alive without end.
const children = new Set();
if (process.env.NODE_TEST_CONTEXT) after(() => children.forEach((child) => child.kill("SIGKILL")));

export class Server {
  /// `clothlab serve`. A session that a test has left soon stops: it would take time from the tests that follow.
  static start(...args) {
    const unwatched = args.some((given) => given.startsWith("--unwatched-timeout")) ? [] : ["--unwatched-timeout", "2"];
    return Server.launch("serve", ...unwatched, ...args);
  }

  /// `clothlab serve` or `clothlab relay`.
  static async launch(command, ...args) {
    const server = new Server();
    server.startedAt = performance.now();
    server.child = spawn(
      process.env.CLOTHLAB,
      [command, ...(args.includes("--port") ? [] : ["--port", "0"]), ...args],
      {
        stdio: ["ignore", "pipe", "pipe"],
        // Tokens of the shell must not reach the tests.
        env: { ...process.env, ...cacheEnvironment, CLOTHLAB_TOKEN: undefined, CLOTHLAB_VIEW_TOKEN: undefined },
      },
    );
    server.closed = once(server.child, "close");
    children.add(server.child);
    server.closed.then(() => children.delete(server.child));
    server.stdout = server.stderr = "";
    server.child.stderr.on("data", (data) => (server.stderr += data));
    const line = new Promise((resolve, reject) => {
      server.child.stdout.on("data", (data) => {
        server.stdout += data;
        if (server.stdout.includes("\n")) resolve(server.stdout);
      });
      server.child.on("close", (code) => reject(new Error(`${command} ended with ${code}: ${server.stderr}`)));
    });
    const match = /^listening on (https?):\/\/([^/]+):(\d+)\/\n/.exec(await withTimeout(line, "the server to listen"));
    if (!match) throw new Error(`${command} said ${JSON.stringify(server.stdout)}`);
    server.port = Number(match[3]);
    server.host = `127.0.0.1:${server.port}`;
    return server;
  }

  /// Ends the server as a user would; returns the exit code.
  async stop(signal = "SIGTERM") {
    this.child.kill(signal);
    const [code] = await withTimeout(this.closed, "the server to end");
    return code;
  }

  get(path, headers = {}, method = "GET") {
    const answer = new Promise((resolve, reject) => {
      const request = http.request({ host: "127.0.0.1", port: this.port, path, headers, method }, async (response) => {
        const chunks = [];
        for await (const chunk of response) chunks.push(chunk);
        resolve({ status: response.statusCode, headers: response.headers, body: Buffer.concat(chunks) });
      });
      request.on("error", reject);
      request.end();
    });
    return withTimeout(answer, path);
  }

  /// The value of a metric without labels in /metrics; NaN if it is not there.
  async metric(name) {
    return Number(new RegExp(`^${name} (\\S+)$`, "m").exec((await this.get("/metrics")).body)?.[1]);
  }
}

export class RpcError extends Error {
  constructor(error) {
    super(error.message);
    this.code = error.code;
    this.data = error.data;
  }
}

export class Client {
  /// Connects and waits for the handshake; a refusal rejects with its HTTP status in `status`.
  static async connect(
    server,
    { session, protocols = ["clothlab.v1"], headers = {}, path, acknowledge = true, scheme = "ws" } = {},
  ) {
    const client = new Client();
    client.acknowledge = acknowledge;
    const where = path ?? "/ws" + (session === undefined ? "" : `?session=${session}`);
    client.socket = new WebSocket(`${scheme}://${server.host}${where}`, protocols, {
      headers,
      perMessageDeflate: false,
      rejectUnauthorized: false,
    });
    client.nextId = 1;
    client.pending = new Map();
    client.messages = []; // notifications and errors without an id, in the order of arrival
    client.binary = []; // decoded topologies and frames
    client.waiting = new Set();
    client.closed = new Promise((resolve) =>
      client.socket.on("close", (code, reason) => {
        client.over = true;
        resolve({ code, reason: reason.toString() });
        for (const { reject } of client.pending.values()) reject(new Error(`closed with ${code} ${reason}`));
      }),
    );
    client.socket.on("message", (data, isBinary) => client.receive(data, isBinary));
    const opened = new Promise((resolve, reject) => {
      client.socket.on("open", resolve);
      client.socket.on("error", reject);
      client.socket.on("unexpected-response", (_, response) => {
        response.resume();
        reject(Object.assign(new Error(`refused with ${response.statusCode}`), { status: response.statusCode }));
      });
    });
    await withTimeout(opened, "the handshake");
    client.socket.on("error", () => {});
    return client;
  }

  receive(data, isBinary) {
    if (isBinary) {
      const message = { ...decode(data, this.topologies.at(-1)), receivedAt: performance.now() };
      this.binary.push(message);
      if (message.kind === 2 && this.acknowledge) this.notify("stream.ack", { frame: message.sequence });
    } else {
      const message = JSON.parse(data.toString());
      if (message.jsonrpc !== "2.0") throw new Error("a message without jsonrpc 2.0");
      const call = this.pending.get(message.id);
      if (call) {
        this.pending.delete(message.id);
        if (message.error) call.reject(new RpcError(message.error));
        else call.resolve(message.result);
      } else {
        this.messages.push(message);
      }
    }
    for (const check of this.waiting) check();
  }

  get frames() {
    return this.binary.filter((message) => message.kind === 2);
  }
  get topologies() {
    return this.binary.filter((message) => message.kind === 1);
  }

  send(text) {
    this.socket.send(text);
  }
  notify(method, params = {}) {
    if (!this.over) this.send(JSON.stringify({ jsonrpc: "2.0", method, params }));
  }

  request(method, params, patience = undefined) {
    const id = this.nextId++;
    const answer = new Promise((resolve, reject) => this.pending.set(id, { resolve, reject }));
    this.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
    return withTimeout(answer, `the answer to ${method}`, patience);
  }

  /// The error that answers a request.
  async refusal(method, params) {
    try {
      await this.request(method, params);
    } catch (error) {
      if (error instanceof RpcError) return error;
      throw error;
    }
    throw new Error(`${method} was not refused`);
  }

  /// The first item of `list()` that satisfies `predicate`, now or later; `patience` as in withTimeout.
  until(list, predicate, what, patience) {
    let check;
    const found = new Promise((resolve) => {
      check = () => {
        const item = list().find(predicate);
        if (item !== undefined) resolve(item);
      };
      this.waiting.add(check);
      check();
    });
    return withTimeout(found, what, patience).finally(() => this.waiting.delete(check));
  }

  /// The parameters of a notification that has arrived or will arrive.
  async notification(method, predicate = () => true, wait = method.startsWith("lab.") ? labPatience : patience) {
    const message = await this.until(
      () => this.messages,
      (m) => m.method === method && predicate(m.params),
      method,
      wait,
    );
    return message.params;
  }
  /// What a job of the lab comes to: the parameters of its last lab.result.
  labResult(job) {
    return this.notification("lab.result", (result) => result.job === job && result.state !== "running");
  }
  /// Like `notification`, but only one that arrives from now on.
  nextNotification(method, predicate = () => true, patience = undefined) {
    const before = new Set(this.messages);
    return this.until(
      () => this.messages,
      (m) => !before.has(m) && m.method === method && predicate(m.params),
      method,
      patience,
    ).then((message) => message.params);
  }
  /// Waits until the server has told its status so many times more, as it does ten times a second whatever happens: for
  /// claims that nothing else comes meanwhile.
  async statuses(count) {
    for (let i = 0; i < count; ++i) await this.nextNotification("sim.status");
  }
  /// The next `count` frames, and the seconds from now to the last of them.
  async nextFrames(count) {
    const [from, before] = [performance.now(), this.frames.length];
    await this.until(
      () => this.frames.slice(before + count - 1),
      () => true,
      `${count} frames`,
    );
    return { frames: this.frames.slice(before, before + count), seconds: (performance.now() - from) / 1000 };
  }
  /// An answer with id null: the server could not read the request.
  errorWithoutId(from = 0) {
    return this.until(
      () => this.messages.slice(from),
      (m) => m.id === null && m.error,
      "an error",
    ).then((m) => m.error);
  }

  frame(predicate = () => true) {
    return this.until(() => this.frames, predicate, "a frame");
  }
  nextFrame(predicate = () => true) {
    const count = this.frames.length;
    return this.until(() => this.frames.slice(count), predicate, "a new frame");
  }

  async close() {
    this.socket.close();
    await withTimeout(this.closed, "the connection to close");
  }
}
