// A NATS server of one's own, and whether there is one at all.
import { spawn, spawnSync } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import net from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { sleep, withTimeout } from "./harness.mjs";

// Debian has it in a folder that only root looks into.
const env = { ...process.env, PATH: `${process.env.PATH}:/usr/sbin` };

/// Why tests that need a bus are skipped; false: they are not.
export function noBus() {
  if (spawnSync("nats-server", ["--version"], { env }).error) return "nats-server is not installed";
  const info = spawnSync(process.env.CLOTHLAB, ["info"], { encoding: "utf8" }).stdout;
  return /^bus +nats /m.test(info) ? false : "this program was built without libnats";
}

export async function freePort() {
  const listener = net.createServer().listen(0, "127.0.0.1");
  await once(listener, "listening");
  const { port } = listener.address();
  listener.close();
  await once(listener, "close");
  return port;
}

const children = new Set();
if (process.env.NODE_TEST_CONTEXT) after(() => children.forEach((child) => child.kill("SIGKILL")));

export class NatsServer {
  /// `settings` are lines of its configuration file.
  static async start(settings = "", port = undefined) {
    const bus = new NatsServer();
    bus.port = port ?? (await freePort());
    bus.settings = settings;
    bus.url = `nats://127.0.0.1:${bus.port}`;
    await bus.run();
    return bus;
  }

  async run() {
    const folder = mkdtempSync(join(tmpdir(), "clothlab-nats-"));
    const file = join(folder, "nats.conf");
    writeFileSync(file, `host: 127.0.0.1\nport: ${this.port}\n${this.settings}\n`);
    this.child = spawn("nats-server", ["-c", file], { stdio: ["ignore", "ignore", "pipe"], env });
    children.add(this.child);
    let said = "";
    this.child.stderr.on("data", (data) => (said += data));
    this.closed = once(this.child, "close").then(() => {
      children.delete(this.child);
      rmSync(folder, { recursive: true, force: true });
    });
    const ready = async () => {
      while (!said.includes("Server is ready")) {
        if (this.child.exitCode !== null) throw new Error(`nats-server ended: ${said}`);
        await sleep(20);
      }
    };
    await withTimeout(ready(), "nats-server to listen");
  }

  async stop(signal = "SIGKILL") {
    this.child.kill(signal);
    await this.closed;
  }
}

/// A client of the bus, for what a script of one's own would do: the text protocol of NATS as its documentation has it.
export class NatsClient {
  static async connect(bus) {
    const client = new NatsClient();
    client.socket = net.connect(bus.port, "127.0.0.1");
    client.messages = []; // {subject, reply, headers, data}
    client.rest = Buffer.alloc(0);
    client.socket.on("data", (data) => client.read(data));
    client.socket.on("error", () => {});
    await once(client.socket, "connect");
    client.socket.write('CONNECT {"verbose":false,"headers":true,"no_responders":true}\r\n');
    return client;
  }

  read(data) {
    this.rest = Buffer.concat([this.rest, data]);
    for (let end; (end = this.rest.indexOf("\r\n")) >= 0; ) {
      const words = this.rest.toString("latin1", 0, end).split(" ");
      const from = end + 2;
      if (words[0] === "MSG" || words[0] === "HMSG") {
        const size = Number(words.at(-1));
        if (this.rest.length < from + size + 2) return;
        const head = words[0] === "HMSG" ? Number(words.at(-2)) : 0;
        const given = words.slice(1, words[0] === "HMSG" ? -2 : -1);
        this.messages.push({
          subject: given[0],
          reply: given[2],
          headers: this.rest.toString("utf8", from, from + head),
          data: Buffer.from(this.rest.subarray(from + head, from + size)),
        });
        this.rest = this.rest.subarray(from + size + 2);
      } else {
        if (words[0] === "PING") this.socket.write("PONG\r\n");
        this.rest = this.rest.subarray(from);
      }
    }
  }

  subscribe(subject, id) {
    this.socket.write(`SUB ${subject} ${id}\r\n`);
  }
  publish(subject, data, reply = "") {
    const bytes = Buffer.from(data);
    this.socket.write(
      Buffer.concat([Buffer.from(`PUB ${subject} ${reply} ${bytes.length}\r\n`), bytes, Buffer.from("\r\n")]),
    );
  }
  async until(predicate, what) {
    const found = async () => {
      for (;;) {
        const message = this.messages.find(predicate);
        if (message) return message;
        await sleep(10);
      }
    };
    return withTimeout(found(), what);
  }
  end() {
    this.socket.destroy();
  }
}
