// The camera by keyboard, once the picture has the focus, and its swing, which the system's wish for less motion ends.
// Mouse and touch are three.js's own: one finger orbits, two pinch and move.
import type { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const turn = Math.PI / 36; // a key press [radians]
const shift = 30; // a key press [CSS pixels]
const nearer = 0.9; // share of the distance that a key press leaves

const turns: Record<string, [right: number, up: number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/// `busy`: the keys are a hand's at present.
export function bindCameraInput(controls: OrbitControls, busy: () => boolean): void {
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const follow = (): void => {
    controls.enableDamping = !calm.matches;
  };
  calm.addEventListener("change", follow);
  follow();
  (controls.domElement as HTMLElement).addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || busy()) return;
    const way = turns[event.key];
    const zoom = "+=".includes(event.key) ? nearer : "-_".includes(event.key) ? 1 / nearer : 1;
    if (!way && zoom === 1) return;
    event.preventDefault();
    controls.dispatchEvent({ type: "start" });
    if (way && event.shiftKey) controls.pan(-shift * way[0], shift * way[1]);
    else if (way) {
      controls.rotateLeft(-turn * way[0]);
      controls.rotateUp(turn * way[1]);
    } else if (zoom < 1) controls.dollyIn(nearer);
    else controls.dollyOut(nearer);
    controls.dispatchEvent({ type: "end" });
  });
}
