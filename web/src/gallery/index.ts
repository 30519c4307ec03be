// The presets with their pictures, which the server's build has drawn; without one a preset shows its name and
// sentence.
import { make, makeButton } from "../lab/dom";

export interface GalleryHost {
  presets: { name: string; about: string }[];
  current: string; ///< the scene's name
  mayEdit: boolean;
  load(name: string): void;
}

export function openGallery({ presets, current, mayEdit, load }: GalleryHost): void {
  const title = make("h2", "", "Presets");
  title.id = "gallery-title";
  const dialog = make("dialog", "gallery");
  dialog.setAttribute("aria-labelledby", title.id);
  const close = makeButton("×", "lab-close", () => dialog.close());
  close.setAttribute("aria-label", "Close the presets");
  const cards = presets.map(({ name, about }) => {
    const picture = make("img");
    picture.alt = ""; // the sentence says it
    picture.width = 320;
    picture.height = 200;
    picture.loading = "lazy";
    picture.onerror = () => picture.remove();
    picture.src = `presets/${encodeURIComponent(name)}.png`;
    const card = makeButton("", "gallery-card", () => {
      dialog.close();
      load(name);
    });
    card.append(picture, make("b", "", name), make("span", "", about));
    card.disabled = !mayEdit;
    if (name === current) card.setAttribute("aria-current", "true");
    return card;
  });
  const list = make("ul", "", ...cards.map((card) => make("li", "", card)));
  const note = mayEdit ? [] : [make("p", "", "You are a viewer of this session: an operator may load one.")];
  dialog.append(make("div", "gallery-head", title, close), ...note, list);
  dialog.addEventListener("close", () => dialog.remove());
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close(); // beside it
  });
  document.body.append(dialog);
  dialog.showModal();
  (cards.find((card) => card.hasAttribute("aria-current")) ?? close).focus();
}
