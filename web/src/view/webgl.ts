// Opens WebGL 2, and finds out whether a graphics processor or the processor draws.

export interface Graphics {
  canvas: HTMLCanvasElement;
  context: WebGL2RenderingContext;
  software: boolean;
}

const softwareRenderers = /swiftshader|llvmpipe|softpipe|software|basic render/i;
const attributes: WebGLContextAttributes = {
  alpha: true,
  depth: true,
  stencil: false,
  antialias: false,
  powerPreference: "high-performance",
};

function rendererName(gl: WebGL2RenderingContext): string {
  const details = gl.getExtension("WEBGL_debug_renderer_info");
  return String(gl.getParameter(details ? details.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
}

/// Opens WebGL 2; null if there is none. Edges are smoothed only by a graphics processor, which does so at no cost. The
/// renderer is known only from a context, and smoothing cannot be added to one: a graphics processor gets a second
/// context, on a fresh canvas.
export function openWebGl(canvas: HTMLCanvasElement): Graphics | null {
  const first = canvas.getContext("webgl2", attributes);
  if (!first) return null;
  if (softwareRenderers.test(rendererName(first))) return { canvas, context: first, software: true };
  const fresh = canvas.cloneNode() as HTMLCanvasElement;
  const smooth = fresh.getContext("webgl2", { ...attributes, antialias: true });
  if (!smooth) return { canvas, context: first, software: false };
  canvas.replaceWith(fresh);
  first.getExtension("WEBGL_lose_context")?.loseContext();
  return { canvas: fresh, context: smooth, software: false };
}
