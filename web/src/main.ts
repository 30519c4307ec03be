// The page: wires the connection, the scene's document, the stage and the controls to each other.
import { Connection } from "./connection";
import { button, element } from "./dom";
import { Hud, type Status } from "./hud";
import { bindKeys } from "./keys";
import { Layout } from "./layout";
import { LinkView } from "./link_view";
import { notice, noticeError, type Level } from "./notices";
import { Panel } from "./panel";
import type { Frame } from "./protocol";
import { RpcError } from "./rpc";
import { SceneStore } from "./scene_store";
import type { Patch, SceneDocument } from "./scene_types";
import { probeWebGl, Stage } from "./stage";
import { ThemeSwitch } from "./theme";
import { Transport } from "./transport";

/// What browser tests read; nothing in the page depends on it.
interface TestHook {
  framesReceived: number;
  framesDrawn: number;
  simTime: number;
  step: number;
  lastFrame: Frame | null;
  firstFrameAt: number;  ///< [ms] since navigation, 0 before
  document: SceneDocument | null;
  revision: number;
  stage: Stage | null;
}
declare global { interface Window { clothlab: TestHook } }

const hook: TestHook = window.clothlab = {
  framesReceived: 0, framesDrawn: 0, simTime: 0, step: 0, lastFrame: null, firstFrameAt: 0, document: null, revision: 0, stage: null,
};

const softwareRenderers = /swiftshader|llvmpipe|softpipe|software|basic render/i;

function start(stage: Stage): void {
  const session = new URLSearchParams(location.search).get("session") ?? "main";
  const hud = new Hud();
  let latest: Frame | null = null;
  let sceneName = "";
  let mayEdit = true;  // a viewer's role may only watch

  const connection = new Connection(session, {
    state: (state, retryIn, why) => {
      link.show(state, retryIn, why);
      transport.enable(state === "open" && mayEdit);
      if (state === "open" && !store.document) void fetchScene();
      if (state !== "open") store.forget();
    },
    notification: (method, params) => notifications[method]?.(params),
    topology: (topology) => stage.setTopology(topology),
    frame: (frame) => {
      hook.framesReceived++;
      hud.countReceived();
      if (latest && !document.hidden) connection.acknowledge(latest.header.sequence);  // replaced before it was drawn
      latest = frame;
    },
    latency: (milliseconds) => hud.set("latency", `${milliseconds.toFixed(milliseconds < 10 ? 1 : 0)} ms`),
    problem: (error) => noticeError("The server sent something unexpected", error),
  });

  const link = new LinkView(connection);
  const request = (method: string, params: Record<string, unknown> = {}): void => {
    connection.request(method, params).catch((error: Error) => {
      if (error instanceof RpcError) noticeError("The server refused this", error);
    });
  };
  const transport = new Transport({ request });

  const fetchScene = async (): Promise<void> => {
    const answer = await connection.request<{ document: SceneDocument; revision: number }>("scene.get").catch(() => null);
    if (answer) store.replace(answer.document, answer.revision);
  };

  const store = new SceneStore({
    send: (patch: Patch) => connection.request("scene.patch", { patch }),
    fetch: fetchScene,
    changed: (document, whole) => {
      hook.document = document;
      hook.revision = store.revision;
      const newScene = whole && document.name !== sceneName;
      sceneName = document.name;
      element("scene-name", HTMLElement).textContent = document.name;
      stage.setDocument(document, newScene);
      panel.show(document);
    },
    applied: (depth) => showApplied(depth),
    rejected: (error) => {
      if (error instanceof RpcError) noticeError("Not applied", error);
      panel.snapBack();
    },
  });

  const panel = new Panel(element("panel-body", HTMLElement), {
    edit: (operations) => store.edit(operations),
    busy: (path) => store.busy(path),
    loadPreset: (name) => {
      sceneName = "";
      request("scene.load", { preset: name });
    },
  });

  const notifications: Record<string, (params: Record<string, unknown>) => void> = {
    hello: (params) => {
      hud.setRenderer(String(params.renderer ?? "unknown"));
      mayEdit = params.role !== "viewer";
      document.body.classList.toggle("viewer", !mayEdit);
      transport.enable(connection.open && mayEdit);
      connection.request<{ presets: string[] }>("scene.presets").then(({ presets }) => panel.setPresets(presets), () => undefined);
    },
    scene: (params) => store.replace(params.document as SceneDocument, Number(params.revision)),
    "scene.changed": (params) => store.patched(Number(params.revision), params.patch as Patch),
    "sim.status": (params) => {
      hud.showStatus(params as Status);
      transport.status(params as Status);
    },
    "sim.diverged": (params) => showDiverged(params as unknown as Diverged, async (patch) => {
      await connection.request("scene.patch", { patch });
      await connection.request("sim.reset");
      await connection.request("sim.play");
    }),
    viewers: (params) => hud.set("viewers", String(params.count)),
    notice: (params) => notice((params.level as Level) ?? "info", { title: String(params.text) }),
  };

  const layout = new Layout(() => stage.resize(layout.freeArea()));
  const theme = new ThemeSwitch(() => stage.setTheme());
  const fit = (): void => { if (store.document) stage.fit(store.document); };
  const help = element("help-dialog", HTMLDialogElement);
  bindKeys({
    toggle: () => transport.toggle(), step: () => transport.step(), reset: () => transport.reset(),
    fit, hide: () => layout.toggleInterface(), help: () => help.showModal(),
  });
  button("fit").onclick = fit;
  button("help").onclick = () => help.showModal();
  button("theme").onclick = () => theme.toggle();
  setInterval(() => hud.tick(connection.bytesReceived), 1000);

  const animate = (): void => {
    requestAnimationFrame(animate);
    const frame = latest;
    latest = null;
    const shown = frame !== null && stage.show(frame);
    stage.draw();
    if (!frame) return;
    connection.acknowledge(frame.header.sequence);
    if (shown) drawn(frame);
  };
  const drawn = (frame: Frame): void => {
    const { header } = frame;
    hud.countDrawn();
    hud.setTime(header.time);
    hud.set("vertices", String(header.vertexCount));
    link.drawing();
    hook.framesDrawn++;
    hook.lastFrame = frame;
    hook.simTime = header.time;
    hook.step = header.step;
    hook.firstFrameAt ||= performance.now();
  };

  stage.resize(layout.freeArea());
  hook.stage = stage;
  connection.connect();
  requestAnimationFrame(animate);
}

const depths: Record<string, string> = {
  none: "nothing to change", uniform: "applied live", kernel: "applied live, kernel rebuilt", cloth: "cloth rebuilt, time reset",
};
let appliedTimer = 0;
function showApplied(depth: string): void {
  const place = element("applied", HTMLElement);
  place.textContent = depths[depth] ?? `applied (${depth})`;
  place.classList.add("shown");
  clearTimeout(appliedTimer);
  appliedTimer = window.setTimeout(() => place.classList.remove("shown"), 1600);
}

interface Diverged { reason: string; remedy?: { text: string; patch?: Patch } }

function showDiverged({ reason, remedy }: Diverged, apply: (patch: Patch) => Promise<void>): void {
  const patch = remedy?.patch;
  const run = (fix: Patch): void => void apply(fix).catch((error: Error) => noticeError("The remedy was refused", error));
  notice("error", {
    title: "The simulation blew up", lines: [reason, ...(remedy ? [`Remedy: ${remedy.text}.`] : [])], stays: true,
    action: patch ? { label: "Apply the remedy", run: () => run(patch) } : undefined,
  });
}

const renderer = probeWebGl();
if (renderer) {
  const software = softwareRenderers.test(renderer);
  document.body.classList.toggle("software", software);
  start(new Stage(element("view", HTMLCanvasElement), software));
} else {
  element("waiting-text", HTMLElement).textContent =
    "This browser offers no WebGL 2, which the page draws with. Turn on hardware acceleration, or try a current Firefox, Chrome or Safari.";
  document.body.classList.add("bare");
}
