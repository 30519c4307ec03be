// A viewer that connects again as the page does (web/src/link/connection.ts): after 0.25 s, then 1.6 times as long each
// time, spread out. It keeps the last frame alone.
import WebSocket from "ws";

const firstDelay = 250,
  longestDelay = 8000; // [ms]

export class Viewer {
  codes = []; // with which connections closed
  refusals = []; // the status of each refused handshake
  last = null; // {at [ms], time [s of simulated time]} of the newest frame
  back = null; // of the first frame of this connection, or of the first since somebody set this to null
  delay = firstDelay;

  constructor({ port, session, token, address }) {
    Object.assign(this, { port, session, token, address });
    this.connect();
  }

  connect() {
    const socket = new WebSocket(`ws://127.0.0.1:${this.port}/ws?session=${this.session}`, ["clothlab.v1"], {
      perMessageDeflate: false,
      localAddress: this.address,
    });
    this.socket = socket;
    this.fresh = true;
    socket.on("open", () => {
      this.request(1, "auth", { token: this.token });
      this.request(2, "stream.subscribe", { encoding: "q16", rate: 5, in_flight: 2 });
    });
    socket.on("unexpected-response", (_, response) => {
      this.refusals.push(response.statusCode);
      response.resume();
      socket.terminate();
    });
    socket.on("message", (data, binary) => this.receive(data, binary));
    socket.on("error", () => {});
    socket.on("close", (code) => {
      if (this.opened) this.codes.push(code);
      this.opened = false;
      if (!this.over) this.timer = setTimeout(() => this.connect(), this.delay * (0.8 + 0.4 * Math.random()));
      this.delay = Math.min(1.6 * this.delay, longestDelay);
    });
  }

  request(id, method, params) {
    this.socket.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
  }

  receive(data, binary) {
    if (!binary) {
      const message = JSON.parse(data);
      if (message.id === 2 && message.result) {
        this.opened = true;
        this.delay = firstDelay;
      }
      if (message.error) this.socket.close(); // such as a session that another server has opened meanwhile
      return;
    }
    if (data[0] !== 2) return;
    const frame = { at: performance.now(), time: data.readDoubleLE(16) };
    if (this.fresh) {
      this.lastTimeBefore = this.last?.time;
      this.back = frame;
    }
    this.fresh = false;
    this.last = frame;
    this.socket.send(JSON.stringify({ jsonrpc: "2.0", method: "stream.ack", params: { frame: data.readUInt32LE(8) } }));
  }

  end() {
    this.over = true;
    clearTimeout(this.timer);
    this.socket.terminate();
  }
}
