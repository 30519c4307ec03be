// The dialogue of links: to the session, which others then see live, and to a copy of its scene. Loaded with its first
// use.
import { make, makeButton } from "../lab/dom";
import type { SceneDocument } from "../link/scene_types";
import { fragmentOf } from "../text/share";

const live = "The same cloth, live: who opens this sees what you see, and may change it as you may.";
const copy = "The scene alone, as it is now: who opens this loads it in a session of their own, or here.";

function row(label: string, says: string, text: string): HTMLElement[] {
  const field = make("input");
  field.readOnly = true;
  field.value = text;
  field.setAttribute("aria-label", label);
  const button = makeButton("Copy", "", () => {
    field.select();
    // Only pages by HTTPS or from this machine may write to the clipboard.
    const written = navigator.clipboard?.writeText(text) ?? Promise.reject(new Error("no clipboard"));
    written.then(
      () => (button.textContent = "Copied"),
      () => (button.textContent = "Ctrl+C"),
    );
  });
  button.setAttribute("aria-label", `Copy: ${label}`);
  return [make("p", "", says), make("div", "share-row", field, button)];
}

export async function openShare(scene: SceneDocument): Promise<void> {
  const title = make("h2", "", "Share");
  title.id = "share-title";
  const dialog = make("dialog");
  dialog.setAttribute("aria-labelledby", title.id);
  const here = location.href.replace(/#.*/, "");
  const close = makeButton("Close", "plain", () => dialog.close());
  const rows = row("Link to this session", live, here);
  const link = await fragmentOf(scene).then(
    (fragment) => row("Link to this scene", copy, here + fragment),
    (error: Error) => [make("p", "", error.message)],
  );
  dialog.append(title, ...rows, ...link, make("p", "", close));
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}
