// The scene as text: a drawer to edit it in, to save and share it, and to copy it as something to run.
import { commandLine, fileName, javaScript, python } from "./code";
import { difference } from "./difference";
import { Editor } from "./editor";
import { type Applied, type TextHost, tooLarge } from "./host";
import { isFault, readJson } from "./json_text";
import { ordered } from "./order";
import { print } from "./print";
import { fragmentOf } from "./share";
import { make, makeButton, say } from "../lab/dom";
import { RpcError } from "../link/rpc";
import type { SceneDocument } from "../link/scene_types";

const conflict = -32003;
const longLink = 8000; // characters: mail and chat programs cut longer ones, or worse

const textOf = (scene: SceneDocument): string => print(ordered(scene));

export class TextDrawer {
  private readonly drawer = make("aside", "card lab text");
  private readonly editor = new Editor(() => this.touched());
  private readonly wrong = make("p", "text-wrong");
  private readonly done = make("p", "lab-fine");
  private readonly apply = makeButton("Apply", "lab-primary", () => void this.applied(true));
  private readonly onTop = makeButton("Apply mine on top", "lab-small", () => void this.applied(false));
  private readonly revert = makeButton("Take the scene's", "lab-small", () => this.follow());
  private readonly output = make("textarea", "text-output");
  private base: { document: SceneDocument; revision: number } | null = null; // that the text was made from
  private dirty = false;
  private opener: HTMLElement | null = null;

  constructor(private readonly host: TextHost) {
    const title = make("h2", "", "Scene as text");
    title.id = "text-title";
    this.drawer.id = "text";
    this.drawer.hidden = true;
    this.drawer.setAttribute("aria-labelledby", title.id);
    this.wrong.setAttribute("role", "alert");
    this.wrong.id = "text-wrong";
    this.editor.area.setAttribute("aria-describedby", this.wrong.id);
    this.done.setAttribute("role", "status");
    this.output.readOnly = true;
    this.output.setAttribute("aria-label", "Copied text");
    const close = makeButton("×", "lab-close", () => this.toggle());
    close.setAttribute("aria-label", "Close the text");
    close.title = "Close (J)";
    const head = make("div", "lab-head", title, make("span", "text-space"), close);
    this.drawer.append(head, make("div", "text-body", ...this.body()));
    this.drawer.addEventListener("keydown", (event) => this.key(event));
    (document.getElementById("lab") as HTMLElement).after(this.drawer);
    this.say("");
    say(this.done, "");
    this.output.hidden = true;
  }

  private body(): HTMLElement[] {
    const small = (text: string, run: () => void): HTMLButtonElement => makeButton(text, "lab-small", run);
    const copies = make("div", "text-row");
    copies.setAttribute("role", "group");
    copies.setAttribute("aria-label", "Copy");
    copies.append(
      make("span", "", "Copy as"),
      small("link", () => void this.copyLink()),
      small("command line", () => this.copyCode(commandLine)),
      small("Python", () => this.copyCode(python)),
      small("JavaScript", () => this.copyCode(javaScript)),
    );
    return [
      this.editor.element,
      this.wrong,
      make(
        "div",
        "text-row",
        this.apply,
        this.revert,
        this.onTop,
        small("Save as file", () => this.save()),
      ),
      copies,
      this.done,
      this.output,
    ];
  }

  get open(): boolean {
    return !this.drawer.hidden;
  }

  toggle(): void {
    if (!this.open) {
      this.reveal();
      return;
    }
    this.drawer.hidden = true;
    document.body.classList.remove("lab-open");
    this.host.toggled(false);
    const back = this.opener?.isConnected && this.opener !== document.body ? this.opener : null;
    (back ?? document.getElementById("view"))?.focus({ preventScroll: true });
  }

  /// Opens with a text that is not the scene's, what is wrong with it, and its line (0: none). A text that the user is
  /// editing stays.
  show(text: string, wrong: string, line: number): void {
    const editing = this.dirty;
    this.reveal();
    if (editing) return;
    this.editor.text = text;
    this.touched();
    this.say(wrong, line);
    if (line > 0) this.editor.go(line);
  }

  /// The scene has changed: a text that nobody has touched changes with it.
  sceneChanged(): void {
    if (this.open && !this.dirty) this.follow();
  }

  private reveal(): void {
    if (this.open) return;
    this.opener = document.activeElement as HTMLElement | null;
    this.drawer.hidden = false;
    document.body.classList.add("lab-open"); // what makes room for the lab makes room for this
    if (!this.dirty) this.follow();
    this.touched();
    this.host.toggled(true);
    this.editor.area.focus({ preventScroll: true });
    if (!this.dirty) this.editor.area.setSelectionRange(0, 0);
  }

  private key(event: KeyboardEvent): void {
    if (event.key === "Escape") this.toggle();
    else if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) void this.applied(true);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /// The text becomes the scene's.
  private follow(): void {
    this.base = this.host.stored();
    this.dirty = false;
    // the buttons go, and would take the focus with them
    if ([this.apply, this.revert, this.onTop].some((each) => each === document.activeElement))
      this.editor.area.focus({ preventScroll: true });
    if (this.base) this.editor.text = textOf(this.base.document);
    this.say("");
    this.touched();
  }

  private touched(): void {
    this.dirty = this.base === null || this.editor.text !== textOf(this.base.document);
    this.apply.disabled = !this.dirty || !this.host.mayEdit();
    this.apply.title = this.host.mayEdit() ? "Ctrl+Enter" : "You are a viewer of this session";
    this.revert.hidden = !this.dirty;
    this.onTop.hidden = true;
    if (this.dirty && this.editor.area.getAttribute("aria-invalid") !== "true") this.say("");
  }

  private say(text: string, line = 0): void {
    say(this.wrong, text);
    this.editor.mark(line);
    if (line > 0)
      this.wrong.append(
        " ",
        makeButton("Go to it", "lab-small", () => this.editor.go(line)),
      );
  }

  private async applied(checkRevision: boolean): Promise<void> {
    if (!this.base || !this.host.mayEdit()) return;
    const { text } = this.editor;
    const read = readJson(text);
    if (isFault(read)) {
      this.say(`Line ${read.line}, column ${read.column}: ${read.says}.`, read.line);
      this.editor.go(read.line);
      return;
    }
    const patch = difference(this.base.document, read.value);
    const large = tooLarge(patch, this.host);
    if (large) {
      this.say(large);
      return;
    }
    try {
      const answer = await this.host.request<Applied>("scene.patch", {
        patch,
        ...(checkRevision ? { revision: this.base.revision } : {}),
      });
      this.host.applied(answer.applies);
      if (this.editor.text !== text) return; // typed meanwhile: that stays
      this.dirty = false;
      this.follow();
      say(this.done, patch.length === 0 ? "Nothing differs." : "Applied.");
    } catch (error) {
      this.refused(error as Error, read.lineOf);
    }
  }

  private refused(error: Error, lineOf: (pointer: string) => number): void {
    if (error instanceof RpcError && error.code === conflict) {
      this.say("Somebody has changed the scene since this text was taken. What you changed is still here.");
      this.onTop.hidden = false;
      return;
    }
    const { path, found, allowed } = error instanceof RpcError ? error.data : {};
    if (path === undefined || path.startsWith("/patch")) {
      this.say(error.message);
      return;
    }
    const line = lineOf(path);
    this.say(`Line ${line}: ${path} is ${found}; allowed: ${allowed}.`, line);
    this.editor.go(line);
  }

  // What is saved, shared and copied is the text as it stands, if it is JSON; else what is wrong with it is said.
  private current(): SceneDocument | null {
    const read = readJson(this.editor.text);
    if (!isFault(read)) return read.value as SceneDocument;
    this.say(`Line ${read.line}, column ${read.column}: ${read.says}.`, read.line);
    return null;
  }

  private save(): void {
    const scene = this.current();
    if (!scene) return;
    const link = make("a");
    link.href = URL.createObjectURL(new Blob([`${this.editor.text}\n`], { type: "application/json" }));
    link.download = fileName(scene);
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    say(this.done, `Saved as ${link.download}.`);
  }

  private async copyLink(): Promise<void> {
    const scene = this.current();
    if (!scene) return;
    const large = tooLarge(scene, this.host);
    if (large) {
      this.say(large);
      return;
    }
    try {
      const link = location.origin + location.pathname + (await fragmentOf(scene));
      const long = link.length > longLink ? ` It has ${link.length} characters, which some programs cut off.` : "";
      await this.copy(link, `Copied: whoever opens it is asked where to load the scene.${long}`);
    } catch (error) {
      this.say((error as Error).message);
    }
  }

  private copyCode(code: typeof python): void {
    const scene = this.current();
    if (!scene) return;
    const place = { address: location.origin, session: this.host.session };
    void this.copy(code(scene, this.host.preset(scene.name), place), "Copied:");
  }

  private async copy(text: string, says: string): Promise<void> {
    this.output.hidden = false;
    this.output.value = text;
    this.output.rows = Math.min(8, text.split("\n").length);
    try {
      await navigator.clipboard.writeText(text);
      say(this.done, says);
    } catch {
      // Only pages by HTTPS or from this machine may write to the clipboard.
      this.output.select();
      say(this.done, "Press Ctrl+C to copy this:");
    }
  }
}
