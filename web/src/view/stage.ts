// The renderer, the light, the camera and the views they draw. Draws only when something changed.
import {
  Box3,
  Color,
  DirectionalLight,
  Group,
  HemisphereLight,
  MathUtils,
  PCFShadowMap,
  PerspectiveCamera,
  Scene,
  Vector3,
  Vector4,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { ClothView, type Detail } from "./cloth_view";
import { ColliderView } from "./collider_view";
import { CameraKeeper } from "./camera_keeper";
import { CrossingView } from "./crossing_view";
import type { StageUniforms } from "./fabric_material";
import { centerIn, type FreeArea } from "./framing";
import { GroundShadow } from "./ground_shadow";
import type { ShownFrame, Topology } from "../link/protocol";
import type { Crossings } from "../link/rpc";
import { bodyPoints, frameArea, frameSubject, type PictureSize } from "./photograph";
import { Quality, stillTriangles } from "./quality";
import { framePoints, scenePoints } from "./reach";
import type { SceneDocument } from "../link/scene_types";
import { shadowSize, softenShadows } from "./studio_shader";
import type { Graphics } from "./webgl";

const stillAfter = 300; // [ms] without a change: then the picture is drawn at full resolution
const mostSamples = 3840 * 2160; // of a picture: more take memory that not every device has
const mostOfFilm = 2 * mostSamples; // whose pictures have the window's shape as they are drawn
const mostInSoftware = 1920 * 1080; // of a film's picture: more take seconds each
const explodedAt = 12; // times the scene's radius
const lightFrom = new Vector3(0.55, 1, 0.62).normalize();

/// What is drawn in the place of the session's cloth.
export interface Replacement {
  area(free: FreeArea): FreeArea; ///< the part of the free area that the scene is fitted into
  draw(renderer: WebGLRenderer, render: () => void): void; ///< calls `render` for each picture that it is made of
}

/// Takes pictures of its own size. While `take` is called the picture can be copied from the canvas, to which it is
/// stretched.
export interface Film {
  size: PictureSize;
  take(): void;
}

export class Stage {
  readonly controls: OrbitControls;
  readonly cloth: ClothView;
  onShow = (): void => undefined; ///< another frame is to be drawn
  onDraw = (): void => undefined; ///< before each picture
  private shot: Film | null = null;
  onLost = (): void => undefined; ///< the WebGL context is lost; three.js restores what it can when the context returns
  readonly canvas: HTMLCanvasElement;
  private readonly renderer: WebGLRenderer;
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(32, 1, 0.05, 100);
  private readonly light = new DirectionalLight(0xfff4e6, 2.25);
  private readonly sky = new HemisphereLight(0xf2f6ff, 0x8c8378, 1.25);
  readonly colliders: ColliderView;
  private readonly crossings = new CrossingView();
  private keptStill = false;
  private fitAfter = false; // the camera looks at crossings, and was fitted to the scene before
  private readonly groundShadow: GroundShadow;
  private readonly quality: Quality;
  private readonly detail: Detail;
  private cloths: ClothView[]; // all that are drawn, by a replacement, too
  private readonly pixelRatio = { value: 1 };
  private readonly ground = {
    groundColor: { value: new Color() },
    shadowColor: { value: new Color() },
    lineColor: { value: new Color() },
  };
  private readonly shared: StageUniforms;
  readonly overlays = new Group(); ///< what is drawn over the session's cloth
  private replacement: Replacement | null = null;
  area: FreeArea = { left: 0, top: 0, width: 1, height: 1 };
  private dirty = true;
  private readonly keeper = new CameraKeeper(this.camera);
  private document: SceneDocument | null = null;
  private latest: ShownFrame | null = null; // frame on screen
  private lastDrawn = 0;
  private lastLook = 0;
  private scale = 1; // resolution of the picture; a still picture is drawn sharp at any quality level
  private readonly stillScale: number;
  private readonly software: boolean;
  radius = 1; ///< of the scene [m]

  constructor({ canvas, context, software }: Graphics) {
    this.canvas = canvas;
    this.software = software;
    softenShadows(software);
    this.stillScale = software ? 1.5 : 1; // a software renderer has no antialiasing: more pixels smooth the edges
    this.renderer = new WebGLRenderer({ canvas, context, alpha: true });
    this.renderer.setClearColor(0, 0);
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    const stage = (this.shared = {
      lightDirection: { value: lightFrom },
      occluders: { value: Array.from({ length: 4 }, () => new Vector4()) },
      pixel: { value: 1 },
    });
    this.quality = new Quality(() => this.takeQuality(), software ? 1 : 0);
    this.detail = { ...this.quality.level, mesh: false, below: false };
    this.cloth = new ClothView(stage, this.pixelRatio, this.detail);
    this.cloths = [this.cloth];
    this.groundShadow = new GroundShadow(this.renderer, this.cloth.caster);
    this.colliders = new ColliderView(stage, this.ground, this.groundShadow.uniforms);
    this.groundShadow.casters.add(this.colliders.caster);
    this.light.castShadow = true;
    this.light.shadow.mapSize.setScalar(shadowSize(software));
    this.scene.add(this.light, this.light.target, this.sky, this.colliders.object, this.cloth.object);
    this.scene.add(this.crossings.object, this.overlays);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.controls.dampingFactor = 0.12;
    this.controls.maxPolarAngle = Math.PI * 0.56;
    this.controls.addEventListener("change", () => this.invalidate());
    this.controls.addEventListener("start", () => {
      this.keeper.fitted = this.fitAfter = false;
    });
    canvas.addEventListener("webglcontextlost", () => this.onLost());
    canvas.addEventListener("webglcontextrestored", () => this.invalidate());
    this.compileAhead();
  }

  invalidate(): void {
    this.dirty = true;
  }

  /// The frame on screen; null before the first of a topology.
  get frame(): ShownFrame | null {
    return this.latest;
  }

  /// Another cloth in the same light, for a replacement.
  makeCloth(): ClothView {
    const cloth = new ClothView(this.shared, this.pixelRatio, this.detail);
    this.cloths.push(cloth);
    return cloth;
  }

  /// True while the simulated triangles are drawn, instead of a finer mesh with a hem.
  get showsMesh(): boolean {
    return this.detail.mesh;
  }
  set showsMesh(mesh: boolean) {
    this.refit({ mesh });
  }

  /// True while lines are drawn over the simulated triangles, which a finer mesh would hide.
  set showsMeshBelow(below: boolean) {
    this.refit({ below });
  }

  private refit(detail: Partial<Detail>): void {
    const before = { ...this.detail };
    Object.assign(this.detail, detail);
    if ((Object.keys(before) as (keyof Detail)[]).every((key) => before[key] === this.detail[key])) return;
    for (const cloth of this.cloths) cloth.refit();
    this.dirty = true;
  }

  /// What casts the ground's shadow.
  get casters(): Scene {
    return this.groundShadow.casters;
  }

  /// Draws this in the place of the session's cloth, with the same camera; null: the session's cloth again.
  replace(replacement: Replacement | null): void {
    this.replacement = replacement;
    if (!replacement) this.cloths = [this.cloth];
    this.cloth.object.visible = this.cloth.caster.visible = this.overlays.visible = !replacement;
    this.resize(this.area);
  }

  /// Takes a picture of its own with each picture of the window.
  set film(film: Film | null) {
    this.shot = film;
    this.takeQuality();
  }

  get replaced(): boolean {
    return this.replacement !== null;
  }

  /// Shifts the picture so that its middle is the middle of this area.
  center(area: FreeArea): void {
    centerIn(this.camera, area, this.canvas.clientWidth, this.canvas.clientHeight);
  }

  /// What a replacement shows now: colliders go where it says, and the camera shows all of it.
  see(frames: ShownFrame[]): void {
    const lowest = Math.min(...frames.map(({ header }) => header.boxMinimum[1]));
    for (const frame of frames) this.keeper.see(framePoints(frame));
    this.colliders.update(frames[0]?.moved ?? [], lowest);
    this.invalidate();
  }

  /// True while the camera must not follow the cloth by itself: somebody pulls at it.
  keepStill(still: boolean): void {
    this.keptStill = still;
  }

  /// True while the view is the one that fits the scene: the user has not moved the camera.
  get fitted(): boolean {
    return this.keeper.fitted;
  }

  /// It is known now which vertex in frames each vertex of the document is.
  numbersArrived(): void {
    for (const cloth of this.cloths) cloth.rebuildMarkers();
    this.dirty = true;
  }

  /// Shows a document, of which bodies.ts has named the triangles; `fit` it into the view.
  setDocument(document: SceneDocument, fit: boolean): void {
    const fresh = fit || !this.document;
    this.document = document;
    this.cloth.setDocument(document);
    this.measure(this.reach());
    this.colliders.update([], this.cloth.box.isEmpty() ? 0 : this.cloth.box.min.y);
    if (fresh) this.fit(false);
    this.invalidate();
  }

  /// Points that the scene reaches. Of a cloth whose mesh is in a file only a frame tells them.
  private reach(frame = this.latest): Vector3[] {
    if (!this.document) return [];
    const points = scenePoints(this.document);
    if (frame && this.hasFiles()) points.push(...framePoints(frame));
    return points;
  }

  private hasFiles(): boolean {
    return this.document?.cloths.some(({ mesh }) => "file" in mesh || "obj" in mesh) ?? false;
  }

  /// Takes the scene's size from the points that it reaches.
  private measure(points: Vector3[]): void {
    if (!this.document) return;
    const box = new Box3().setFromPoints(points);
    this.radius = box.getSize(new Vector3()).length() / 2;
    this.colliders.setDocument(this.document, this.radius);
    this.aimLight(box.getCenter(new Vector3()), this.radius);
  }

  setTopology(topology: Topology): void {
    this.cloth.setTopology(topology);
    this.latest = null;
    if (this.keeper.fitted) this.fit(false); // another mesh: forget where the last one was seen
  }

  show(frame: ShownFrame): boolean {
    if (this.replacement) return true;
    const first = this.latest === null;
    if (first && this.hasFiles()) this.measure(this.reach(frame));
    // A cloth that has blown up would fill the window many times over: its last sane shape stays on screen.
    if (Math.max(...frame.header.boxExtent) > explodedAt * this.radius) return true;
    if (!this.cloth.show(frame)) return false;
    this.latest = frame;
    if (first && this.hasFiles()) this.keeper.foresee(framePoints(frame));
    else this.keeper.see(framePoints(frame));
    if (first && this.keeper.fitted) this.orbit(this.keeper.jump());
    this.colliders.update(frame.moved, this.cloth.box.min.y);
    this.onShow();
    this.invalidate();
    return true;
  }

  /// Takes the theme's colours from the style sheet.
  setTheme(): void {
    const style = getComputedStyle(document.documentElement);
    for (const [uniform, name] of [
      ["groundColor", "--ground"],
      ["shadowColor", "--ground-shadow"],
      ["lineColor", "--ground-line"],
    ] as const) {
      // the shader writes sRGB as it is
      this.ground[uniform].value.set(style.getPropertyValue(name).trim()).convertLinearToSRGB();
    }
    this.sky.intensity = Number(style.getPropertyValue("--sky"));
    this.invalidate();
  }

  /// Fits the whole scene into the view; with `seen`, also what is on screen now.
  fit(seen = true): void {
    if (!this.document) return;
    const damped = this.controls.enableDamping;
    this.controls.enableDamping = false; // an update without damping ends the swing of the last drag
    this.controls.update();
    this.controls.enableDamping = damped;
    this.orbit(this.keeper.fit(this.reach(), seen && this.latest ? framePoints(this.latest) : []));
  }

  private orbit(target: Vector3 | null): void {
    if (!target) return;
    this.controls.target.copy(target);
    this.controls.minDistance = this.camera.near * 4;
    this.controls.maxDistance = this.camera.far / 6;
    this.controls.update();
    this.invalidate();
  }

  /// Draws crossings in front of the cloth, and looks at them until the user moves the camera.
  showCrossings(crossings: Crossings): void {
    this.fitAfter ||= this.keeper.fitted;
    this.orbit(this.keeper.fit(this.crossings.show(crossings, this.radius)));
    this.keeper.fitted = false;
    this.invalidate();
  }

  get showsCrossings(): boolean {
    return this.crossings.object.visible;
  }

  hideCrossings(): void {
    if (!this.crossings.hide()) return;
    if (this.fitAfter) this.fit();
    this.fitAfter = false;
    this.invalidate();
  }

  resize(area: FreeArea): void {
    this.area = area;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.renderer.setSize(width, height, false);
    this.shared.pixel.value = 2 / Math.max(1, height);
    this.takeQuality();
    this.keeper.resize(this.replacement?.area(area) ?? area, width, height);
    if (this.keeper.fitted) this.orbit(this.keeper.jump());
  }

  /// The picture's resolution. The camera stays where it is.
  private takeQuality(): void {
    this.setScale(this.quality.level.scale);
    this.invalidate();
  }

  /// Called for every animation frame; true if it drew.
  draw(): boolean {
    if (this.cloth.vertices === 0) return false; // saves the time to draw an empty stage before the first frame
    const now = performance.now();
    if (!this.keptStill) this.orbit(this.keeper.follow(Math.min(now - this.lastLook, 100) / 1000));
    this.lastLook = now;
    this.controls.update();
    const sinceLast = now - this.lastDrawn;
    if (this.still || (!this.dirty && sinceLast < stillAfter)) return false;
    const scale = this.dirty ? this.quality.level.scale : this.stillScale;
    if (scale !== this.scale) this.setScale(scale);
    this.setFineness(!this.dirty);
    if (this.dirty) this.quality.sample(sinceLast);
    this.lastDrawn = now;
    this.render();
    return true;
  }

  /// True while nothing changes and the picture is the one at full resolution.
  get still(): boolean {
    return !this.dirty && this.scale === this.stillScale;
  }

  /// Draws one picture of this size, with the scene in its middle and without marks, and calls `take`, which can copy
  /// it from the canvas. A replacement is drawn as it is in the window.
  photograph({ width, height }: PictureSize, take: () => void): void {
    const { shot } = this;
    const samples = width * height * this.stillScale ** 2 <= mostSamples ? this.stillScale : 1;
    if (!this.replacement) {
      this.renderer.setPixelRatio(samples);
      this.pixelRatio.value = samples;
      this.renderer.setSize(width, height, false);
      this.shared.pixel.value = 2 / height;
    } else if (this.scale !== this.stillScale) {
      this.setScale(this.stillScale);
    }
    this.setFineness(true);
    this.shot = null;
    this.expose({ size: { width, height }, take }, this.fitted);
    this.shot = shot;
    this.resize(this.area);
  }

  /// Draws a picture beside those of the window. `refit`: as near as the scene allows that is there now.
  private expose({ size, take }: Film, refit: boolean): void {
    if (this.replacement) {
      this.renderReplacement();
      take();
      return;
    }
    const { camera, canvas, latest } = this;
    const before = camera.clone();
    const marks = [this.crossings.object, ...this.cloths.flatMap(({ marks }) => marks ?? [])].filter(
      ({ visible }) => visible,
    );
    for (const mark of marks) mark.visible = false;
    const bodies = this.colliders.bodies.flatMap(({ mesh }) => bodyPoints(mesh));
    if (refit && latest) frameSubject(camera, [...framePoints(latest), ...bodies], size);
    else frameArea(camera, this.area, { width: canvas.clientWidth, height: canvas.clientHeight }, size);
    camera.updateMatrixWorld();
    this.renderOnce();
    take();
    for (const mark of marks) mark.visible = true;
    camera.copy(before, false);
    camera.updateMatrixWorld();
  }

  private setFineness(still: boolean): void {
    const { triangles, details } = this.quality.level;
    const { dirty } = this;
    this.detail.details = still || details;
    this.refit({ triangles: still ? Math.max(stillTriangles, triangles) : triangles });
    this.dirty = dirty;
  }

  private render(): void {
    this.dirty = false;
    if (this.shot) this.expose(this.shot, false);
    this.onDraw();
    if (this.replacement) this.renderReplacement();
    else this.renderOnce();
  }

  private renderReplacement(): void {
    this.replacement?.draw(this.renderer, () => this.renderOnce());
  }

  private renderOnce(): void {
    for (const cloth of this.cloths) {
      const away = Math.max(cloth.box.distanceToPoint(this.camera.position), this.camera.near);
      cloth.pixel = (away * 2 * Math.tan(MathUtils.degToRad(this.camera.fov / 2))) / this.canvas.height;
    }
    this.groundShadow.draw();
    this.renderer.render(this.scene, this.camera);
  }

  // Lets the driver compile while the page connects, so that the first frame need not wait.
  private compileAhead(): void {
    const samples = [this.cloth.samples(), this.colliders.samples()];
    const shown = samples.flatMap((sample) => sample.shown);
    this.scene.add(...shown);
    this.renderer.compile(this.scene, this.camera);
    this.scene.remove(...shown);
    this.groundShadow.compile(samples.flatMap((sample) => sample.cast));
  }

  // Sets the size of the drawing buffer: three.js keeps the canvas's size in CSS pixels. The pictures of a film that is
  // larger than the window are drawn there, too, with all of their pixels.
  private setScale(scale: number): void {
    this.scale = scale;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const film = this.shot ? Math.max(this.shot.size.width / width, this.shot.size.height / height) : 0;
    const most = Math.sqrt((this.software ? mostInSoftware : mostOfFilm) / (width * height));
    const ratio = Math.min(devicePixelRatio, 2);
    this.renderer.setPixelRatio(film > ratio ? Math.min(film, most) : ratio * scale);
    this.pixelRatio.value = this.renderer.getPixelRatio();
  }

  private aimLight(center: Vector3, radius: number): void {
    const reach = radius * 1.15;
    this.groundShadow.aim(center, lightFrom, reach);
    this.light.target.position.copy(center);
    this.light.position.copy(center).addScaledVector(lightFrom, reach * 3);
    const { shadow } = this.light;
    Object.assign(shadow.camera, {
      left: -reach,
      right: reach,
      top: reach,
      bottom: -reach,
      near: reach,
      far: reach * 6,
    });
    shadow.camera.updateProjectionMatrix();
    shadow.normalBias = 0.012 * radius;
    shadow.bias = -0.0006;
  }
}
