// A stage's picture as a file, in the size that is chosen beside the button that saves it.
import type { PictureSize } from "../view/photograph";
import type { Stage } from "../view/stage";

/// Gives a file to the browser, which asks its user or puts it among the downloads.
export function saveFile(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/// The size that is chosen; else that of the window's picture. Video's need even numbers.
export function chosenSize(choice: HTMLSelectElement, { canvas }: Stage): PictureSize {
  const [width, height] = choice.value.split("x").map(Number);
  if (width && height) return { width, height };
  const ratio = Math.min(devicePixelRatio, 2);
  const even = (side: number): number => Math.max(2, 2 * Math.round((side * ratio) / 2));
  return { width: even(canvas.clientWidth), height: even(canvas.clientHeight) };
}

/// Where the page's backdrop is brightest, as its style sheet has it: shares of the width and the height.
export type BrightestAt = readonly [across: number, down: number];

/// Copies the picture that is on the stage's canvas. The stage's is transparent beside the scene: unless it is to be
/// `clear` it lies on the page's backdrop.
export function paint(stage: Stage, to: HTMLCanvasElement, [across, down]: BrightestAt, clear = false): void {
  const { canvas: view } = stage;
  const context = to.getContext("2d") as CanvasRenderingContext2D;
  const { width, height } = to;
  context.clearRect(0, 0, width, height);
  if (!clear) {
    const style = getComputedStyle(document.documentElement);
    const backdrop = context.createRadialGradient(0, 0, 0, 0, 0, 1);
    backdrop.addColorStop(0, style.getPropertyValue("--backdrop-near").trim());
    backdrop.addColorStop(1, style.getPropertyValue("--backdrop-far").trim());
    context.setTransform(0.9 * width, 0, 0, 0.75 * height, across * width, down * height);
    context.fillStyle = backdrop;
    context.fillRect(-1, -1, 3, 3);
    context.resetTransform();
  }
  // A film of the stage's is stretched to its canvas; what replaces the scene has the window's shape.
  const scale = Math.min(width / view.width, height / view.height);
  const [wide, high] = stage.replaced ? [scale * view.width, scale * view.height] : [width, height];
  context.drawImage(view, (width - wide) / 2, (height - high) / 2, wide, high);
}

/// Saves a picture of what the stage shows as a PNG; false: the browser made none.
export async function savePicture(
  stage: Stage,
  size: PictureSize,
  backdrop: BrightestAt,
  clear: boolean,
  name: string,
): Promise<boolean> {
  const canvas = Object.assign(document.createElement("canvas"), size);
  stage.photograph(size, () => paint(stage, canvas, backdrop, clear));
  const blob = await new Promise<Blob | null>((made) => {
    canvas.toBlob(made, "image/png");
  });
  if (blob) saveFile(blob, name);
  return blob !== null;
}
