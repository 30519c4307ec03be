// Checks everything that the harness's clients send and receive against server/net/asyncapi.yaml.
import { operation, operations, payloadComplaints, readBinary, document } from "./asyncapi.mjs";
import { Client } from "./harness.mjs";

const short = (value) => JSON.stringify(value).slice(0, 300);
const refusals = operation("refuse").messages;
const told = new Set(
  operations
    .filter(({ action, name }) => action === "send" && !["refuse", "stream"].includes(name))
    .flatMap((o) => o.messages),
);

/// Places of faults in requests that only the server can find: no schema can tell them.
const knownByTheServerOnly = {
  "scene.load": /^\/preset$/, // a name that is not of a preset
  "scene.patch": /^/, // a patch whose result is no valid scene
  "scene.undo": /^/, // a scene that can no longer be, as its mesh is gone
  "scene.redo": /^/,
  "timeline.resume": /^\/step$/, // one that is not kept
  "grab.start": /^\/(cloth|vertex)$/, // none of the scene
  "grab.move": /^\/hand$/, // one that holds nothing
  "grab.end": /^\/hand$/,
  "lab.cancel": /^\/job$/,
  "lab.export": /^\/job$/, // a job of somebody else, or one without results yet
};

export class Audit {
  faults = [];
  seen = new Set(); ///< names of messages seen, all of them valid
  closeCodes = new Set();
  clients = new Map(); ///< { role, pending: id -> request }

  /// Listens to every client from now on.
  begin() {
    const audit = this,
      { send, receive } = Client.prototype;
    Client.prototype.send = function (text) {
      audit.sent(this, text);
      return send.call(this, text);
    };
    Client.prototype.receive = function (data, isBinary) {
      if (isBinary) audit.gotBinary(data);
      else audit.got(this, JSON.parse(data.toString()));
      return receive.call(this, data, isBinary);
    };
  }

  of(client) {
    if (!this.clients.has(client)) {
      this.clients.set(client, { role: null, pending: new Map() });
      client.closed.then(({ code }) => {
        this.closeCodes.add(code);
        if (code >= 1006 && !(code in document.channels.session["x-close-codes"]))
          this.faults.push(`closed with ${code}`);
      });
    }
    return this.clients.get(client);
  }

  sent(client, text) {
    const about = this.of(client);
    const message = read(text);
    const asked = operation(message?.method);
    if (asked?.action !== "receive") return;
    const complaints = payloadComplaints(asked.name, message);
    const request = { asked, message, complaints };
    if (message.id !== undefined) about.pending.set(message.id, request);
    else if (complaints.length === 0) this.seen.add(asked.name);
  }

  got(client, message) {
    const about = this.of(client);
    if (message.method !== undefined) return this.gotNotification(about, message);
    const request = about.pending.get(message.id);
    about.pending.delete(message.id);
    const names = [...(request?.asked.replies ?? []), ...refusals].filter(
      (name) => payloadComplaints(name, message).length === 0,
    );
    if (names.length !== 1) {
      const most =
        request?.asked.replies[0] && message.result ? payloadComplaints(request.asked.replies[0], message) : names;
      this.faults.push(
        `to ${short(request?.message)} came ${short(message)}, which is not one of its answers: ${most}`,
      );
      return;
    }
    this.seen.add(names[0]);
    if (request) this.judge(about, request, names[0], message);
  }

  /// Notes a fault if the document and the server disagree about a request.
  judge({ role }, { asked, message, complaints }, answer, { error }) {
    const fault = (what) => this.faults.push(`${short(message)} ${what}: ${short(error ?? answer)}`);
    const right = complaints.length === 0;
    if (right) this.seen.add(asked.name);
    if (answer.startsWith("result.")) {
      if (!right) fault(`is taken, though the document has it that ${complaints}`);
      if (asked["x-role"] === "operator" && role !== "operator") fault(`is allowed to a ${role}`);
    } else if (answer === "error.invalid_params" && right && !knownByTheServerOnly[asked.name]?.test(error.data.path)) {
      fault("is refused, though the document would have it");
    } else if (
      answer === "error.not_allowed" &&
      role !== null &&
      asked["x-role"] !== "operator" &&
      asked.name !== "auth"
    ) {
      fault(`is not allowed to a ${role}`);
    } else if (answer === "error.unknown_method") {
      fault("is unknown");
    }
  }

  gotNotification(about, message) {
    if (!told.has(message.method)) return this.faults.push(`${message.method} is unknown: ${short(message)}`);
    const complaints = payloadComplaints(message.method, message);
    if (complaints.length > 0) return this.faults.push(`${message.method}: ${complaints}: ${short(message)}`);
    this.seen.add(message.method);
    if (message.method === "hello") about.role = message.params.role;
  }

  gotBinary(data) {
    try {
      const { header } = readBinary(data);
      this.seen.add(header.kind === 1 ? "topology" : "frame");
    } catch (error) {
      this.faults.push(`a binary message of ${data.length} bytes is not as x-binary says: ${error}`);
    }
  }
}

function read(text) {
  try {
    return JSON.parse(text);
  } catch {
    return undefined;
  }
}
