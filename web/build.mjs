// Bundles the page into dist/: one HTML file, one script and one style sheet. Nothing is inline: the CSP forbids it.
import { build } from "esbuild";
import { cpSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { brotliCompressSync, constants, deflateRawSync } from "node:zlib";

const here = dirname(fileURLToPath(import.meta.url));
const dist = join(here, "dist");
rmSync(dist, { recursive: true, force: true });
mkdirSync(dist);
cpSync(join(here, "static"), dist, { recursive: true });

// What explains the panel, and what it compares with: the page loads it after its first picture.
const scenes = join(here, "../server/scene");
const read = (file) => JSON.parse(readFileSync(join(scenes, file), "utf8"));
const presets = readdirSync(join(scenes, "presets")).filter((file) => file.endsWith(".json"));
const known = {
  schema: read("scene.schema.json"),
  presets: Object.fromEntries(presets.map((file) => [file.slice(0, -".json".length), read(`presets/${file}`)])),
};
writeFileSync(join(dist, "scenes.json"), JSON.stringify(known));

// lil-gui's style sheet holds an icon font in a data: URL, which the CSP also refuses: panel.css draws the icons.
const withoutFonts = {
  name: "without-fonts",
  setup({ onLoad }) {
    onLoad({ filter: /lil-gui(\.min)?\.css$/ }, ({ path }) => ({
      contents: readFileSync(path, "utf8").replace(/@font-face\s*{[^}]*}/g, ""),
      loader: "css",
    }));
  },
};

const common = {
  absWorkingDir: here,
  bundle: true,
  minify: true,
  target: ["es2022", "chrome100", "firefox100", "safari15.4"],
  legalComments: "none",
  logLevel: "warning",
};

const { metafile } = await build({
  ...common,
  entryPoints: {
    app: "src/main.ts",
    style: "src/style.css",
    text: "src/text/text.css",
    gallery: "src/gallery/gallery.css",
    compare: "src/compare/compare.css",
    inside: "src/inside/inside.css",
    open: "src/open/open.css",
    show: "src/show/show.css",
  },
  outdir: "dist",
  splitting: true, // what an import() names is loaded when it is used
  chunkNames: "[name]-[hash]",
  format: "esm",
  plugins: [withoutFonts],
  metafile: true,
});

// What the first script shares with those that come later is asked for beside it, not after it.
const shared = metafile.outputs["dist/app.js"].imports.filter(({ kind }) => kind === "import-statement");
const links = shared.map(({ path }) => `<link rel="modulepreload" href="${path.slice("dist/".length)}">`);
const page = join(dist, "index.html");
writeFileSync(page, readFileSync(page, "utf8").replace(/(?= *<script)/, `  ${links.join("\n  ")}\n`));

// The thread that unpacks frames is a script of its own: browsers load no modules there, or learned it late.
await build({
  ...common,
  entryPoints: { unpack: "src/link/unpack_worker.ts" },
  outdir: "dist",
  format: "iife",
});

// The page that plays a recording is a single file: it is opened from a disk, where nothing can be loaded. The server's
// program puts in @title@ and @recording@ (server/stream/player_page.cpp).
const { outputFiles } = await build({
  ...common,
  entryPoints: { player: "src/player/main.ts", style: "src/player/player.css" },
  outdir: "dist",
  format: "iife",
  write: false,
});
const made = (ending) => Buffer.from(outputFiles.find(({ path }) => path.endsWith(ending)).contents);
const filled = {
  style: made(".css").toString().trim(),
  player: deflateRawSync(made(".js"), { level: 9 }).toString("base64"),
};
const player = readFileSync(join(here, "src/player/player.html"), "utf8");
writeFileSync(
  join(dist, "player.html"),
  player.replace(/@(style|player)@/g, (_, name) => filled[name]),
);

// The page of a sweep is a single file, too; the program puts in @title@ and @table@ (server/sweep/table.cpp).
const { outputFiles: sweepFiles } = await build({
  ...common,
  entryPoints: { sweep: "src/sweep/main.ts", style: "src/sweep/sweep.css" },
  outdir: "dist",
  format: "iife",
  write: false,
});
const sweepText = (ending) => sweepFiles.find(({ path }) => path.endsWith(ending)).text.trim();
const sweep = { style: sweepText(".css"), script: sweepText(".js") };
writeFileSync(
  join(dist, "sweep.html"),
  readFileSync(join(here, "src/sweep/sweep.html"), "utf8").replace(/@(style|script)@/g, (_, name) => sweep[name]),
);

// The server sends these to browsers that take brotli, which is once and slow to make and a seventh smaller than gzip.
for (const file of readdirSync(dist, { recursive: true })) {
  if (!/\.(html|js|css|json|svg)$/.test(file)) continue;
  const text = readFileSync(join(dist, file));
  const hint = {
    [constants.BROTLI_PARAM_MODE]: constants.BROTLI_MODE_TEXT,
    [constants.BROTLI_PARAM_SIZE_HINT]: text.length,
  };
  writeFileSync(join(dist, `${file}.br`), brotliCompressSync(text, { params: hint }));
}
