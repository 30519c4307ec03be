// Remembers whether this browser has seen the first steps.

const key = "clothlab-first-steps";

/// True if nobody has seen them here. A browser that keeps nothing shows them each time.
export const isNewcomer = (): boolean => {
  try {
    return localStorage.getItem(key) === null;
  } catch {
    return true;
  }
};

export function remember(): void {
  try {
    localStorage.setItem(key, "seen");
  } catch {
    // it keeps nothing: they come again
  }
}
