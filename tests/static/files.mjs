// The files of the repository, without generated ones.
import { readdirSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

export const root = fileURLToPath(new URL("../../", import.meta.url));
const elsewhere = new Set(["build", "node_modules", "dist", ".git"]);

function* below(folder) {
  for (const entry of readdirSync(join(root, folder), { withFileTypes: true })) {
    const path = join(folder, entry.name);
    if (entry.isDirectory() && !elsewhere.has(entry.name)) yield* below(path);
    else if (entry.isFile()) yield path;
  }
}
export const files = [...below("")];
