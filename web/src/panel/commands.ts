// What the keys and buttons beside the panel do, but for the hand's and the camera's keys.
import { button, element } from "./dom";
import { bindKeys } from "./keys";
import type { Layout } from "./layout";
import type { ThemeSwitch } from "../view/theme";
import type { Transport } from "./transport";

interface Commanded {
  transport: Transport;
  layout: Layout;
  theme: ThemeSwitch;
  fit(): void;
  lab(): void;
  text(): void;
  compare(): void;
  inside(): void;
  mesh(): void;
}

export function bindCommands({ transport, layout, theme, fit, lab, text, compare, inside, mesh }: Commanded): void {
  const dialog = element("help-dialog", HTMLDialogElement);
  const help = (): void => {
    dialog.showModal();
    dialog.scrollTop = 0;
  };
  bindKeys({
    toggle: () => transport.toggle(),
    step: () => transport.step(),
    reset: () => transport.reset(),
    fit,
    hide: () => layout.toggleInterface(),
    help,
    lab,
    text,
    compare,
    inside,
    mesh,
  });
  button("fit").onclick = fit;
  button("help").onclick = help;
  button("theme").onclick = () => theme.toggle();
}
