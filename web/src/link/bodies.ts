// The triangles of bodies whose mesh is a file or was uploaded: the scene's document has only its name.
import type { InlineMesh, SceneDocument, Vec3 } from "./scene_types";

const retryAfter = 2000; // [ms]
const nothing: InlineMesh = { vertices: [], triangles: [] };

/// Reads a binary PLY file as `/api/collider.ply` has it: vertices of three floats, triangles of a byte and three
/// indices.
export function readPly(buffer: ArrayBuffer): InlineMesh {
  const head = new TextDecoder("latin1").decode(buffer.slice(0, 1024));
  const count = (what: string): number => Number(new RegExp(`element ${what} (\\d+)`).exec(head)?.[1]);
  const [vertices, triangles] = [count("vertex"), count("face")];
  const end = "end_header\n";
  const first = head.indexOf(end) + end.length;
  if (!head.includes(end) || buffer.byteLength !== first + 12 * vertices + 13 * triangles)
    throw new Error("the server sent no mesh of a collider");
  const data = new DataView(buffer, first);
  const three = (read: (index: number) => number): Vec3 => [read(0), read(1), read(2)];
  return {
    vertices: Array.from({ length: vertices }, (_, i) => three((k) => data.getFloat32(12 * i + 4 * k, true))),
    triangles: Array.from({ length: triangles }, (_, i) =>
      three((k) => data.getUint32(12 * vertices + 13 * i + 1 + 4 * k, true)),
    ),
  };
}

export class Bodies {
  private readonly known = new Map<string, InlineMesh>(); // by the mesh in the document
  private readonly asked = new Set<string>();

  /// `fetchPly` gets the mesh of a collider by the collider's name; `arrived` is called when one is there.
  constructor(
    private readonly fetchPly: (collider: string) => Promise<ArrayBuffer>,
    private readonly arrived: () => void,
  ) {}

  /// The document with triangles in place of the names of bodies' meshes; none while they are on their way. `whole`:
  /// the server has sent the document, and a mesh of the same name may be another one.
  filled(document: SceneDocument, whole: boolean): SceneDocument {
    if (whole) this.asked.clear();
    const colliders = document.colliders.map((collider) => {
      if (!("mesh" in collider) || "vertices" in collider.mesh) return collider;
      const name = JSON.stringify(collider.mesh); // of one file there may be several nodes
      if (!this.asked.has(name)) void this.ask(name, collider.name);
      return { ...collider, mesh: this.known.get(name) ?? nothing };
    });
    return { ...document, colliders };
  }

  private async ask(name: string, collider: string): Promise<void> {
    this.asked.add(name);
    try {
      this.known.set(name, readPly(await this.fetchPly(collider)));
      this.arrived();
    } catch {
      // The server is away, or has another scene by now: that comes with a document.
      setTimeout(() => this.asked.delete(name), retryAfter);
    }
  }
}
