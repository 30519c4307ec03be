// What one client, or the clients of one address, can do to a server within the limits of the protocol: used by
// abuse.mjs, which measures what it takes from others.
import net from "node:net";
import { Client, sleep } from "../protocol/harness.mjs";

export const token = "operator-of-this",
  viewToken = "viewer-of-this";
const bearer = { authorization: `Bearer ${viewToken}` };

export const asViewer = async (server, options = {}) => {
  const client = await Client.connect(server, options);
  await client.request("auth", { token: viewToken });
  return client;
};

/// Sends `frame` repeatedly, as fast as the socket takes it, and drops the answers.
function pour(socket, frame) {
  const many = Buffer.concat(Array(Math.ceil(65536 / frame.length)).fill(frame));
  socket.removeAllListeners("data");
  socket.resume();
  const more = () => {
    while (socket.writable && socket.write(many));
    if (socket.writable) socket.once("drain", more);
  };
  more();
}
const masked = (first, length = 0) =>
  Buffer.concat([Buffer.from([first, 0x80 | length, 0, 0, 0, 0]), Buffer.alloc(length)]);

/// Keeps `lanes` requests open at any time; each lane asks one after the other.
function keepAsking(lanes, ask) {
  const lane = async () => {
    for (;;) await ask().catch(() => sleep(10));
  };
  for (let i = 0; i < lanes; ++i) lane();
}
const get = (server, path, headers = bearer) => server.get(path, headers);

/// Sends requests and hangs up before the answers, at most `rate` times a second.
const askAndLeave = (server, path, rate) =>
  setInterval(() => {
    const socket = net.connect(server.port, "127.0.0.1", () => {
      socket.write(`GET ${path} HTTP/1.1\r\nhost: ${server.host}\r\nauthorization: ${bearer.authorization}\r\n\r\n`);
      setTimeout(() => socket.destroy(), 20);
    });
    socket.on("error", () => {});
  }, 1000 / rate);

/// Ten viewers each send `text` repeatedly, just within the allowed rate: 1900 messages a second if it is short.
async function chatter(server, text) {
  const rate = 1900 / Math.ceil(text.length / 256);
  for (let i = 0; i < 10; ++i) {
    const client = await asViewer(server);
    client.receive = () => {};
    let due = 0;
    setInterval(() => {
      for (due += rate / 100; due >= 1 && client.socket.bufferedAmount < 1e6; --due) client.send(text);
    }, 10);
  }
}
const call = (method, params = {}) => JSON.stringify({ jsonrpc: "2.0", id: 1, method, params });

export const abuses = {
  nothing: async () => {},
  "scene.get": async (server) => chatter(server, call("scene.get")),
  "stream.subscribe": async (server) => chatter(server, call("stream.subscribe", { encoding: "f32", rate: 120 })),
  "messages of 64 kB": async (server) => chatter(server, call("ping", { t: "x".repeat(65000) })),
  "messages of 64 kB that are no JSON": async (server) => chatter(server, "[".repeat(65000)),
  "messages of 64 kB of numbers": async (server) => chatter(server, call("ping", { t: Array(16000).fill(1.5) })),
  "coming and going": async (server) =>
    keepAsking(16, async () => {
      const client = await asViewer(server);
      await client.request("stream.subscribe", { encoding: "f32", rate: 120 });
      client.socket.terminate();
    }),
  pings: async (server) => pour((await asViewer(server)).socket._socket, masked(0x89)),
  "pings, ten clients": async (server) => {
    for (let i = 0; i < 10; ++i) await abuses.pings(server);
  },
  "empty fragments": async (server) => {
    const { _socket: socket } = (await asViewer(server)).socket;
    socket.write(masked(0x01));
    pour(socket, masked(0x00));
  },
  "empty fragments, ten clients": async (server) => {
    for (let i = 0; i < 10; ++i) await abuses["empty fragments"](server);
  },
  "pictures of 4096x4096": async (server) =>
    keepAsking(16, () => get(server, "/api/snapshot.png?width=4096&height=4096")),
  "pictures of 4096x4096, not waited for": async (server) =>
    askAndLeave(server, "/api/snapshot.png?width=4096&height=4096", 50),
  meshes: async (server) => keepAsking(16, () => get(server, "/api/mesh.obj")),
  "the page, over and over": async (server) => keepAsking(16, () => get(server, "/", {})),
  "metrics, over and over": async (server) => keepAsking(16, () => get(server, "/metrics")),
  "wrong tokens, WebSocket": async (server) =>
    keepAsking(8, async () => {
      const client = await Client.connect(server);
      for (let i = 0; i < 1000 && !client.over; ++i) await client.refusal("auth", { token: `guess ${i}` });
      client.socket.terminate();
    }),
  "wrong tokens, HTTP": async (server) =>
    keepAsking(16, () => get(server, "/metrics", { authorization: "Bearer guess" })),
  "connections that say nothing": async (server) =>
    setInterval(() => {
      const socket = net.connect(server.port, "127.0.0.1");
      socket.on("error", () => {});
    }, 1),
};

/// The most clients of one address that still leave it a place for a bystander.
const crowd = 31;

/// So many clients each send `text` as often as may come at once, then within the allowed rate, and read the answers.
async function burst(server, text, { count = crowd, connect = asViewer } = {}) {
  const clients = await Promise.all(Array.from({ length: count }, () => connect(server)));
  const units = Math.ceil(text.length / 256);
  for (const client of clients) {
    client.receive = () => {};
    for (let i = 0; i < 3900 / units; ++i) client.send(text);
    let due = 0;
    setInterval(() => {
      for (due += 19 / units; due >= 1 && client.socket.bufferedAmount < 1e6; --due) client.send(text);
    }, 10);
  }
}
const asOperator = async (server) => {
  const client = await Client.connect(server);
  await client.request("auth", { token });
  return client;
};

const asAnybody = async (server) => {
  const client = await Client.connect(server);
  await client.notification("hello");
  return client;
};

/// A sheet of triangles as an .obj file of about 8 MB, which is no mesh that a session keeps: its last face is wrong.
function longMesh() {
  const lines = [];
  for (let bytes = 0; bytes < 7.9e6; bytes += lines.at(-1).length + 1)
    lines.push(`v ${(lines.length % 1000) * 0.01} ${Math.floor(lines.length / 1000) * 0.01} 0.123456`);
  return lines.join("\n") + "\nf 1 2 0\n";
}

/// A scene of about 3 MB: a flat sheet whose vertices and triangles are written out.
export function longScene() {
  const side = 180; // [vertices]
  const vertices = [],
    triangles = [];
  for (let row = 0; row < side; ++row)
    for (let column = 0; column < side; ++column) {
      vertices.push([column / 179, 0.123456789, row / 179]);
      const at = row * side + column;
      if (row && column) triangles.push([at - side - 1, at - side, at], [at - side - 1, at, at - 1]);
    }
  return { version: 1, cloths: [{ mesh: { vertices, triangles } }] };
}

/// What a crowd of clients does in the session `main`; abuse.mjs serves the long scene for those of /api/scene.
export const bursts = {
  "crowd: nothing": async () => {},
  "crowd: scene.get": (server) => burst(server, call("scene.get")),
  "crowd: timeline.get": (server) => burst(server, call("timeline.get")),
  "crowd: inspect.contacts": (server) => burst(server, call("inspect.contacts")),
  "crowd: inspect.springs": (server) => burst(server, call("inspect.springs")),
  "crowd: stream.subscribe": (server) => burst(server, call("stream.subscribe", { encoding: "f32", rate: 120 })),
  "crowd: messages of 64 kB": (server) => burst(server, call("ping", { t: "x".repeat(65000) })),
  "crowd: uploads of 8 MB, four operators": async (server) => {
    const text = call("mesh.upload", { name: "long", obj: longMesh() });
    for (let i = 0; i < 4; ++i) {
      const client = await asOperator(server);
      client.receive = (data, isBinary) => {
        if (!isBinary && data.includes('"id":1')) client.send(text);
      };
      client.send(text);
    }
  },
  "crowd: lab.export of a map": async (server) => {
    const client = await asOperator(server);
    const { job } = await client.request("lab.stability", { methods: ["symplectic_euler"], columns: 8 });
    await client.notification("lab.result", ({ job: of, state }) => of === job && state === "finished");
    client.receive = () => {};
    const text = call("lab.export", { job, format: "svg" });
    setInterval(() => {
      for (let i = 0; i < 19 && client.socket.bufferedAmount < 1e6; ++i) client.send(text);
    }, 10);
  },
  "crowd: scene.get, 60 viewers of a relay": (server) =>
    burst(server, call("scene.get"), { count: 60, connect: asAnybody }),
  "crowd: /api/scene of 3 MB": async (server) => keepAsking(16, () => get(server, "/api/scene")),
  "crowd: /api/scene of 3 MB, not waited for": async (server) => askAndLeave(server, "/api/scene", 50),
};
