// Connects the parts of the page: the link, the scene's document, the stage and the controls.
import { Drawers } from "./drawers";
import { Connection, type LinkEvents } from "./link/connection";
import { act } from "./panel/act";
import { ColourBy } from "./panel/colour_by";
import { bindCommands } from "./panel/commands";
import type { Convergence } from "./panel/convergence_gauge";
import { element } from "./panel/dom";
import type { SolverFacts } from "./panel/field";
import { Divergence } from "./panel/divergence";
import type { Stability } from "./panel/gauge";
import { Hud, keepsUp, type Status } from "./panel/hud";
import { Refusals } from "./panel/refusals";
import { Newcomer } from "./panel/newcomer";
import { InsideDoor } from "./inside/door";
import { editGrids } from "./panel/kept_mass";
import { tellKept } from "./panel/kept_stable";
import { StatusLog } from "./panel/status_log";
import { Layout } from "./panel/layout";
import { LinkView } from "./panel/link_view";
import { Guide } from "./explain/guide";
import { notice, noticeError, showApplied, type Diverged, type Level } from "./panel/notices";
import { OpenDoor } from "./open/door";
import { OwnCopy } from "./panel/own_copy";
import { Panel } from "./panel/panel";
import { Presets } from "./panel/presets";
import { RecordButton } from "./panel/record_button";
import { bindSaveButtons } from "./panel/save_buttons";
import { Bodies } from "./link/bodies";
import { NumbersSource, type Renumbered } from "./link/numbers_source";
import { LineWatch, type Second } from "./link/line_watch";
import { bindShare } from "./panel/share_button";
import { SlowWatch } from "./panel/slow_watch";
import { SceneStore } from "./link/scene_store";
import { coarser } from "./link/grid_places";
import { sessionFault } from "./link/session_name";
import { Picture } from "./picture";
import { ShowDoor } from "./show/door";
import { Provoked } from "./show/provoked";
import type { MovedCollider, Operation, Patch, SceneDocument } from "./link/scene_types";
import type { HandAt } from "./view/grab";
import { Hand } from "./view/hand";
import type { Stage } from "./view/stage";
import { StartState } from "./view/start_state";
import { hook } from "./test_hook";
import { bindCameraInput } from "./view/camera_input";
import { bindFocusFrame } from "./view/focus_frame";
import { bindTimeline } from "./panel/timeline_opener";
import { ThemeSwitch } from "./view/theme";
import { Transport } from "./panel/transport";
import { type History, Undo } from "./panel/undo";

type Params = Record<string, unknown>;

export class Page {
  private stage!: Stage; // set by show(), before the first event of the connection
  private readonly hud = new Hud();
  private readonly statusLog = new StatusLog();
  private inside: InsideDoor | null = null; // with the stage
  private readonly session = new URLSearchParams(location.search).get("session") ?? "main";
  private readonly connection = new Connection(this.session, this.linkEvents());
  private readonly link = new LinkView(this.connection);
  private readonly transport = new Transport({ request: (method, params) => this.answered(method, params) });
  private readonly ownCopy = new OwnCopy(this.session, {
    mayEdit: () => this.mayEdit,
    load: (scene) => this.connection.request("scene.load", { scene }),
    transport: this.transport,
  });
  private readonly undo: Undo = new Undo({
    request: (method, params) => this.connection.request(method, params),
    settled: (longest) => this.store.settled(longest),
    told: ({ undo }) => this.slow.changed(undo),
  });
  private readonly slow = new SlowWatch({
    mayEdit: () => this.mayEdit,
    undo: () => void this.undo.go("undo"),
    coarser: () => this.store.document && coarser(this.store.document),
    edit: (operations) => this.edit(operations, true),
    lab: () => this.drawers.toggle("lab"),
  });
  private readonly line = new LineWatch();
  private lastSecond: Second = { pictures: 0, frames: 0, latency: 0, steps: false };
  private readonly bodies = new Bodies(
    (name) => this.connection.get("/api/collider.ply", { name }),
    () => this.drawDocument(this.stage.fitted),
  );
  private readonly numbers = new NumbersSource({
    ask: (method, params) => this.connection.request(method, params),
    topology: () => this.stage.cloth.topology,
    arrived: () => this.stage.numbersArrived(),
  });
  private readonly store: SceneStore = this.makeStore();
  private readonly guide = new Guide();
  private readonly presets = new Presets({
    ask: () => this.connection.request("scene.presets"),
    arrived: (presets, fabrics) => {
      this.fabricNames = fabrics.map(({ name }) => name);
      this.presetNames = presets;
      this.panel.setOffers(presets, fabrics);
    },
    current: () => this.sceneName,
    mayEdit: () => this.mayEdit,
    load: (name) => this.loadPreset(name),
  });
  private readonly panel: Panel = this.makePanel();
  private readonly drawers = this.makeDrawers();
  private readonly files = this.makeOpenDoor();
  private readonly notifications = this.makeNotifications();
  private readonly colourBy = new ColourBy(
    (field) => {
      this.connection.setField(field);
      this.inside?.coloured();
    },
    () => this.layout?.cardToggled(),
  );
  private readonly picture = this.makePicture();
  private readonly recording = new RecordButton({
    request: (method, params) => this.connection.request(method, params),
    get: (path) => this.connection.get(path),
  });
  private readonly divergence = new Divergence({
    send: (patch) => this.connection.request("scene.patch", { patch, name: "Remedy" }),
    shown: () => this.blowUp.on,
    mayShow: () => this.mayEdit && this.connection.open,
    show: () => this.provoked.again(),
    mended: () => this.newcomer?.did("mend"),
  });
  private readonly blowUp = new ShowDoor({
    request: (method, params) => this.connection.request(method, params ?? {}),
    picture: this.picture,
    remedy: ({ remedy }) => this.connection.request("scene.patch", { patch: remedy?.patch ?? {}, name: "Remedy" }),
    play: () => {
      this.newcomer?.did("mend");
      this.transport.start();
    },
    opened: () => this.drawers.shut(),
    changed: () => this.layout?.cardToggled(),
    ended: (diverged) => {
      if (diverged) this.divergence.tell(diverged);
    },
  });
  private readonly provoked = new Provoked({
    begin: (cause) => this.blowUp.begin(cause),
    request: (method, params) => this.connection.request(method, params),
    stored: () => this.store.stored,
    limit: () => this.stability?.dt_limit,
  });
  private readonly refusals = new Refusals({
    show: (crossings) => this.stage.showCrossings(crossings),
    hide: () => this.stage.hideCrossings(),
    send: (instead) => this.request("scene.patch", { patch: instead }),
    stored: () => this.store.stored,
  });
  private hand: Hand | null = null; // with the stage, as the next
  private startState: StartState | null = null;
  private layout: Layout | null = null;
  private newcomer: Newcomer | null = null;
  private viewers = 1; // of the session
  private fabricNames: string[] = []; // that come with the server, as the next
  private presetNames: string[] = [];
  private sceneName = "";
  private shownTime = 0; // of the picture [s]
  private stability: Stability | null = null; // in the last status
  private mayEdit = true; // false for a viewer, who may only watch

  constructor() {
    const fault = sessionFault(this.session);
    if (fault) this.link.refuse(fault);
    else this.connection.connect();
  }

  /// Draws on this stage from now on.
  show(stage: Stage): void {
    this.stage = hook.stage = stage;
    const layout: Layout = (this.layout = new Layout(() => stage.resize(layout.freeArea())));
    this.hand = this.makeHand(stage);
    this.startState = new StartState(stage, {
      stop: () => this.transport.stop(),
      reset: () => this.transport.reset(),
      chooseCloth: (cloth) => this.hand?.chooseCloth(cloth),
    });
    this.inside = this.makeInside(stage);
    bindSaveButtons({ stage, sceneName: () => this.sceneName, get: (path) => this.connection.get(path) });
    this.bind(layout, new ThemeSwitch(() => stage.setTheme()));
    stage.onLost = () =>
      notice("warning", {
        title: "The browser took the graphics away",
        lines: ["It gives them back by itself; if not, reload the page."],
      });
    stage.resize(layout.freeArea());
    setInterval(() => this.second(), 1000);
    this.picture.start(stage);
  }

  close(): void {
    this.connection.close();
  }

  private second(): void {
    this.hud.tick(this.connection.bytesReceived);
    if (this.line.second(this.lastSecond) && this.connection.compress())
      this.hud.explain("rate", "everything received, a second; frames come compressed, as the line is slow");
    this.lastSecond = { ...this.lastSecond, pictures: 0, frames: 0 };
  }

  private bind(layout: Layout, theme: ThemeSwitch): void {
    const lab = (): void => {
      this.drawers.toggle("lab");
      this.newcomer?.did("lab");
    };
    bindCommands({
      transport: this.transport,
      layout,
      theme,
      fit: () => this.stage.fit(),
      lab,
      text: () => this.drawers.toggle("text"),
      compare: () => this.drawers.toggle("compare"),
      inside: () => this.inside?.toggle(),
      mesh: () => (this.stage.showsMesh = !this.stage.showsMesh),
    });
    bindFocusFrame(this.stage.canvas);
    bindCameraInput(this.stage.controls, () => this.hand?.holding === true);
    bindTimeline({
      picture: this.picture,
      mayEdit: () => this.mayEdit && this.connection.open,
      resume: (to) => this.connection.request("timeline.resume", to),
      offerUndo: (deed) => this.undo.offer(deed),
      transport: this.transport,
      keys: () => this.store.document?.keys ?? [],
      changed: () => layout.cardToggled(),
    });
    bindShare(() => this.store.stored);
    this.newcomer = new Newcomer(
      {
        mayEdit: () => this.mayEdit,
        blowUp: () => this.provoked.beyondLimit(),
        lab,
        load: (name) => this.loadPreset(name),
        gallery: () => this.presets.openGallery(),
        changed: () => layout.cardToggled(),
      },
      {
        alone: () => this.viewers === 1,
        patch: (patch, revision, name) => this.connection.request("scene.patch", { patch, revision, name }),
        hold: (held) => (this.picture.held = held),
      },
    );
  }

  private makePicture(): Picture {
    return new Picture({
      acknowledge: (sequence) => this.connection.acknowledge(sequence),
      ticked: () => {
        this.lastSecond.pictures++;
        this.hand?.tick();
      },
      drawn: ({ header, field }) => {
        this.hud.countDrawn();
        this.shownTime = header.time;
        this.hud.setTime(header.time);
        this.colourBy.show(field, header.range);
        this.hud.set("vertices", String(header.vertexCount));
        this.link.drawing();
        this.startState?.drawn(header.step);
      },
      first: () => void this.guide.load().then(() => this.panel.mark()),
    });
  }

  private linkEvents(): LinkEvents {
    return {
      state: (state, retryIn, why) => {
        this.link.show(state, retryIn, why);
        this.enableEdits();
        this.drawers.link(state === "open");
        this.slow.link(state === "open");
        if (state !== "open") {
          this.hand?.lost();
          this.ownCopy.lost();
          this.store.forget();
          this.blowUp.lost();
          this.guide.baseline.lost();
        }
        if (state === "open" && !this.store.document) void this.fetchScene();
      },
      notification: (method, params) => this.notifications[method]?.(params),
      topology: (topology) => {
        this.stage.setTopology(topology);
        this.hand?.lost();
      },
      frame: (frame, field) => {
        this.hud.countReceived();
        this.lastSecond.frames++;
        this.slow.picture();
        this.picture.take(frame, field);
        this.blowUp.frame(frame);
      },
      latency: (milliseconds) => {
        this.lastSecond.latency = milliseconds;
        this.hud.set("latency", `${milliseconds.toFixed(milliseconds < 10 ? 1 : 0)} ms`);
      },
      problem: (error) => noticeError("The server sent something unexpected", error),
    };
  }

  private makeStore(): SceneStore {
    return new SceneStore({
      send: (patch, keepStable) =>
        this.connection.request("scene.patch", { patch, ...(keepStable && { keep_stable: true }) }),
      kept: (solver, revision) => tellKept(solver, () => void this.undo.go("undo", revision)),
      fetch: () => this.fetchScene(),
      changed: (document, whole) => this.sceneChanged(document, whole),
      applied: showApplied,
      rejected: (error, operations) => {
        this.refusals.tell("Not applied", error, operations);
        this.panel.snapBack();
        this.hand?.sceneChanged();
      },
    });
  }

  private makePanel(): Panel {
    return new Panel(
      element("panel-body", HTMLElement),
      {
        edit: (operations, keepStable) => this.edit(operations, keepStable),
        busy: (path) => this.store.busy(path),
        time: () => this.shownTime,
        loadPreset: (name) => this.loadPreset(name),
        openText: () => this.drawers.toggle("text"),
        openCompare: () => this.drawers.toggle("compare"),
        openGallery: () => this.presets.openGallery(),
        openFiles: () => this.files.choose(),
        handles: (cloth) => this.startState?.giveHandles(cloth),
        act: (deed) =>
          act(deed, {
            room: () => this.startState,
            choose: (body) => this.hand?.chooseBody(body),
            stored: () => this.store.stored,
            request: (method, params) => this.connection.request(method, params),
            refused: (title, error, patch) => this.refusals.tell(title, error, patch),
          }),
      },
      this.guide,
    );
  }

  private edit(operations: Operation[], keepStable?: boolean): void {
    const now = this.store.expected;
    if (now) editGrids(this.store, now, this.guide.baseline.alignedTo(now), operations, keepStable);
  }

  private makeHand(stage: Stage): Hand {
    return new Hand(stage, {
      notify: (method, params) => {
        this.connection.notify(method, params);
        if (method === "grab.move") this.newcomer?.did("pull");
      },
      patch: (operations) =>
        this.connection.request("scene.patch", { patch: operations }).catch((error: Error) => {
          noticeError("Not pinned", error);
        }),
      edit: (operations, keepStable) => this.store.edit(operations, keepStable),
      document: () => this.store.expected, // keys come faster than answers
      mayEdit: () => this.mayEdit && !this.drawers.compared,
      mayGrab: () => this.mayEdit && this.connection.open && !this.divergence.now && !this.drawers.compared,
    });
  }

  private makeInside(stage: Stage): InsideDoor {
    return new InsideDoor({
      stage,
      log: this.statusLog,
      ask: (method, params) => this.connection.request(method, params),
      document: () => this.store.document,
      field: () => this.colourBy.chosen,
      live: () => this.picture.live,
      recolour: () => {
        const { frame } = stage;
        if (!frame) return;
        stage.show(frame);
        this.colourBy.show(frame.field, frame.header.range);
      },
      changed: () => this.layout?.cardToggled(),
    });
  }

  private makeDrawers(): Drawers {
    return new Drawers({
      session: this.session,
      store: this.store,
      request: (method, params) => this.connection.request(method, params),
      preset: (name) => this.guide.baseline.preset(name),
      stage: () => this.stage,
      mayEdit: () => this.mayEdit,
      undo: (revision) => void this.undo.go("undo", revision),
      fail: (patch, what) => this.provoked.setting(patch, what),
      toggled: (open) => this.layout?.labToggled(open),
      returned: () => this.picture.again(),
    });
  }

  private makeOpenDoor(): OpenDoor {
    return new OpenDoor({
      request: (method, params) => this.connection.request(method, params),
      mayEdit: () => this.mayEdit,
      stored: () => this.store.stored,
      fabrics: () => this.fabricNames,
      presets: () => this.presetNames,
      refused: (title, error, patch) => this.refusals.tell(title, error, patch),
      showCrossings: (crossings) => this.stage.showCrossings(crossings),
      hideCrossings: () => this.stage.hideCrossings(),
      pause: () => this.transport.stop(),
      play: () => this.transport.start(),
      fit: () => this.picture.fitAtNext(),
      scene: (files) => this.drawers.take(files),
    });
  }

  private makeNotifications(): Record<string, (params: Params) => void> {
    return {
      hello: (params) => this.greeted(params),
      scene: (params) => {
        this.guide.baseline.take(params.document as SceneDocument);
        this.ownCopy.arrived(params.document as SceneDocument, Number(params.revision));
        this.store.replace(params.document as SceneDocument, Number(params.revision));
        this.drawers.arrived();
        void this.newcomer?.arrived(Number(params.revision));
      },
      "scene.changed": (params) => this.store.patched(Number(params.revision), params.patch as Patch),
      "scene.history": (params) => this.undo.told(params as unknown as History),
      colliders: (params) => {
        this.picture.moved = params.moving as MovedCollider[];
      },
      "sim.status": (params) => {
        this.hud.showStatus(params as Status);
        this.lastSecond.steps = keepsUp(params as Status);
        this.statusLog.take(params as Status);
        this.transport.status(params as Status);
        this.slow.told(params as Status);
        this.stability = (params.stability as Stability | undefined) ?? this.stability;
        if (params.stability) this.panel.showStability(params.stability as Stability);
        this.panel.showConvergence((params.convergence as Convergence | null | undefined) ?? null);
        if (params.solver) this.store.fabricsGive((params.solver as SolverFacts).from_fabrics ?? []);
        if (params.solver) this.panel.showSolver(params.solver as SolverFacts);
        this.numbers.told(params.renumbered as Renumbered | undefined);
        this.hand?.told((params.hands as HandAt[] | undefined) ?? []);
        this.recording.told((params as Status).recording);
        this.blowUp.status(params as Status);
        this.divergence.follow(params as Status);
      },
      "sim.diverged": (params) => {
        if (this.blowUp.on) this.blowUp.diverged(params as unknown as Diverged);
        else this.divergence.tell(params as unknown as Diverged);
      },
      "lab.progress": (params) => this.drawers.told("progress", params),
      "lab.result": (params) => this.drawers.told("result", params),
      viewers: (params) => {
        this.viewers = Number(params.count);
        this.hud.set("viewers", String(params.count));
      },
      notice: (params) => {
        if (params.about !== "pace") notice(params.level as Level, { title: String(params.text) }); // that: SlowWatch
      },
    };
  }

  private greeted(params: Params): void {
    this.hud.setRenderer(String(params.renderer));
    this.hud.set("version", String(params.version));
    this.mayEdit = params.role !== "viewer";
    this.hand?.greeted(Number(params.client));
    this.undo.greeted(Number(params.client));
    this.newcomer?.welcome(params.untouched === true);
    this.numbers.mayAsk = (params.requests as string[] | undefined)?.includes("inspect.vertices") ?? false;
    const methods = (params.methods as string[] | undefined) ?? [];
    this.panel.setMethods(methods);
    this.drawers.greeted(methods, (params.limits as { message_bytes?: number } | undefined)?.message_bytes);
    document.body.classList.toggle("viewer", !this.mayEdit);
    document.body.classList.toggle("relayed", params.relay === true);
    this.enableEdits();
    this.presets.fetch();
  }

  private loadPreset(name: string): void {
    this.sceneName = "";
    if (name === Provoked.preset) {
      this.provoked.load();
      return;
    }
    const { asked } = this.transport;
    this.connection.request("scene.load", { preset: name }).then(
      () => asked === this.transport.asked && this.transport.start(), // who chooses a scene wants to see it move
      (error: Error) => this.refusals.tell("The server refused this", error),
    );
  }

  private enableEdits(): void {
    for (const each of [this.transport, this.undo]) each.enable(this.connection.open && this.mayEdit);
  }

  private sceneChanged(document: SceneDocument, whole: boolean): void {
    hook.document = document;
    this.slow.dt = this.hud.dt = document.solver.dt;
    this.picture.moved = [];
    this.refusals.sceneShown(this.store.revision, whole);
    if (this.store.stored) this.ownCopy.keep(this.store.stored, this.store.revision);
    const newScene = whole && document.name !== this.sceneName;
    if (newScene && this.store.stored) this.guide.baseline.take(this.store.stored); // by a patch, too
    this.sceneName = document.name;
    element("scene-name", HTMLElement).textContent = document.name;
    this.drawDocument(newScene, whole);
    this.hand?.sceneChanged();
    this.inside?.sceneChanged();
    this.panel.show(document, this.store.stored ?? document);
    this.drawers.sceneChanged();
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

  private request(method: string, params: Params = {}): void {
    void this.answered(method, params);
  }

  private answered(method: string, params: Params = {}): Promise<void> {
    return this.connection.request(method, params).then(
      () => undefined,
      (error: Error) => this.refusals.tell("The server refused this", error),
    );
  }
}
