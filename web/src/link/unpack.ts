// Turns c16 frames into q16 ones (server/net/README.md): the positions bit for bit, and normals made of them.
import { readPositions } from "./c16";
import { inflateRaw, type Inflate } from "./inflate";
import { packedNormals } from "./normals";
import { candidatesOf, type Candidates } from "./prediction";
import { BadMessage, decodePacked, q16Frame } from "./protocol";

/// What frames need of the topology that came before them.
export interface Mesh {
  vertexCount: number;
  triangles: Uint32Array;
}

export { BadMessage };

export class Unpacker {
  private mesh: Mesh | null = null;
  private candidates: Candidates | null = null;

  constructor(private readonly inflate: Inflate = inflateRaw) {}

  /// Frames from now on have this topology.
  take(mesh: Mesh): void {
    this.mesh = mesh;
    this.candidates = candidatesOf(mesh.vertexCount, mesh.triangles);
  }

  /// The q16 message of a c16 frame. Rejects with a BadMessage what is none, or has another topology.
  async unpack(message: ArrayBuffer): Promise<ArrayBuffer> {
    const { mesh, candidates } = this;
    const { header, deflated } = decodePacked(message);
    const { vertexCount, range, boxExtent } = header;
    if (!mesh || !candidates || mesh.vertexCount !== vertexCount)
      throw new BadMessage(`no topology of ${vertexCount} vertices came before a c16 frame`);
    const content = await this.inflate(deflated).catch((error: unknown) => {
      throw new BadMessage(`a c16 frame cannot be inflated: ${String(error)}`);
    });
    const fieldBytes = range > 0 ? vertexCount : 0;
    if (content.length < fieldBytes)
      throw new BadMessage(`a c16 frame of ${vertexCount} vertices has too short a field`);
    const numbers = readPositions(content.subarray(fieldBytes), candidates, boxExtent);
    const normals = packedNormals(numbers, mesh.triangles, boxExtent);
    return q16Frame(message, numbers, normals, content.subarray(0, fieldBytes));
  }
}
