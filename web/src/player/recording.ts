// Reads a recording, a .clothlab file (server/stream/README.md). Whatever is not exactly one throws a BadRecording.
import { inflateRaw, type Inflate } from "../link/inflate";
import { BadMessage, decode, type Topology } from "../link/protocol";
import { applyPatch } from "../link/json_patch";
import type { InlineMesh, MovedCollider, Patch, SceneDocument, Vec3 } from "../link/scene_types";
import { candidatesOf, edgesOf, unfold, type Candidates } from "../link/prediction";

const headBytes = 16;
const chunkHeadBytes = 12;
const groupHeadBytes = 20;
const fromFrameBefore = 0x80;
const longestGroup = 120; // frames

/// No recording, or a damaged one; nothing of it may be shown.
export class BadRecording extends Error {}

function demand(condition: boolean, what: string): asserts condition {
  if (!condition) throw new BadRecording(what);
}

/// What the frames of a stretch of a recording have in common.
export interface Setting {
  document: SceneDocument; ///< with the triangles of its bodies
  topology: Topology;
  edges: Uint32Array; ///< low and high vertex of each
  restLengths: Float32Array; ///< of the edges [m]
  candidates: Candidates;
}

/// Frames that are compressed together, not read yet.
export interface Group {
  first: number; ///< number of its first frame
  count: number;
  setting: Setting;
  head: DataView;
  deflated: Uint8Array;
}

/// The cloth at one moment: position = low + quantum * number.
export interface Moment {
  time: number; ///< simulated [s]
  step: number;
  asleep: boolean;
  diverged: boolean;
  low: Vec3; ///< [m]
  quantum: number; ///< [m]
  numbers: Uint16Array; ///< [vertex_count * 3]
  moved: MovedCollider[];
}

export interface Recording {
  name: string;
  rate: number; ///< frames a second
  frames: number;
  groups: Group[];
  diverged: { reason: string; remedy: string } | null; ///< how it ended
}

interface Chunk {
  kind: string;
  at: number;
  bytes: Uint8Array;
}

const crcTable = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c;
});

/// CRC-32, as in PNG, of these bytes one after another.
function crc32(...parts: Uint8Array[]): number {
  let c = ~0;
  for (const part of parts) for (const byte of part) c = (crcTable[(c ^ byte) & 255] as number) ^ (c >>> 8);
  return ~c >>> 0;
}

function* chunksOf(file: Uint8Array): Generator<Chunk> {
  const view = new DataView(file.buffer, file.byteOffset, file.byteLength);
  const magic = new TextDecoder("latin1").decode(file.subarray(0, 8));
  demand(file.length >= headBytes && magic === "CLOTHLAB", "this is no recording: it does not begin with CLOTHLAB");
  const version = view.getUint32(8, true);
  demand(version === 1, `this recording has version ${version}, which this player does not know: use a newer one`);
  demand(view.getUint32(12, true) === 0, "this recording is damaged: bytes 12 to 15 are not 0");
  for (let at = headBytes; at < file.length; ) {
    const cut = `this recording is cut off at byte ${file.length}: copy or download it again`;
    demand(at + chunkHeadBytes <= file.length, cut);
    const kind = new TextDecoder("latin1").decode(file.subarray(at, at + 4));
    demand(/^[a-z]{4}$/.test(kind), `this recording is damaged at byte ${at}: copy or download it again`);
    const end = at + chunkHeadBytes + view.getUint32(at + 4, true);
    demand(end <= file.length, cut);
    const bytes = file.subarray(at + chunkHeadBytes, end);
    demand(
      crc32(file.subarray(at, at + 4), bytes) === view.getUint32(at + 8, true),
      `this recording is damaged between byte ${at} and ${end} (${kind}): copy or download it again`,
    );
    yield { kind, at, bytes };
    at = end;
  }
}

/// Reads everything but the frames.
export class Reader {
  private document: SceneDocument | null = null;
  private topology: Topology | null = null;
  private candidates: Candidates | null = null;
  private edges: Uint32Array = new Uint32Array();
  private restLengths = new Float32Array();
  private readonly bodies = new Map<number, InlineMesh>();
  private setting: Setting | null = null;
  private readonly made: Recording = { name: "", rate: 0, frames: 0, groups: [], diverged: null };
  private done = false;

  private constructor(private readonly inflate: Inflate) {}

  static async open(file: ArrayBuffer, inflate: Inflate = inflateRaw): Promise<Recording> {
    const reader = new Reader(inflate);
    for (const chunk of chunksOf(new Uint8Array(file))) {
      demand(!reader.done, `this recording has more after its end, at byte ${chunk.at}`);
      demand((chunk.kind === "head") === (reader.made.rate === 0), "this recording does not begin with its head");
      try {
        await reader.take(chunk);
      } catch (error) {
        if (error instanceof BadRecording) throw error;
        throw new BadRecording(`this recording cannot be read at byte ${chunk.at} (${chunk.kind}): ${String(error)}`);
      }
    }
    demand(reader.done, "this recording has no end: it is cut off, or is still being made");
    return reader.made;
  }

  private async take({ kind, at, bytes }: Chunk): Promise<void> {
    if (kind === "fram") return this.takeGroup(bytes, at);
    const content = await this.inflate(bytes);
    const json = (): Record<string, unknown> => JSON.parse(new TextDecoder().decode(content));
    if (kind === "head") {
      const { scene, rate } = json() as { scene: SceneDocument; rate: number };
      demand(rate > 0 && rate < 1e4, `this recording has ${rate} frames a second`);
      Object.assign(this.made, { name: scene.name, rate });
      this.document = scene;
    } else if (kind === "mesh") {
      this.takeMesh(content);
    } else if (kind === "rest") {
      demand(content.length % 4 === 0, "lengths at rest that are no numbers");
      this.restLengths = new Float32Array(content.slice().buffer);
    } else if (kind === "body") {
      this.takeBody(content);
    } else if (kind === "nums") {
      this.takeNumbers(content);
    } else if (kind === "edit") {
      const { patch, document } = json() as { patch?: Patch; document?: SceneDocument };
      if (document) this.document = document;
      else if (patch && this.document) this.document = applyPatch(this.document, patch);
    } else if (kind === "done") {
      const { frames, diverged } = json() as { frames: number; diverged: Recording["diverged"] };
      demand(frames === this.made.frames, `this recording says it has ${frames} frames, and has ${this.made.frames}`);
      this.made.diverged = diverged;
      this.done = true;
    } // of other kinds a later version may tell
    this.setting = null;
  }

  private takeMesh(message: Uint8Array): void {
    const read = decode(message.slice().buffer);
    if (!("topology" in read)) throw new BadMessage("a frame in place of a topology");
    this.topology = read.topology;
    for (const range of this.topology.cloths) range.numbers = "same"; // what has others says so in its own chunk
    this.candidates = candidatesOf(read.topology.vertexCount, read.topology.triangles);
    this.edges = edgesOf(read.topology.triangles);
    this.restLengths = new Float32Array();
    this.bodies.clear();
  }

  private takeBody(content: Uint8Array): void {
    const view = new DataView(content.buffer, content.byteOffset, content.byteLength);
    const [collider, vertices, triangles] = [0, 4, 8].map((at) => view.getUint32(at, true)) as Vec3;
    demand(content.length === 12 + 12 * vertices + 12 * triangles, "a body of another size than it says");
    const three = (from: number, read: (at: number) => number): Vec3 => [read(from), read(from + 4), read(from + 8)];
    const float = (at: number): number => view.getFloat32(at, true);
    const index = (at: number): number => view.getUint32(at, true);
    this.bodies.set(collider, {
      vertices: Array.from({ length: vertices }, (_, i) => three(12 + 12 * i, float)),
      triangles: Array.from({ length: triangles }, (_, i) => three(12 + 12 * vertices + 12 * i, index)),
    });
  }

  private takeNumbers(content: Uint8Array): void {
    demand(content.length >= 4 && content.length % 4 === 0, "numbers of vertices that are none");
    const all = new Uint32Array(content.slice().buffer);
    const range = this.topology?.cloths[all[0] as number];
    demand(range !== undefined, `numbers of vertices of cloth ${all[0]}, which is none`);
    range.numbers = all.subarray(1);
  }

  private takeGroup(bytes: Uint8Array, at: number): void {
    const { topology, document, candidates, edges, restLengths } = this;
    demand(topology !== null && document !== null && candidates !== null, `frames at byte ${at} come before a mesh`);
    demand(2 * restLengths.length === edges.length, `frames at byte ${at} come before the lengths at rest`);
    demand(bytes.length > groupHeadBytes, `frames at byte ${at} have no head`);
    const head = new DataView(bytes.buffer, bytes.byteOffset, groupHeadBytes);
    const count = head.getUint32(0, true);
    demand(count > 0 && count <= longestGroup, `${count} frames at byte ${at}, of 1 to ${longestGroup}`);
    demand(
      [4, 8, 12, 16].every((place) => Number.isFinite(head.getFloat32(place, true))) && head.getFloat32(16, true) > 0,
      `frames at byte ${at} have no places`,
    );
    if (!this.setting) {
      const colliders = document.colliders.map((collider, i) => {
        const mesh = "mesh" in collider ? this.bodies.get(i) : undefined;
        return mesh ? { ...collider, mesh } : collider;
      });
      this.setting = { document: { ...document, colliders }, topology, edges, restLengths, candidates };
    }
    const deflated = bytes.subarray(groupHeadBytes);
    this.made.groups.push({ first: this.made.frames, count, setting: this.setting, head, deflated });
    this.made.frames += count;
  }
}

/// Reads the frames of a group.
export async function readGroup(group: Group, inflate: Inflate = inflateRaw): Promise<Moment[]> {
  const { count, head, setting } = group;
  const vertices = setting.topology.vertexCount;
  const content = await inflate(group.deflated);
  const planesAt = 17 * count;
  const end = planesAt + 6 * count * vertices;
  demand(content.length >= end, `the frames from ${group.first} on are not complete`);
  const view = new DataView(content.buffer, content.byteOffset, content.byteLength);
  const text = new TextDecoder().decode(content.subarray(end));
  const moving = (text === "" ? [] : JSON.parse(text)) as MovedCollider[][];
  const low = [4, 8, 12].map((at) => head.getFloat32(at, true)) as Vec3;
  const quantum = head.getFloat32(16, true);
  let before: Uint16Array | null = null;
  return Array.from({ length: count }, (_, frame) => {
    const flags = view.getUint8(16 * count + frame);
    const planes = Array.from({ length: 6 }, (_plane, k) => {
      const from = planesAt + (k * count + frame) * vertices;
      return content.subarray(from, from + vertices);
    });
    const numbers = unfold(planes, setting.candidates, flags & fromFrameBefore ? before : null);
    before = numbers;
    return {
      time: view.getFloat64(8 * frame, true),
      step: Number(view.getBigUint64(8 * (count + frame), true)),
      asleep: (flags & 1) !== 0,
      diverged: (flags & 2) !== 0,
      low,
      quantum,
      numbers,
      moved: moving[frame] ?? [],
    };
  });
}
