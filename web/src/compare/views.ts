// Draws both sides of a comparison on the stage, with its camera: side by side, or B as a ghost over A.
import type { Material, Mesh, Object3D, WebGLRenderer } from "three";
import { frameOf } from "./pack";
import { make } from "../lab/dom";
import type { ShownFrame, Topology } from "../link/protocol";
import type { MovedCollider, SceneDocument } from "../link/scene_types";
import type { FreeArea } from "../view/framing";
import type { ClothView } from "../view/cloth_view";
import type { Replacement, Stage } from "../view/stage";

const ghostColor = "#1f8fd6";
const ghostOpacity = 0.5;

type Side = "a" | "b";

/// The two parts of an area, cut across its longer side.
export function halves(area: FreeArea): [FreeArea, FreeArea] {
  const { left, top, width, height } = area;
  return width >= height
    ? [
        { ...area, width: width / 2 },
        { ...area, left: left + width / 2, width: width / 2 },
      ]
    : [
        { ...area, height: height / 2 },
        { ...area, top: top + height / 2, height: height / 2 },
      ];
}

// Only types of three.js are imported here: else its code could not stay in the page's own script.
function eachMesh(object: Object3D, change: (mesh: Mesh) => void): void {
  object.traverse((each) => {
    if ("isMesh" in each) change(each as Mesh);
  });
}

function eachMaterial(object: Object3D, change: (material: Material) => void): void {
  eachMesh(object, ({ material }) => [material].flat().forEach(change));
}

export class Views implements Replacement {
  private readonly cloths: Record<Side, ClothView>;
  private readonly labels: Record<Side, HTMLElement> = {
    a: make("div", "compare-label a"),
    b: make("div", "compare-label b"),
  };
  private readonly line = make("div", "compare-line");
  private mode: "side" | "ghost" = "side";
  private swapped = false; // B is first; as a ghost: A is it
  private document: SceneDocument | null = null;
  private free: FreeArea;

  constructor(
    private readonly stage: Stage,
    private readonly topology: Topology,
  ) {
    this.free = stage.area;
    this.cloths = { a: stage.makeCloth(), b: stage.makeCloth() };
    for (const cloth of Object.values(this.cloths)) {
      cloth.setTopology(topology);
      stage.scene.add(cloth.object);
      stage.casters.add(cloth.caster);
    }
    stage.canvas.after(this.line, this.labels.a, this.labels.b);
    stage.replace(this);
  }

  close(): void {
    for (const cloth of Object.values(this.cloths)) {
      cloth.setTopology(this.topology); // frees its buffers
      eachMaterial(cloth.object, (material) => material.dispose());
      cloth.object.removeFromParent();
      cloth.caster.removeFromParent();
    }
    for (const each of [this.line, this.labels.a, this.labels.b]) each.remove();
    this.stage.replace(null);
  }

  arrange(mode: "side" | "ghost", swapped: boolean): void {
    this.mode = mode;
    this.swapped = swapped;
    if (this.document) this.dress(this.document);
    this.stage.replace(this); // the camera fits into another area
  }

  setScene(document: SceneDocument): void {
    this.document = document;
    this.dress(document);
  }

  setLabels(a: string, b: string): void {
    this.labels.a.textContent = a;
    this.labels.b.textContent = b;
  }

  private get ghost(): Side | null {
    return this.mode === "side" ? null : this.swapped ? "a" : "b";
  }

  private dress(document: SceneDocument): void {
    for (const side of ["a", "b"] as const) {
      const ghostly = side === this.ghost;
      const cloths = ghostly
        ? document.cloths.map((cloth) => ({ ...cloth, color: ghostColor, texture: "plain" }))
        : document.cloths;
      this.cloths[side].setDocument({ ...document, cloths });
      this.haunt(side, ghostly);
    }
  }

  private haunt(side: Side, ghostly: boolean): void {
    eachMesh(this.cloths[side].object, (mesh) => {
      mesh.castShadow = mesh.receiveShadow = !ghostly;
      mesh.renderOrder = ghostly ? 1 : 0;
    });
    eachMaterial(this.cloths[side].object, (material) => {
      if (material.transparent === ghostly) return;
      Object.assign(material, { transparent: ghostly, opacity: ghostly ? ghostOpacity : 1, depthWrite: !ghostly });
      material.needsUpdate = true;
    });
  }

  /// Shows both sides at a time [s].
  show(a: Float32Array, b: Float32Array, time: number, moved: MovedCollider[]): void {
    const frames: ShownFrame[] = [];
    for (const [side, places] of [
      ["a", a],
      ["b", b],
    ] as const) {
      const frame = frameOf(places, this.topology, time, moved);
      this.cloths[side].show(frame);
      this.haunt(side, side === this.ghost); // the first frame makes the mesh
      frames.push(frame);
    }
    this.stage.see(frames);
  }

  area(free: FreeArea): FreeArea {
    this.free = free;
    this.place();
    return this.mode === "side" ? halves(free)[0] : free;
  }

  draw(renderer: WebGLRenderer, render: () => void): void {
    const { a, b } = this.cloths;
    const { clientWidth: width, clientHeight: height } = this.stage.canvas;
    if (this.mode === "ghost") {
      this.visible(true, true);
      const solid = this.swapped ? b : a;
      a.caster.visible = a === solid;
      b.caster.visible = b === solid;
      render();
      return;
    }
    const parts = halves(this.free);
    const across = this.free.width >= this.free.height;
    const cut = across ? this.free.left + this.free.width / 2 : this.free.top + this.free.height / 2;
    renderer.setScissorTest(true);
    for (const [i, side] of (this.swapped ? (["b", "a"] as const) : (["a", "b"] as const)).entries()) {
      const [from, to] = i === 0 ? [0, cut] : [cut, across ? width : height];
      if (across) renderer.setScissor(from, 0, to - from, height);
      else renderer.setScissor(0, height - to, width, to - from);
      this.stage.center(parts[i] as FreeArea);
      this.visible(side === "a", side === "b");
      render();
    }
    renderer.setScissorTest(false);
    this.stage.center(parts[0]);
  }

  private visible(a: boolean, b: boolean): void {
    this.cloths.a.object.visible = this.cloths.a.caster.visible = a;
    this.cloths.b.object.visible = this.cloths.b.caster.visible = b;
  }

  // The labels at the top of their parts, and the line between them.
  private place(): void {
    const { left, top, width, height } = this.free;
    const parts = this.mode === "side" ? halves(this.free) : null;
    for (const [i, side] of (this.swapped ? (["b", "a"] as const) : (["a", "b"] as const)).entries()) {
      const part = parts?.[i] ?? { left, top: top + 30 * i, width };
      const { style } = this.labels[side];
      style.left = `${part.left + part.width / 2}px`;
      style.top = `${part.top + 8}px`;
      style.maxWidth = `${part.width - 12}px`;
      this.labels[side].classList.toggle("ghost", side === this.ghost);
    }
    this.line.hidden = parts === null;
    const across = width >= height;
    Object.assign(this.line.style, {
      left: `${across ? left + width / 2 : left}px`,
      top: `${across ? top : top + height / 2}px`,
      width: across ? "0" : `${width}px`,
      height: across ? `${height}px` : "0",
    });
  }
}
