// What the page keeps in this browser, for the tab or for good. In a frame of another site, such as a notebook's cell,
// a browser may refuse both: then it is kept until the page is closed.
class Kept {
  private readonly here = new Map<string, string>();

  constructor(private readonly store: () => Storage) {}

  get(key: string): string | null {
    try {
      return this.store().getItem(key);
    } catch {
      return this.here.get(key) ?? null;
    }
  }

  set(key: string, value: string): void {
    try {
      this.store().setItem(key, value);
    } catch {
      this.here.set(key, value);
    }
  }

  remove(key: string): void {
    try {
      this.store().removeItem(key);
    } catch {
      this.here.delete(key);
    }
  }
}

export const inTab = new Kept(() => sessionStorage);
export const inBrowser = new Kept(() => localStorage);
