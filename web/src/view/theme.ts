// The theme, dark or light: the system's, until the user chooses one.
import { inBrowser } from "../link/kept";

type Theme = "dark" | "light";
const key = "clothlab-theme";
const systemDark = matchMedia("(prefers-color-scheme: dark)");

const chosen = (): Theme | null => {
  const stored = inBrowser.get(key);
  return stored === "dark" || stored === "light" ? stored : null;
};

export class ThemeSwitch {
  constructor(private readonly changed: () => void) {
    systemDark.addEventListener("change", () => this.apply());
    this.apply();
  }

  toggle(): void {
    const next: Theme = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    inBrowser.set(key, next);
    this.apply();
  }

  private apply(): void {
    document.documentElement.dataset.theme = chosen() ?? (systemDark.matches ? "dark" : "light");
    this.changed();
  }
}
