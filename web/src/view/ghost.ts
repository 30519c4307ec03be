// The cloth as it would lie while its handles are dragged: pale, over the cloth that is where it was.
import { BufferAttribute, BufferGeometry, DoubleSide, Mesh, MeshBasicMaterial, type Object3D, Vector3 } from "three";
import { Places } from "./places";
import type { Stage } from "./stage";

export class Ghost {
  readonly object = new Mesh(
    new BufferGeometry(),
    new MeshBasicMaterial({ color: 0xd9776a, transparent: true, opacity: 0.4, side: DoubleSide, depthWrite: false }),
  );

  constructor(private readonly stage: Stage) {
    this.hide();
  }

  /// Shows the cloth of this number as it is now, to go with `frame` from now on.
  show(cloth: number, frame: Object3D): void {
    const { topology } = this.stage.cloth;
    const range = topology?.cloths[cloth];
    if (!topology || !range || !this.stage.frame) return;
    const places = new Places(this.stage.frame);
    frame.updateMatrixWorld();
    const into = frame.matrixWorld.clone().invert();
    const at = new Float32Array(3 * range.vertexCount);
    const place = new Vector3();
    for (let i = 0; i < range.vertexCount; ++i)
      places
        .of(range.firstVertex + i, place)
        .applyMatrix4(into)
        .toArray(at, 3 * i);
    const end = range.firstVertex + range.vertexCount;
    const own = (vertex: number): boolean => vertex >= range.firstVertex && vertex < end;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(at, 3));
    geometry.setIndex([...topology.triangles.filter(own)].map((vertex) => vertex - range.firstVertex));
    this.object.geometry.dispose();
    this.object.geometry = geometry;
    this.object.visible = true;
  }

  hide(): void {
    this.object.visible = false;
  }
}
