// Starts the page: the connection first, since its handshake needs no processor while WebGL starts.
import { element } from "./dom";
import { Page } from "./page";
import { probeWebGl, Stage } from "./stage";

const softwareRenderers = /swiftshader|llvmpipe|softpipe|software|basic render/i;

const page = new Page();
const renderer = probeWebGl();
if (renderer) {
  const software = softwareRenderers.test(renderer);
  document.body.classList.toggle("software", software);
  page.show(new Stage(element("view", HTMLCanvasElement), software));
} else {
  page.close();
  document.body.classList.add("bare");
  element("waiting-text", HTMLElement).textContent =
    "This browser offers no WebGL 2, which the page draws with. Turn on hardware acceleration, or try a current Firefox, Chrome or Safari.";
}
