// The hand of somebody who does not point: G grabs the vertex in the middle of the view, arrows pull it; B chooses a
// body, arrows move it.
import { takes } from "../panel/keys";
import type { Grab } from "./grab";
import type { HandlesDoor } from "./handles_door";

const stride = 16; // [CSS pixels] a press of an arrow; with Shift a quarter
const deeper = 0.04; // share of the distance

/// True for a control that has a use for arrows, Enter or Delete of its own.
const ownsKeys = (target: EventTarget | null): boolean =>
  target instanceof HTMLElement &&
  target.id !== "view" &&
  target.closest("input, select, button, summary, [tabindex]") !== null;

export function bindGrabKeys(grab: Grab, handles: HandlesDoor): void {
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
  const whileBodyChosen: Record<string, (fine: number) => void> = {
    ArrowLeft: (fine) => handles.nudge(-fine, 0, 0),
    ArrowRight: (fine) => handles.nudge(fine, 0, 0),
    ArrowUp: (fine) => handles.nudge(0, fine, 0),
    ArrowDown: (fine) => handles.nudge(0, -fine, 0),
    PageUp: (fine) => handles.nudge(0, 0, fine),
    PageDown: (fine) => handles.nudge(0, 0, -fine),
    t: () => handles.toggleMode(),
    Escape: () => handles.leave(),
  };
  const free: Record<string, () => void> = {
    g: () => grab.grabMiddle(),
    n: () => grab.chooseNext(),
    b: () => handles.chooseNext(),
  };
  const commandFor = (key: string): ((fine: number) => void) | undefined => {
    if (grab.holding) return whileHeld[key] ?? (grab.holdsByKeys ? whileHeldByKeys[key] : undefined);
    const chosen = grab.hasChosen ? whileChosen[key] : handles.hasChosen ? whileBodyChosen[key] : undefined;
    return chosen ?? free[key];
  };
  addEventListener(
    "keydown",
    (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (document.querySelector("dialog[open]") || takes(event.target, event.key)) return;
      if (event.key.length > 1 && ownsKeys(event.target)) return;
      const run = commandFor(event.key.length === 1 ? event.key.toLowerCase() : event.key);
      if (!run) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      run(event.shiftKey ? 0.25 : 1);
    },
    { capture: true },
  );
}
