// The theme of a page that is a single file: dark or light, as the system's.
const dark = matchMedia("(prefers-color-scheme: dark)");

/// Sets the theme now and whenever the system's changes; `changed` is called after each.
export function followSystemTheme(changed: () => void): void {
  const apply = (): void => {
    document.documentElement.dataset.theme = dark.matches ? "dark" : "light";
    changed();
  };
  dark.addEventListener("change", apply);
  apply();
}
