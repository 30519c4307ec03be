// Connects the parts of the page: the link, the scene's document, the stage and the controls.
import { Connection, type LinkEvents } from "./link/connection";
import { ColourBy } from "./panel/colour_by";
import { button, element } from "./panel/dom";
import type { SolverFacts } from "./panel/field";
import { beyond, saferStep, type Stability } from "./panel/gauge";
import { Hud, type Status } from "./panel/hud";
import { tellCrossings } from "./panel/crossings";
import { bindFirstSteps } from "./panel/newcomer";
import { bindKeys } from "./panel/keys";
import { Lab } from "./lab/drawer";
import { Layout } from "./panel/layout";
import { LinkView } from "./panel/link_view";
import { Guide } from "./explain/guide";
import {
  clearDiverged,
  notice,
  noticeError,
  showApplied,
  showDiverged,
  type Diverged,
  type Level,
} from "./panel/notices";
import { takeDroppedMeshes } from "./panel/mesh_drop";
import { Panel } from "./panel/panel";
import { Bodies } from "./link/bodies";
import type { Fabric } from "./link/fabrics";
import type { ShownFrame } from "./link/protocol";
import { RpcError } from "./link/rpc";
import { SlowWatch } from "./panel/slow_watch";
import { SceneStore } from "./link/scene_store";
import type { MovedCollider, Patch, SceneDocument } from "./link/scene_types";
import type { Stage } from "./view/stage";
import { hook } from "./test_hook";
import { bindCameraInput } from "./view/camera_input";
import { ThemeSwitch } from "./view/theme";
import { Transport } from "./panel/transport";
import { timeStep } from "./panel/solver_section";

type Params = Record<string, unknown>;

export class Page {
  private stage!: Stage; // set by show(), before the first event of the connection
  private readonly hud = new Hud();
  private readonly connection = new Connection(
    new URLSearchParams(location.search).get("session") ?? "main",
    this.linkEvents(),
  );
  private readonly link = new LinkView(this.connection);
  private readonly transport = new Transport({ request: (method, params) => this.request(method, params) });
  private readonly slow = new SlowWatch((operations) => this.store.edit(operations));
  private readonly bodies = new Bodies(
    (name) => this.connection.get("/api/collider.ply", { name }),
    () => this.drawDocument(this.stage.fitted),
  );
  private readonly store: SceneStore = this.makeStore();
  private readonly guide = new Guide();
  private readonly panel = this.makePanel();
  private readonly lab = this.makeLab();
  private readonly notifications = this.makeNotifications();
  private readonly colourBy = new ColourBy(
    (field) => this.connection.setField(field),
    () => this.layout?.cardToggled(),
  );
  private layout: Layout | null = null;
  private latest: ShownFrame | null = null;
  private moved: MovedCollider[] = []; // colliders' places for the next frame
  private sceneName = "";
  private toldOfDivergence = false;
  private diverged = false; // in the last status
  private stability: Stability | null = null; // in the last status
  private fitNext = false; // the next frame is the first of another cloth
  private closeCrossings = (): void => undefined; // takes a refusal for crossings away
  private mayEdit = true; // false for a viewer, who may only watch

  constructor() {
    this.connection.connect();
  }

  /// Draws on this stage from now on.
  show(stage: Stage): void {
    this.stage = hook.stage = stage;
    const layout: Layout = (this.layout = new Layout(() => stage.resize(layout.freeArea())));
    const theme = new ThemeSwitch(() => stage.setTheme());
    this.bind(layout, theme);
    stage.onLost = () =>
      notice("warning", {
        title: "The browser took the graphics away",
        lines: ["It gives them back by itself; if not, reload the page."],
      });
    stage.resize(layout.freeArea());
    setInterval(() => this.hud.tick(this.connection.bytesReceived), 1000);
    const animate = (): void => {
      requestAnimationFrame(animate);
      this.animate();
    };
    requestAnimationFrame(animate);
  }

  close(): void {
    this.connection.close();
  }

  private bind(layout: Layout, theme: ThemeSwitch): void {
    const fit = (): void => this.stage.fit();
    const help = element("help-dialog", HTMLDialogElement);
    bindKeys({
      toggle: () => this.transport.toggle(),
      step: () => this.transport.step(),
      reset: () => this.transport.reset(),
      fit,
      hide: () => layout.toggleInterface(),
      help: () => help.showModal(),
      lab: () => this.lab.toggle(),
    });
    bindCameraInput(this.stage.controls);
    bindFirstSteps({
      mayEdit: () => this.mayEdit,
      blowUp: () => this.blowUp(),
      lab: () => this.lab.toggle(),
      changed: () => layout.cardToggled(),
    });
    takeDroppedMeshes({
      request: (method, params) => this.connection.request(method, params),
      mayEdit: () => this.mayEdit,
      refused: (title, error, patch) => this.refused(title, error, patch),
      hung: () => {
        this.fitNext = true;
      },
    });
    button("fit").onclick = fit;
    button("help").onclick = () => help.showModal();
    button("theme").onclick = () => theme.toggle();
  }

  // Steps beyond the limit, if the method has one; else the preset that does so.
  private blowUp(): void {
    const dt = beyond(this.stability);
    if (dt) this.store.edit([{ op: "replace", path: timeStep, value: dt }]);
    else this.request("scene.load", { preset: "blowup" });
    if (!this.transport.playing) this.transport.toggle();
  }

  private animate(): void {
    const frame = this.latest;
    this.latest = null;
    const shown = frame !== null && this.stage.show(frame);
    this.stage.draw();
    if (!frame) return;
    this.connection.acknowledge(frame.header.sequence);
    if (!shown) return;
    this.hud.countDrawn();
    this.hud.setTime(frame.header.time);
    this.colourBy.show(frame.field, frame.header.range);
    this.hud.set("vertices", String(frame.header.vertexCount));
    this.link.drawing();
    hook.framesDrawn++;
    hook.lastFrame = frame;
    hook.simTime = frame.header.time;
    hook.step = frame.header.step;
    if (hook.firstFrameAt === 0) {
      hook.firstFrameAt = performance.now();
      void this.guide.load().then(() => this.panel.mark());
    }
    if (this.fitNext) this.stage.fit();
    this.fitNext = false;
  }

  private linkEvents(): LinkEvents {
    return {
      state: (state, retryIn, why) => {
        this.link.show(state, retryIn, why);
        this.transport.enable(state === "open" && this.mayEdit);
        this.lab.link(state === "open");
        this.slow.link(state === "open");
        if (state !== "open") {
          this.store.forget();
          this.guide.baseline.lost();
        }
        if (state === "open" && !this.store.document) void this.fetchScene();
      },
      notification: (method, params) => this.notifications[method]?.(params),
      topology: (topology) => this.stage.setTopology(topology),
      frame: (frame, field) => {
        hook.framesReceived++;
        this.hud.countReceived();
        this.slow.picture();
        const replaced = this.latest; // a newer frame came before this one was drawn
        if (replaced && !document.hidden) this.connection.acknowledge(replaced.header.sequence);
        this.latest = { ...frame, field, moved: this.moved };
      },
      latency: (milliseconds) => this.hud.set("latency", `${milliseconds.toFixed(milliseconds < 10 ? 1 : 0)} ms`),
      problem: (error) => noticeError("The server sent something unexpected", error),
    };
  }

  private makeStore(): SceneStore {
    return new SceneStore({
      send: (patch) => this.connection.request("scene.patch", { patch }),
      fetch: () => this.fetchScene(),
      changed: (document, whole) => this.sceneChanged(document, whole),
      applied: showApplied,
      wayBack: (operations) => this.slow.changed(operations),
      rejected: (error, operations) => {
        if (error instanceof RpcError) this.refused("Not applied", error, operations);
        this.panel.snapBack();
      },
    });
  }

  private makePanel(): Panel {
    return new Panel(
      element("panel-body", HTMLElement),
      {
        edit: (operations) => this.store.edit(operations),
        busy: (path) => this.store.busy(path),
        loadPreset: (name) => {
          this.sceneName = "";
          this.request("scene.load", { preset: name });
        },
      },
      this.guide,
    );
  }

  private makeLab(): Lab {
    return new Lab({
      request: (method, params) => this.connection.request(method, params),
      document: () => this.store.document,
      addressed: (patch) => ({
        stored: this.store.stored,
        patch: Array.isArray(patch) ? this.store.addressed(patch) : patch,
      }),
      mayEdit: () => this.mayEdit,
      applied: showApplied,
      toggled: (open) => this.layout?.labToggled(open),
    });
  }

  private makeNotifications(): Record<string, (params: Params) => void> {
    return {
      hello: (params) => this.greeted(params),
      scene: (params) => {
        this.guide.baseline.take(params.document as SceneDocument);
        this.store.replace(params.document as SceneDocument, Number(params.revision));
      },
      "scene.changed": (params) => this.store.patched(Number(params.revision), params.patch as Patch),
      colliders: (params) => {
        this.moved = params.moving as MovedCollider[];
      },
      "sim.status": (params) => {
        this.hud.showStatus(params as Status);
        this.transport.status(params as Status);
        this.slow.told(params as Status);
        this.stability = (params.stability as Stability | undefined) ?? this.stability;
        if (params.stability) this.panel.showStability(params.stability as Stability);
        if (params.solver) this.store.fabricsGive((params.solver as SolverFacts).from_fabrics ?? []);
        if (params.solver) this.panel.showSolver(params.solver as SolverFacts);
        this.followDivergence(params as Status);
      },
      "sim.diverged": (params) => this.tellDivergence(params as unknown as Diverged),
      "lab.progress": (params) => this.lab.progress(params),
      "lab.result": (params) => this.lab.arrived(params),
      viewers: (params) => this.hud.set("viewers", String(params.count)),
      notice: (params) => notice(params.level as Level, { title: String(params.text) }),
    };
  }

  private greeted(params: Params): void {
    this.hud.setRenderer(String(params.renderer));
    this.mayEdit = params.role !== "viewer";
    this.panel.setMethods((params.methods as string[] | undefined) ?? []);
    this.lab.setMethods((params.methods as string[] | undefined) ?? []);
    this.lab.roleChanged();
    document.body.classList.toggle("viewer", !this.mayEdit);
    this.transport.enable(this.connection.open && this.mayEdit);
    this.connection.request<{ presets: string[]; fabrics?: Fabric[] }>("scene.presets").then(
      ({ presets, fabrics }) => this.panel.setOffers(presets, fabrics ?? []),
      () => undefined,
    );
  }

  private sceneChanged(document: SceneDocument, whole: boolean): void {
    hook.document = document;
    this.slow.dt = document.solver.dt;
    this.moved = [];
    if (whole) this.closeCrossings();
    const newScene = whole && document.name !== this.sceneName;
    this.sceneName = document.name;
    element("scene-name", HTMLElement).textContent = document.name;
    this.drawDocument(newScene, whole);
    this.panel.show(document, this.store.stored ?? document);
    this.lab.sceneChanged();
  }

  private drawDocument(fit: boolean, whole = false): void {
    if (this.store.document) this.stage.setDocument(this.bodies.filled(this.store.document, whole), fit);
  }

  private async fetchScene(): Promise<void> {
    const answer = await this.connection
      .request<{ document: SceneDocument; revision: number }>("scene.get")
      .catch(() => null);
    if (answer) this.store.replace(answer.document, answer.revision);
  }

  private tellDivergence(diverged: Diverged): void {
    this.toldOfDivergence = true;
    // Once the patch is applied, the server continues from the last good state by itself.
    showDiverged(diverged, async (patch) => void (await this.connection.request("scene.patch", { patch })));
  }

  // Shows and clears the notice by the status: another viewer may have applied the remedy, or the scene blew up before
  // this page was opened.
  private followDivergence({ diverged, stability }: Status): void {
    if (this.diverged && !diverged) {
      clearDiverged();
      this.toldOfDivergence = false;
    }
    this.diverged = diverged === true;
    if (!this.diverged || this.toldOfDivergence) return;
    const limit = stability?.dt_limit;
    const dt = limit ? saferStep(limit) : 0;
    this.tellDivergence({
      reason: "it stopped at its last good state before this page was opened",
      ...(dt > 0 ? { remedy: { text: `set dt to ${dt} s, below its limit`, patch: { solver: { dt } } } } : {}),
    });
  }

  /// Tells why the server refused a patch. For surfaces that cross there are a picture and a way out.
  private refused(title: string, error: RpcError, patch: Patch): void {
    const close = tellCrossings(title, error, patch, {
      show: (crossings) => this.stage.showCrossings(crossings),
      hide: () => this.stage.hideCrossings(),
      send: (instead) => this.request("scene.patch", { patch: instead }),
    });
    if (close) this.closeCrossings = close;
    else noticeError(title, error);
  }

  // A request that is lost with its connection needs no notice: the banner reports the loss.
  private request(method: string, params: Params = {}): void {
    this.connection.request(method, params).catch((error: Error) => {
      if (error instanceof RpcError) noticeError("The server refused this", error);
    });
  }
}
