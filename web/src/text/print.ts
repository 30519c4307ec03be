// Prints a value as JSON, Python or JavaScript that a person can read: what fits a line stands on one.
import { isObject } from "../link/json_patch";

export type Language = "json" | "python" | "javascript";

const width = 88;
const pythonWords: Record<string, string> = { true: "True", false: "False", null: "None" };

/// `indent`: spaces before the value's further lines.
export function print(value: unknown, language: Language = "json", indent = 0): string {
  const scalar = JSON.stringify(value);
  if (typeof value !== "object" || value === null)
    return language === "python" ? (pythonWords[scalar] ?? scalar) : scalar;
  const key = (name: string): string =>
    language === "javascript" && /^[A-Za-z_]\w*$/.test(name) ? name : JSON.stringify(name);
  const items = (at: number): string[] =>
    Array.isArray(value)
      ? value.map((each) => print(each, language, at))
      : Object.entries(value as Record<string, unknown>).map(
          ([name, each]) => `${key(name)}: ${print(each, language, at)}`,
        );
  const [open, close] = Array.isArray(value) ? ["[", "]"] : ["{", "}"];
  const padding = isObject(value) && language !== "python" ? " " : "";
  const flat = items(indent);
  const line = flat.length === 0 ? open + close : `${open}${padding}${flat.join(", ")}${padding}${close}`;
  const flatEnough = !line.includes("\n") && indent + line.length <= width;
  if (flatEnough && (indent > 0 || flat.length === 0)) return line;
  const inner = " ".repeat(indent + 2);
  return `${open}\n${items(indent + 2)
    .map((item) => inner + item)
    .join(",\n")}\n${" ".repeat(indent)}${close}`;
}
