// The page's own decoder of binary messages, from web/src, bundled as the page is.
import { createRequire } from "node:module";
import { fileURLToPath } from "node:url";

const web = new URL("../../web/", import.meta.url);
const { build } = createRequire(new URL("package.json", web))("esbuild");

/// { decode, BadMessage, q16Words }
export async function pageDecoder() {
  const { outputFiles } = await build({
    entryPoints: [fileURLToPath(new URL("src/link/protocol.ts", web))],
    bundle: true,
    format: "esm",
    write: false,
  });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`);
}
