// What the page shows while files hang over it: a shirt that comes onto a figure.
import { make } from "../lab/dom";

const drawing = `<svg viewBox="0 0 160 120" aria-hidden="true">
  <g class="figure"><circle cx="104" cy="26" r="12"/>
    <path d="M88 46h32q8 0 9 8l4 34h-10l-4-24v50h-30v-50l-4 24h-10l4-34q1-8 9-8z"/></g>
  <path class="shirt" d="M22 40l14-6q8 8 16 0l14 6 8 18-10 5-4-8v34h-32v-34l-4 8-10-5z"/>
  <path class="way" d="M66 24q8-12 22-10M83 8l6 6-8 5"/></svg>`;
let shown: HTMLElement | null = null;

export function showDropPicture(show: boolean, mayEdit: boolean): void {
  shown?.remove();
  shown = null;
  if (!show) return;
  const says = mayEdit
    ? "Drop it here: a garment, a body, or both"
    : "You are a viewer here: an operator may open files";
  const card = make("div", "card drop-card");
  card.innerHTML = drawing;
  card.append(make("b", "", says), make("span", "", ".obj, .ply, .glb, .gltf, or a scene as .json"));
  shown = make("div", "drop-picture", card);
  document.body.append(shown);
}
