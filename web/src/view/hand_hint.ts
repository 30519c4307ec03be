// A line of words for whoever holds the cloth or has chosen a pin: what the hand can do now. Screen readers hear it.

export class HandHint {
  private readonly box = document.createElement("div");
  private readonly words = document.createElement("span");
  private readonly button = document.createElement("button");

  constructor(of: "hand" | "body") {
    this.box.className = "card hand-hint";
    this.box.dataset.of = of;
    this.box.hidden = true;
    this.words.setAttribute("role", "status");
    this.button.type = "button";
    this.box.append(this.words, this.button);
    document.querySelector("main")?.append(this.box);
  }

  /// Shows these words, with a button beside them if there is an action; null: nothing.
  say(words: string | null, action?: { label: string; run: () => void }): void {
    this.box.hidden = words === null;
    if (this.words.textContent !== (words ?? "")) this.words.textContent = words ?? "";
    this.button.hidden = !action;
    this.button.textContent = action?.label ?? "";
    this.button.onclick = action?.run ?? null;
  }
}
