// Shows the first steps to a browser that has not seen them, or when the help's button asks for them.
import { button, element } from "./dom";
import { inBrowser } from "../link/kept";
import type { FirstStepsHost } from "./first_steps";

const key = "clothlab-first-steps";

/// True if nobody has seen them here. A browser that keeps nothing shows them each time.
const isNewcomer = (): boolean => inBrowser.get(key) === null;

export function remember(): void {
  inBrowser.set(key, "seen");
}

/// Returns what shows them to a newcomer, to be called once the server has told this page's role.
export function bindFirstSteps(host: FirstStepsHost): () => void {
  const show = async (): Promise<void> => (await import("./first_steps")).showFirstSteps(host);
  button("first-steps-again").onclick = () => {
    element("help-dialog", HTMLDialogElement).close();
    void show();
  };
  let due = isNewcomer();
  return () => {
    if (due) void show();
    due = false;
  };
}
