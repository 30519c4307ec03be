// The scene as something to run: a command line, or a script with one of the clients that the server serves.
import { ordered } from "./order";
import { print } from "./print";
import { difference } from "./difference";
import { valueAt } from "../link/json_patch";
import type { Operation, SceneDocument } from "../link/scene_types";

export interface Place {
  address: string; ///< of the server, such as http://127.0.0.1:8080
  session: string;
}

const parentOf = (path: string): string => path.slice(0, path.lastIndexOf("/"));

/// Operations as assignments. One that `--set` cannot do (a removal, an insertion) becomes one of the whole around it;
/// so do all of a cloth whose mesh is another, as each must leave a valid scene and pins name vertices of the mesh.
export function assignments(from: SceneDocument, to: SceneDocument): [pointer: string, value: unknown][] {
  const operations = difference(from, to);
  const meshes = operations.flatMap(({ path }) => /^\/cloths\/\d+(?=\/mesh)/.exec(path)?.[0] ?? []);
  const isSet = ({ op, path }: Operation): boolean => {
    if (op === "replace") return true;
    const list = valueAt(from, parentOf(path));
    return op === "add" && !(Array.isArray(list) && Number(path.split("/").at(-1)) < list.length);
  };
  const wholes = [...meshes, ...operations.filter((each) => !isSet(each)).map(({ path }) => parentOf(path))];
  const places = new Set(
    operations.map(({ path }) => {
      const around = wholes.filter((whole) => path === whole || path.startsWith(`${whole}/`));
      return around.sort((a, b) => a.length - b.length)[0] ?? path;
    }),
  );
  return [...places].map((pointer) => [pointer, valueAt(to, pointer)]);
}

const quoted = (text: string): string => (/^[\w/.=+-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

/// The `clothlab serve` that opens this scene; `preset` is the one that it is made from, or null.
export function commandLine(scene: SceneDocument, preset: SceneDocument | null): string {
  if (!preset) return `clothlab serve --scene ${quoted(fileName(scene))}  # the file that Save makes`;
  const sets = assignments(preset, scene).map(([pointer, value]) => {
    const text = typeof value === "string" && !/^[\s{["]|^(true|false|null|-?\d.*)$/.test(value) ? value : null;
    return `--set ${quoted(`${pointer}=${text ?? JSON.stringify(value)}`)}`;
  });
  return [`clothlab serve --scene ${preset.name}`, ...sets].join(" \\\n  ");
}

const settable = (operations: Operation[]): boolean => operations.every(({ op }) => op === "replace");
const asObject = (operations: Operation[]): Record<string, unknown> =>
  Object.fromEntries(operations.map(({ path, value }) => [path, value]));

/// A script for clothlab.py.
export function python(scene: SceneDocument, preset: SceneDocument | null, { address, session }: Place): string {
  const operations = preset ? difference(preset, scene) : [];
  const change = settable(operations)
    ? `cloth.set(${print(asObject(operations), "python")})`
    : `cloth.patch(${print(operations, "python")})`;
  return [
    `# curl -O ${address}/clothlab.py`,
    "import clothlab",
    "",
    `cloth = clothlab.connect(${print(address, "python")}, session=${print(session, "python")})`,
    preset ? `cloth.load(${print(preset.name, "python")})` : `cloth.load(${print(ordered(scene), "python")})`,
    ...(operations.length > 0 ? [change] : []),
  ].join("\n");
}

/// A script for clothlab.mjs.
export function javaScript(scene: SceneDocument, preset: SceneDocument | null, { address, session }: Place): string {
  const operations = preset ? difference(preset, scene) : [];
  const change = settable(operations)
    ? `await cloth.set(${print(asObject(operations), "javascript")});`
    : `await cloth.patch(${print(operations, "javascript")});`;
  return [
    `// curl -O ${address}/clothlab.mjs`,
    'import { connect } from "./clothlab.mjs";',
    "",
    `const cloth = await connect(${JSON.stringify(address)}, { session: ${JSON.stringify(session)} });`,
    `await cloth.load(${preset ? JSON.stringify(preset.name) : print(ordered(scene), "javascript")});`,
    ...(operations.length > 0 ? [change] : []),
    "cloth.close();",
  ].join("\n");
}

/// The name of the scene's file.
export const fileName = ({ name }: { name?: string }): string =>
  `${(name || "scene").replace(/[^\p{Letter}\p{Number}._-]+/gu, "_")}.json`;
