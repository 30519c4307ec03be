// A cache for the program under test that is a test file's own, but for what the user's has: measurements of the
// device, and shaders that Mesa has compiled. Without these the first program of each file computes for seconds before
// it steps.
import { existsSync, mkdirSync, symlinkSync } from "node:fs";
import { homedir } from "node:os";
import { join } from "node:path";

const ofUser = process.env.XDG_CACHE_HOME ?? join(homedir(), ".cache");

/// The environment of a program whose other caches are elsewhere, or nowhere.
export const userShaders = { MESA_SHADER_CACHE_DIR: process.env.MESA_SHADER_CACHE_DIR ?? ofUser };

/// The environment of such a program; its own cache is in the folder.
export function cacheIn(folder) {
  const [devices, shared] = [folder, ofUser].map((cache) => join(cache, "clothlab", "devices"));
  mkdirSync(shared, { recursive: true });
  mkdirSync(join(folder, "clothlab"), { recursive: true });
  if (!existsSync(devices)) symlinkSync(shared, devices);
  return { XDG_CACHE_HOME: folder, ...userShaders };
}
