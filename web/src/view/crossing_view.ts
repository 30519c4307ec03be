// Draws edges that meet triangles, in front of everything else.
import { BufferGeometry, DoubleSide, Group, Mesh, MeshBasicMaterial, Vector3 } from "three";
import type { Crossings } from "../link/rpc";
import type { Vec3 } from "../link/scene_types";

const slender = 0.018; // half the width of a drawn edge over its length
const context = 0.12; // share of the scene's radius that the camera shows around the crossings

const inFront = (color: number, opacity: number): MeshBasicMaterial =>
  new MeshBasicMaterial({ color, opacity, transparent: true, side: DoubleSide, depthTest: false, toneMapped: false });

/// The triangles of a thin bar with four sides between two points.
function bar(from: Vec3, to: Vec3): Vector3[] {
  const [p, q] = [new Vector3(...from), new Vector3(...to)];
  const along = q.clone().sub(p);
  const least = Math.abs(along.y) < 0.8 * along.length() ? new Vector3(0, 1, 0) : new Vector3(1, 0, 0);
  const side = along
    .clone()
    .cross(least)
    .setLength(slender * along.length());
  const up = along
    .clone()
    .cross(side)
    .setLength(slender * along.length());
  return [side, up].flatMap((half) => {
    const [a, b, c, d] = [p.clone().add(half), p.clone().sub(half), q.clone().add(half), q.clone().sub(half)];
    return [a, b, c, c, b, d] as Vector3[];
  });
}

export class CrossingView {
  readonly object = new Group();
  private readonly triangles = new Mesh(new BufferGeometry(), inFront(0xffc21a, 0.72));
  private readonly edges = new Mesh(new BufferGeometry(), inFront(0x1268ff, 0.95));

  constructor() {
    this.object.add(this.triangles, this.edges);
    this.object.visible = false;
    this.triangles.renderOrder = 1;
    this.edges.renderOrder = 2;
  }

  /// Returns the points that the camera should show, in a scene of the radius [m].
  show({ pairs }: Crossings, radius: number): Vector3[] {
    this.triangles.geometry.setFromPoints(pairs.flatMap(({ triangle }) => triangle.at.map((x) => new Vector3(...x))));
    this.edges.geometry.setFromPoints(pairs.flatMap(({ edge }) => bar(edge.at[0] as Vec3, edge.at[1] as Vec3)));
    this.object.visible = true;
    return pairs.flatMap(({ place }) =>
      [-1, 1].flatMap((sign) =>
        [0, 1, 2].map((axis) => new Vector3(...place).setComponent(axis, (place[axis] ?? 0) + sign * context * radius)),
      ),
    );
  }

  /// False if nothing was shown.
  hide(): boolean {
    const shown = this.object.visible;
    this.object.visible = false;
    return shown;
  }
}
