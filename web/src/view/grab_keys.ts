// The hand of somebody who does not point: G grabs the vertex in the middle of the view, arrows pull it.
import { takes } from "../panel/keys";
import type { Grab } from "./grab";

const stride = 16; // [CSS pixels] a press of an arrow; with Shift a quarter
const deeper = 0.04; // share of the distance

export function bindGrabKeys(grab: Grab): void {
  const whileHeldByKeys: Record<string, (fine: number) => void> = {
    ArrowLeft: (fine) => grab.nudge(-stride * fine, 0),
    ArrowRight: (fine) => grab.nudge(stride * fine, 0),
    ArrowUp: (fine) => grab.nudge(0, -stride * fine),
    ArrowDown: (fine) => grab.nudge(0, stride * fine),
    PageUp: (fine) => grab.deepen(deeper * fine),
    PageDown: (fine) => grab.deepen(-deeper * fine),
    Enter: () => grab.drop(),
    g: () => grab.drop(),
  };
  const whileHeld: Record<string, () => void> = { p: () => grab.pin(), Escape: () => grab.drop() };
  const whileChosen: Record<string, () => void> = {
    p: () => grab.unpin(),
    Delete: () => grab.unpin(),
    Backspace: () => grab.unpin(),
    Escape: () => grab.choose(null),
  };
  const free: Record<string, () => void> = { g: () => grab.grabMiddle(), n: () => grab.chooseNext() };
  const commandFor = (key: string): ((fine: number) => void) | undefined => {
    if (grab.holding) return whileHeld[key] ?? (grab.holdsByKeys ? whileHeldByKeys[key] : undefined);
    return (grab.hasChosen ? whileChosen[key] : undefined) ?? free[key];
  };
  addEventListener(
    "keydown",
    (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (document.querySelector("dialog[open]") || takes(event.target, event.key)) return;
      const run = commandFor(event.key.length === 1 ? event.key.toLowerCase() : event.key);
      if (!run) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      run(event.shiftKey ? 0.25 : 1);
    },
    { capture: true },
  );
}
