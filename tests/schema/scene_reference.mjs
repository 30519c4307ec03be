// Makes the tables of server/scene/README.md from scene.schema.json and fabrics.json beside it. After a change of
// either:
//   node tests/schema/scene_reference.mjs
import { readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const folder = new URL("../../server/scene/", import.meta.url);
const begin = "<!-- made by tests/schema/scene_reference.mjs from scene.schema.json -->\n",
  beginFabrics = "<!-- made by tests/schema/scene_reference.mjs from fabrics.json -->\n",
  end = "<!-- end of what is made -->\n";

/// Each table: its title, its place in the schema, and the text above it.
const tables = [
  ["The document", []],
  ["`self_collision`", ["properties", "self_collision", "oneOf", 1]],
  ["`wind`", ["properties", "wind", "oneOf", 1]],
  ["`solver`", ["properties", "solver"]],
  ["`keys[]`", ["$defs", "key"]],
  ["A cloth: `cloths[]`", ["$defs", "cloth"]],
  ["`mesh: {grid}`", ["$defs", "cloth", "properties", "mesh", "oneOf", 0, "properties", "grid"]],
  ["`mesh: {panel}`", ["$defs", "cloth", "properties", "mesh", "oneOf", 3, "properties", "panel"]],
  ["`mesh: {vertices, triangles}`", ["$defs", "cloth", "properties", "mesh", "oneOf", 1]],
  ["`mesh: {file}`", ["$defs", "cloth", "properties", "mesh", "oneOf", 2]],
  ["`transform`", ["$defs", "cloth", "properties", "transform"]],
  ["`mass: {per_vertex}` or `{area_density}`", ["$defs", "cloth", "properties", "mass"]],
  ["`material`, of springs", ["$defs", "cloth", "properties", "material", "oneOf", 0]],
  ["`material`, of finite elements", ["$defs", "cloth", "properties", "material", "oneOf", 1]],
  [
    "`bending`, of finite elements",
    ["$defs", "cloth", "properties", "material", "oneOf", 1, "properties", "bending", "oneOf", 1],
  ],
  [
    "`strain_limit`, of finite elements",
    ["$defs", "cloth", "properties", "material", "oneOf", 1, "properties", "strain_limit", "oneOf", 2],
  ],
  ["`pins[]`", ["$defs", "cloth", "properties", "pins", "items"]],
  ["`weights[]`", ["$defs", "cloth", "properties", "weights", "items"]],
  ["`start: {scatter}`, `{scale}` or `{dress}`", ["$defs", "cloth", "properties", "start"]],
  ["A collider: `colliders[]`", ["$defs", "collider"]],
  ["The shapes of colliders", ["$defs", "shape", "properties"]],
  ["`motion`, of a pin or a collider", ["$defs", "motion"]],
  ["`at`, of a pin or a weight", ["$defs", "at"]],
];

const [, meshOfCloth] = tables.find(([title]) => title === "`mesh: {file}`");

const code = (text) => "`" + text + "`";
const number = (value) =>
  Math.abs(value) >= 1e5 || (value !== 0 && Math.abs(value) < 1e-3)
    ? value.toExponential().replace("e+", "e")
    : String(value);

/// The range of a place or direction, which the document says once for all lists of 3 numbers.
const anyNumber = "-1e6 to 1e6";

/// The values that a key may have.
function allowed(schema) {
  if ("const" in schema) return code(JSON.stringify(schema.const));
  if (schema.enum?.includes("cotton")) return "[a fabric](#fabrics)";
  if (schema.enum) return schema.enum.map((value) => code(String(value))).join(", ");
  if (schema.type === "string") return schema.pattern?.startsWith("^#") ? "`#rrggbb`" : "text";
  if (schema.type === "boolean") return "`true`, `false`";
  if (schema.type?.includes?.("string")) return "text or null";
  if (schema.oneOf) return [...new Set(schema.oneOf.map(allowed))].join(" or ");
  const types = [schema.type].flat();
  if (types.includes("boolean")) return "a value";
  if (types.includes("null") && types.length === 1) return "null";
  if (types.includes("array")) {
    const size =
      schema.minItems === schema.maxItems ? `${schema.minItems}` : `${schema.minItems ?? 0} to ${schema.maxItems}`;
    const items = schema.prefixItems ? schema.prefixItems.map(allowed).join(", ") : allowed(schema.items);
    if (schema.prefixItems) return `list of ${items}`;
    if (size === "3" && items === anyNumber) return "3 numbers";
    if (items === "see below") return `list of ${size}`;
    return `list of ${size}, each ${items}`;
  }
  if (types.includes("number") || types.includes("integer")) {
    const range =
      schema.maximum === undefined
        ? `${number(schema.minimum)} or more`
        : `${number(schema.minimum)} to ${number(schema.maximum)}`;
    return (types.includes("integer") ? "whole, " : "") + range + (types.includes("null") ? " or null" : "");
  }
  const keys = Object.keys(schema.properties ?? {});
  return keys.length > 0 && keys.length <= 4 ? code(`{${keys.join(", ")}}`) : "see below";
}

/// A definition, completed by the place that refers to it.
function merged(definition, part) {
  const both = { ...definition, ...part, $ref: undefined };
  if (definition.properties && part.properties) both.properties = { ...definition.properties, ...part.properties };
  return both;
}

/// The markdown between the markers.
export function reference(schema) {
  const resolve = (part) => (part.$ref ? merged(resolve(schema.$defs[part.$ref.split("/").at(-1)]), part) : part);
  const deep = (part) => {
    if (Array.isArray(part)) return part.map(deep);
    if (part === null || typeof part !== "object") return part;
    return Object.fromEntries(
      Object.entries(resolve(part))
        .filter(([, value]) => value !== undefined)
        .map(([key, value]) => [key, deep(value)]),
    );
  };
  const find = (path) => deep(path.reduce((part, key) => part[key], schema));
  const inner = (key, value) => properties(value).map(([name, ...rest]) => [`${key}.${name}`, ...rest]);
  const properties = (part) =>
    part.properties
      ? Object.entries(part.properties).map(([key, value]) => [key, value, part.required ?? []])
      : (part.oneOf ?? []).flatMap((choice) =>
          properties(choice).flatMap(([key, value, required]) =>
            value.properties ? inner(key, value) : [[key, value, required]],
          ),
        );
  const shapes = (part) => Object.entries(part).flatMap(([key, value]) => inner(key, value));
  const isShapes = (path) => path.at(-1) === "properties";
  const rows = (keys) =>
    keys.map(([key, value, required]) => {
      const name = key.split(".").at(-1);
      const fallback = required.includes(name)
        ? "; required"
        : value.default === undefined
          ? ""
          : `; ${code(JSON.stringify(value.default))}`;
      const said = value.description ? `: ${value.description}` : "";
      return `* ${code(key)} (${allowed(value)}${fallback})${said}`;
    });
  /// Rows of shapes, without those that a cloth's mesh has, too: these are named in the last row.
  const ofShapes = (list) => {
    const bare = (row) => row.replace(/^\* `(?:\w+\.)*/, "");
    const cloth = rows(properties(find(meshOfCloth))).map(bare);
    const [other, like] = [false, true].map((same) => list.filter((row) => cloth.includes(bare(row)) === same));
    return [...other, `* ${like.map((row) => row.split(" ")[1]).join(", ")}: As of a cloth's mesh.`];
  };
  const table = (part, path, title) =>
    title.startsWith("`at`")
      ? part.oneOf.map(
          (choice) => `* ${choice.description ?? `${allowed(choice)}: ${choice.properties.box.description}`}`,
        )
      : isShapes(path)
        ? ofShapes(rows(shapes(part)))
        : rows(properties(part));
  // What a row of a table says already is not said again above the table of its keys.
  const inRow = new Set(
    tables.flatMap(([, path]) => (isShapes(path) ? [] : properties(find(path)))).map(([, value]) => value.description),
  );
  return tables
    .map(([title, path]) => {
      const part = find(path);
      const said = path.length > 0 && part.description && !inRow.has(part.description);
      const above = said ? [wrapped(part.description), ""] : [];
      return [`### ${title}`, "", ...above, ...table(part, path, title).map(item), ""].join("\n");
    })
    .join("\n");
}

/// A paragraph in lines of at most 120 characters.
const wrapped = (text) => text.replace(/(?=.{121})(.{1,120}) /g, "$1\n");
/// An item of a list, its further lines indented.
const item = (text) => text.replace(/(?=.{119})(.{1,118}) /g, "$1\n  ").replace(/ +$/gm, "");

/// The fabrics and what they are like.
function fabricTable(fabrics) {
  const micro = (value) => (value === null ? "" : String(Number((1e6 * value).toPrecision(4))));
  const rows = fabrics.map(({ name, feel, area_density, material, locks_at }) => {
    const { warp, weft, poisson, shear, bending } = material;
    const bends = [bending.warp, bending.weft, bending.twist].map(micro).filter((text) => text !== "");
    const locks = locks_at ? `${locks_at.warp} / ${locks_at.weft}` : "";
    const numbers = [(1000 * area_density).toFixed(1), `${warp} / ${weft}`, poisson, shear, bends.join(" / "), locks];
    return `| ${[code(name), feel, ...numbers].join(" | ")} |`;
  });
  const head = "| | what it is like | g/m^2 | warp / weft | poisson | shear | bending [uN m] | locks at |";
  return [head, "|---|---|---|---|---|---|---|---|", ...rows].join("\n") + "\n";
}

function replaced(text, from, to, made) {
  const [first, last] = [text.indexOf(from), text.indexOf(to, text.indexOf(from))];
  if (first < 0 || last < first) throw new Error("server/scene/README.md has lost its markers");
  return text.slice(0, first) + from + "\n" + made + "\n" + text.slice(last);
}

/// The README with its tables made anew.
export function updated(readme, schema, fabrics) {
  return replaced(replaced(readme, begin, end, reference(schema)), beginFabrics, end, fabricTable(fabrics));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const file = new URL("README.md", folder);
  const [schema, fabrics] = ["scene.schema.json", "fabrics.json"].map((name) =>
    JSON.parse(readFileSync(new URL(name, folder))),
  );
  writeFileSync(file, updated(readFileSync(file, "utf8"), schema, fabrics));
}
