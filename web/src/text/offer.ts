// A link with a scene was opened: says what it carries, and asks where to load it. Nothing is loaded unasked.
import type { TextHost } from "./host";
import { load } from "./load";
import { besideScene, sceneIn } from "./share";
import { make, makeButton } from "../lab/dom";
import { notice, noticeError } from "../panel/notices";
import type { SceneDocument } from "../link/scene_types";

const counted = (count: number, one: string, many: string): string => `${count} ${count === 1 ? one : many}`;

/// The name of the file that a mesh is.
const namedIn = (mesh: object): string[] =>
  "file" in mesh ? [String(mesh.file)] : "obj" in mesh ? [String(mesh.obj)] : [];

function described({ cloths, colliders = [], name }: SceneDocument): string {
  const meshes = [...cloths.map(({ mesh }) => mesh), ...colliders.map((each) => ("mesh" in each ? each.mesh : {}))];
  const files = meshes.flatMap((mesh) => namedIn(mesh ?? {}));
  const parts = [counted(cloths.length, "cloth", "cloths"), counted(colliders.length, "body", "bodies")];
  const needs = files.length > 0 ? ` It names ${files.join(", ")}, which this server must have.` : "";
  return `“${name ?? "scene"}”: ${parts.join(" and ")}.${needs}`;
}

const isKept = (state: unknown): state is { scene: SceneDocument } =>
  typeof state === "object" && state !== null && "scene" in state;

const forget = (rest = ""): void => history.replaceState(null, "", location.pathname + location.search + rest);

/// Loads the scene that this page itself has put by for a session of its own; true if there was one.
export async function loadKept(host: TextHost): Promise<boolean> {
  const state: unknown = history.state; // a link from elsewhere cannot set it
  if (!isKept(state)) return false;
  forget(location.hash);
  await load(state.scene, host).catch((error: Error) => noticeError("The scene of the link was refused", error));
  return true;
}

/// Asks what to do with the scene in the page's address.
export async function offer(host: TextHost): Promise<void> {
  let scene: SceneDocument;
  try {
    scene = await sceneIn(location.hash, host.mostBytes());
  } catch (error) {
    forget();
    notice("error", { title: "No scene in this link", lines: [(error as Error).message], stays: true });
    return;
  }
  const dialog = make("dialog");
  const title = make("h2", "", "A scene by link");
  title.id = "offer-title";
  dialog.setAttribute("aria-labelledby", title.id);
  const rest = besideScene(location.hash);
  let loaded = false;
  const close = (): void => dialog.close();
  const here = (): void => {
    loaded = true;
    close();
    void load(scene, host).catch((error: Error) => noticeError("The scene of the link was refused", error));
  };
  const apart = (): void => {
    const name = `scene-${crypto.getRandomValues(new Uint32Array(1))[0]?.toString(36)}`;
    history.replaceState({ scene }, "", `${location.pathname}?session=${name}${rest}`);
    location.reload();
  };
  const own = makeButton("Open it in a session of its own", "", apart);
  const choices = make("div", "offer-choices", own);
  if (host.mayEdit()) choices.append(makeButton(`Load it in “${host.session}”, for everybody there`, "plain", here));
  choices.append(makeButton("Do not load it", "plain", close));
  dialog.append(title, make("p", "", described(scene)), choices);
  dialog.addEventListener("close", () => {
    dialog.remove();
    if (!isKept(history.state)) forget(loaded ? rest : "");
  });
  document.body.append(dialog);
  dialog.showModal();
  own.focus();
}
