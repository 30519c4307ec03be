// The scene as it was loaded, with which the panel compares: the preset of its name, or else the document as it came.
import { completed, type Schema } from "./schema";
import { valueAt } from "../link/json_patch";
import type { Operation, SceneDocument } from "../link/scene_types";
import { type Field, readField } from "../panel/field";

/// `dist/scenes.json`, which the page's build makes: the scene's schema and the presets' files.
export interface Scenes {
  schema: Schema;
  presets: Record<string, SceneDocument>;
}

const same = (a: unknown, b: unknown): boolean => JSON.stringify(a) === JSON.stringify(b);
const parentOf = (path: string): string => path.slice(0, path.lastIndexOf("/"));

export class Baseline {
  private scenes: Scenes | null = null;
  private came: SceneDocument | null = null; // as it came
  private reconnecting = false;
  private loaded: SceneDocument | null = null;

  /// Takes what the page loads after its first picture.
  know(scenes: Scenes): void {
    this.scenes = scenes;
    this.choose();
  }

  /// The connection is lost: the next document is the same scene again, changed or not.
  lost(): void {
    this.reconnecting = true;
  }

  /// Takes a whole document from the server.
  take(document: SceneDocument): void {
    const again = this.reconnecting && this.came?.name === document.name;
    this.reconnecting = false;
    if (again) return;
    this.came = document;
    this.choose();
  }

  /// What the document is compared with, in words; "" before anything is known.
  get name(): string {
    return this.loaded?.name ?? "";
  }

  /// The preset of this name, completed by the defaults; null if there is none, or before that is known.
  preset(name: string): SceneDocument | null {
    const preset = this.scenes && Object.hasOwn(this.scenes.presets, name) ? this.scenes.presets[name] : undefined;
    return preset && this.scenes ? completed(this.scenes.schema, preset) : null;
  }

  // A page that opens late sees a document that others have changed: a preset's own file is better. Before that is
  // here, nothing is compared.
  private choose(): void {
    if (!this.came || !this.scenes) return;
    this.loaded = this.preset(this.came.name) ?? this.came;
  }

  /// The scene as loaded, its cloths and colliders at the places that those of the same names have in `document`.
  alignedTo(document: SceneDocument): SceneDocument | null {
    const { loaded } = this;
    if (!loaded) return null;
    const align = <T extends { name?: string }>(now: T[], then: T[]): T[] =>
      now.map(({ name }, i) => (then[i]?.name === name ? then[i] : then.find((each) => each.name === name)) as T);
    return {
      ...loaded,
      cloths: align(document.cloths, loaded.cloths),
      colliders: align(document.colliders, loaded.colliders),
    };
  }
}

/// The operations on the stored document that bring a field back to how it was loaded; none if it is so, or if the
/// loaded scene has no such place.
export function wayBack(field: Field, stored: SceneDocument, loaded: SceneDocument): Operation[] {
  const places = [...field.paths, ...(field.along ?? [])];
  if (field.paths.some((path) => valueAt(loaded, parentOf(path)) === undefined)) return [];
  if (field.read) {
    if (same(readField(field, stored), readField(field, loaded))) return [];
  } else if (field.paths.every((path) => same(valueAt(stored, path), valueAt(loaded, path)))) return [];
  return places.flatMap((path): Operation[] => {
    const value = valueAt(loaded, path);
    const now = valueAt(stored, path);
    if (same(value, now)) return [];
    if (value !== undefined) return [{ op: now === undefined ? "add" : "replace", path, value }];
    return [{ op: "remove", path }];
  });
}
