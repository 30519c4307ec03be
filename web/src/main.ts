// Starts the page. The connection comes first: its handshake needs no processor while WebGL starts.
import { element } from "./panel/dom";
import { Page } from "./page";
import { Stage } from "./view/stage";
import { openWebGl } from "./view/webgl";

const page = new Page();
const graphics = openWebGl(element("view", HTMLCanvasElement));
if (graphics) {
  document.body.classList.toggle("software", graphics.software);
  page.show(new Stage(graphics));
} else {
  page.close();
  document.body.classList.add("bare");
  element("waiting-text", HTMLElement).textContent =
    "This browser offers no WebGL 2, which the page draws with. Turn on hardware acceleration, or try a current Firefox, Chrome or Safari.";
}
