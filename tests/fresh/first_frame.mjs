// Waits for a frame from the server at the given URL. Uses only what comes with Node 18: nothing else is installed yet.
import { randomBytes } from "node:crypto";
import net from "node:net";

const { hostname, port, host } = new URL(process.argv[2]);
const socket = net.connect(Number(port), hostname);
const late = setTimeout(() => fail("no frame came within 60 s"), 60_000);

function fail(why) {
  console.error(`first_frame: ${why}`);
  process.exit(1);
}

function say(message) {
  const text = Buffer.from(JSON.stringify({ jsonrpc: "2.0", ...message })),
    mask = randomBytes(4);
  const masked = text.map((byte, i) => byte ^ mask[i & 3]);
  socket.write(Buffer.concat([Buffer.from([0x81, 0x80 | text.length]), mask, masked]));
}

/// The messages in the bytes received so far. Each is a single final frame, as this server sends them.
function* messages(bytes) {
  while (bytes.length >= 2) {
    const short = bytes[1] & 127,
      head = short === 126 ? 4 : short === 127 ? 10 : 2;
    if (bytes.length < head) return;
    const size = short === 126 ? bytes.readUInt16BE(2) : short === 127 ? Number(bytes.readBigUInt64BE(2)) : short;
    if (bytes.length < head + size) return;
    yield { binary: (bytes[0] & 15) === 2, payload: bytes.subarray(head, head + size) };
    bytes = bytes.subarray(head + size);
  }
}

let received = Buffer.alloc(0),
  open = false;
socket.on("error", ({ message }) => fail(message));
socket.on("close", () => fail("the server closed the connection"));
socket.on("connect", () =>
  socket.write(
    `GET /ws HTTP/1.1\r\nHost: ${host}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n` +
      `Sec-WebSocket-Key: ${randomBytes(16).toString("base64")}\r\nSec-WebSocket-Protocol: clothlab.v1\r\n\r\n`,
  ),
);
socket.on("data", (data) => {
  received = Buffer.concat([received, data]);
  const end = received.indexOf("\r\n\r\n");
  if (!open && end < 0) return;
  if (!open) {
    const status = received.toString("latin1", 0, received.indexOf("\r\n"));
    if (!status.startsWith("HTTP/1.1 101")) fail(status);
    open = true;
    received = received.subarray(end + 4);
    say({ id: 1, method: "stream.subscribe", params: { encoding: "f32" } });
  }
  for (const { binary, payload } of messages(received)) {
    if (!binary || payload[0] !== 2) continue;
    clearTimeout(late);
    console.log(`a frame of ${payload.readUInt32LE(12)} vertices at ${payload.readDoubleLE(16)} s`);
    process.exit(0);
  }
});
