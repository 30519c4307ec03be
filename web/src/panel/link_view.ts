// Shows the state of the connection: the dot beside the name, the banner with its countdown, the waiting screen, and
// the dialog that asks for the token.
import type { Connection, LinkState } from "../link/connection";
import { button, element } from "./dom";

export class LinkView {
  private everDrawn = false;
  private countdown = 0;
  private readonly banner = element("banner", HTMLElement);
  private readonly text = element("banner-text", HTMLElement);
  private readonly dot = element("link", HTMLElement);

  constructor(private readonly connection: Connection) {
    button("banner-retry").onclick = () => this.connection.connect();
    element("auth-form", HTMLFormElement).addEventListener("submit", () => {
      this.connection.authenticate(element("auth-token", HTMLInputElement).value);
    });
    element("auth-dialog", HTMLDialogElement).addEventListener("cancel", (event) => event.preventDefault());
  }

  show(state: LinkState, retryIn: number, why: string): void {
    clearInterval(this.countdown);
    this.dot.dataset.state = state;
    this.dot.title = {
      open: "connected",
      connecting: "connecting",
      waiting: "not connected",
      unauthorised: "token needed",
    }[state];
    if (state === "open") this.banner.hidden = true;
    if (state === "connecting" && !this.banner.hidden) this.text.textContent = "Connecting again…";
    if (state === "waiting") this.wait(retryIn, why);
    if (state === "unauthorised") this.ask(why);
  }

  /// The page's address cannot be connected: says why, with a way to the session that everybody starts with.
  refuse(why: string): void {
    const way = document.createElement("a");
    way.href = location.pathname;
    way.textContent = "Open the session that everybody starts with";
    element("waiting-text", HTMLElement).replaceChildren(why, " ", way, ".");
    this.dot.dataset.state = "waiting";
    this.dot.title = "not connected";
  }

  /// Called when a frame is on screen.
  drawing(): void {
    if (this.everDrawn) return;
    this.everDrawn = true;
    document.body.classList.add("drawing");
  }

  private wait(retryIn: number, why: string): void {
    const until = performance.now() + retryIn * 1000;
    const say = (): void => {
      const left = Math.max(0, Math.ceil((until - performance.now()) / 1000));
      const soon = left > 0 ? `trying again in ${left} s` : "trying again";
      const what = this.everDrawn ? "Connection lost" : why ? "Not connected" : "No server answers";
      this.text.textContent = `${what}${why ? ` (${why})` : ""}: ${soon}.`;
    };
    say();
    this.banner.hidden = false;
    this.countdown = window.setInterval(say, 250);
  }

  private ask(why: string): void {
    this.banner.hidden = true;
    element("auth-why", HTMLElement).textContent = why;
    const dialog = element("auth-dialog", HTMLDialogElement);
    if (!dialog.open) dialog.showModal();
    element("auth-token", HTMLInputElement).value = "";
  }
}
