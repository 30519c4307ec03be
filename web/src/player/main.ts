// The page that plays a recording without a server: what `clothlab record --out F.html` writes.
import { element } from "../panel/dom";
import { fileName } from "../panel/file_name";
import { chosenSize, savePicture } from "../panel/picture_file";
import { bindCameraInput } from "../view/camera_input";
import { fields, gradient } from "../view/fields";
import { hook } from "../test_hook";
import { Stage } from "../view/stage";
import { openWebGl } from "../view/webgl";
import { Player } from "./player";
import { Reader, type Recording } from "./recording";
import { followSystemTheme } from "../system_theme";

declare global {
  interface Window {
    clothlabRecording: ArrayBuffer; ///< the page puts it there
  }
}

const backdrop = [0.5, 0.5] as const; // as in player.css
const title = document.title;
const message = element("message", HTMLElement);
const slider = element("frame", HTMLInputElement);
const clock = element("clock", HTMLOutputElement);
const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;

function fail(error: unknown): void {
  message.textContent = error instanceof Error ? error.message : String(error);
  message.hidden = false;
}

function describe({ rate, frames, diverged }: Recording): void {
  element("about", HTMLElement).textContent = title;
  slider.max = String(frames - 1);
  slider.title = `${frames} frames, ${Number(rate.toPrecision(3))} a second`;
  if (!diverged) return;
  message.textContent = `It blew up after this: ${diverged.reason}. ${diverged.remedy}.`;
  message.hidden = false;
}

function bind(stage: Stage, player: Player, name: string): void {
  const playButton = element("play", HTMLButtonElement);
  const strain = element("strain", HTMLButtonElement);
  const toggle = (): void => player.play(!player.playing);
  const go = (frame: number): void => {
    player.play(false);
    player.seek(frame);
  };
  const colour = (): void => {
    player.strained = !player.strained;
    strain.setAttribute("aria-pressed", String(player.strained));
    element("legend", HTMLElement).hidden = !player.strained;
    player.again();
  };
  const fit = (): void => stage.fit();
  playButton.onclick = toggle;
  strain.onclick = colour;
  element("fit", HTMLButtonElement).onclick = fit;
  const picture = async (): Promise<void> => {
    const clear = element("picture-clear", HTMLInputElement).checked;
    const size = chosenSize(element("picture-size", HTMLSelectElement), stage);
    if (!(await savePicture(stage, size, backdrop, clear, fileName(name, player.time, "png"))))
      fail(new Error("The browser made no picture of it."));
  };
  element("picture-save", HTMLButtonElement).onclick = () => void picture();
  slider.oninput = () => go(Number(slider.value));
  const keys: Record<string, () => void> = {
    " ": toggle,
    ",": () => go(player.frame - 1),
    ".": () => go(player.frame + 1),
    Home: () => go(0),
    End: () => go(Number(slider.max)),
    s: colour,
    f: fit,
  };
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { target } = event; // which may have keys of its own
    if (target instanceof HTMLSelectElement) return;
    if (event.key === " " && target instanceof HTMLElement && target.matches("button, summary, [type=checkbox]"))
      return;
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
  bindCameraInput(stage.controls, () => false);
}

async function start(): Promise<void> {
  const recording = await Reader.open(window.clothlabRecording);
  if (recording.frames === 0) throw new Error("This recording has no frames.");
  const graphics = openWebGl(element("view", HTMLCanvasElement));
  if (!graphics) throw new Error("This browser offers no WebGL 2. Turn on hardware acceleration, or try another one.");
  document.body.classList.toggle("software", graphics.software);
  describe(recording);
  const stage = (hook.stage = new Stage(graphics));
  stage.onLost = () => fail("The browser took the graphics away. It gives them back by itself; if not, reload.");
  followSystemTheme(() => stage.setTheme());
  const resize = (): void =>
    stage.resize({ left: 0, top: 0, width: innerWidth, height: Math.max(1, innerHeight - 80) });
  addEventListener("resize", resize);
  const player = new Player(recording, stage, {
    failed: fail,
    playing: (playing) => {
      document.body.classList.toggle("playing", playing);
      element("play", HTMLButtonElement).setAttribute("aria-label", playing ? "Pause" : "Play");
    },
    shown: (frame, { time }, range) => {
      slider.value = String(frame);
      clock.textContent = `${player.time.toFixed(2)} s`;
      clock.title = `Simulated time: ${time.toFixed(2)} s`;
      slider.setAttribute("aria-valuetext", clock.textContent);
      if (range > 0) element("legend-most", HTMLElement).textContent = fields.strain.most(range);
      document.body.classList.add("drawing");
    },
  });
  element("legend-scale", HTMLElement).style.background = gradient("strain");
  resize();
  bind(stage, player, recording.name);
  player.play(!calm);
}

start().catch(fail);
