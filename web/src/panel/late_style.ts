// Style sheets of what is loaded when it is used.
const known = new Map<string, Promise<void>>();

/// Resolves when the sheet applies; it is asked for once.
export function lateStyle(name: string): Promise<void> {
  const started = known.get(name);
  if (started) return started;
  const link = document.createElement("link");
  link.rel = "stylesheet";
  link.href = name;
  const styled = new Promise<void>((resolve, reject) => {
    link.onload = () => resolve();
    link.onerror = () => {
      known.delete(name);
      link.remove();
      reject(new Error(`${name} did not come`));
    };
  });
  known.set(name, styled);
  document.head.append(link);
  return styled;
}
