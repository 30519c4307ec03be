// Tells the panel about its fields: what each means and costs, and how it was when the scene was loaded.
import { Baseline, type Scenes, wayBack } from "./baseline";
import { costOf } from "./costs";
import type { Explained } from "./explanation";
import { wordsFor } from "./schema";
import type { Operation, SceneDocument } from "../link/scene_types";
import { type Field, readField } from "../panel/field";
import { readable } from "../panel/slider";

const large = (value: number): string =>
  Math.abs(value) >= 1e6 ? value.toExponential().replace("e+", "e") : readable(value);
const shown = (value: unknown, times = 1): string => {
  if (typeof value === "number") return large(value * times);
  return value === null ? "none" : String(value);
};

export class Guide {
  readonly baseline = new Baseline();
  private scenes: Scenes | null = null;

  /// Loads the schema and the presets, which the first picture need not wait for. Without them nothing is explained or
  /// marked.
  async load(): Promise<void> {
    const answer = await fetch("scenes.json").catch(() => null);
    if (!answer?.ok) return;
    this.scenes = (await answer.json()) as Scenes;
    this.baseline.know(this.scenes);
  }

  /// The way back of each field, in the order of `fields`. What goes back with a whole that differs, such as the
  /// numbers of another model or motion, has none of its own.
  waysBack(fields: Field[], stored: SceneDocument): Operation[][] {
    const loaded = this.baseline.alignedTo(stored);
    if (!loaded) return fields.map(() => []);
    const wholes = new Set<string>();
    const ways = fields.map((field) => {
      const way = wayBack(field, stored, loaded);
      if (way.some(({ path }) => wholes.has(path))) return [];
      for (const { path } of way) wholes.add(path);
      return way;
    });
    const within = (path: string): boolean => [...wholes].some((whole) => path.startsWith(`${whole}/`));
    return ways.map((way) => (way.some(({ path }) => within(path)) ? [] : way));
  }

  /// How the field was when the scene was loaded, as text; "" if that is not known.
  formerly(field: Field, stored: SceneDocument): string {
    const loaded = this.baseline.alignedTo(stored);
    const value = loaded ? readField(field, loaded) : undefined;
    if (value === undefined) return "";
    const text = field.kind === "choice" ? (field.names?.[String(value)] ?? shown(value)) : shown(value);
    if (field.kind === "toggle") return value ? "on" : "off";
    if (field.kind !== "number") return text;
    return value === 0 && field.scale.zeroText ? field.scale.zeroText : `${text} ${field.scale.unit ?? ""}`.trim();
  }

  explain(field: Field, document: SceneDocument, stored: SceneDocument): Explained | null {
    if (!this.scenes) return null;
    const path = field.about ?? (field.paths[0] as string);
    const words = wordsFor(this.scenes.schema, document, path);
    const percent = field.kind === "number" && field.scale.unit === "%" && words?.unit !== "%";
    const times = percent ? 100 : 1;
    const unit = field.kind === "number" ? (field.scale.unit ?? words?.unit ?? "") : "";
    const facts: Explained["facts"] = [];
    if (field.kind === "number" && words?.least !== undefined) {
      const most = words.most === undefined ? " and more" : ` to ${shown(words.most, times)}`;
      facts.push(["Range", `${shown(words.least, times)}${most}${unit && ` ${unit}`}`]);
    }
    if (field.kind === "choice" && words?.choices) facts.push(["One of", words.choices.map(String).join(", ")]);
    if (words && words.initial !== undefined && typeof words.initial !== "object")
      facts.push(["Default", `${shown(words.initial, times)}${unit && ` ${unit}`}`]);
    else if (words?.initial === null) facts.push(["Default", field.kind === "toggle" ? "off" : "none"]);
    const was = this.formerly(field, stored);
    if (was) facts.push([`In ${this.baseline.name}`, was]);
    facts.push(["Costs", costOf(path)]);
    return {
      title: field.kind === "number" && unit ? `${field.label} [${unit}]` : field.label,
      says: [...(field.hint ? [`${field.hint.replace(/\.$/, "")}.`] : []), ...(words?.says ? [words.says] : [])],
      facts,
    };
  }
}
