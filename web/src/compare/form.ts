// The form that says what A and B are. B is the present scene with what the form changes in it.
import { standard } from "./host";
import { labelled, make, makeNumber, makeSelect, numberIn, say } from "../lab/dom";
import { applyPatch, isObject, valueAt } from "../link/json_patch";
import type { Operation, Patch, SceneDocument } from "../link/scene_types";
import { methodText } from "../panel/methods";
import { difference } from "../text/difference";
import { isFault, readJson } from "../text/json_text";

const stiffnesses = ["structural", "shear", "bend", "warp", "weft", "bending"];
const everything = { least: 0.01, most: 60 }; // [s]: as lab.compare allows

/// A number scaled, or each number of an object.
function scaled(value: unknown, factor: number): unknown {
  if (typeof value === "number") return value * factor;
  return isObject(value) ? Object.fromEntries(Object.entries(value).map(([k, v]) => [k, scaled(v, factor)])) : value;
}

export class Form {
  readonly element = make("div", "compare-form");
  private readonly truth = makeSelect(
    [
      ["", "the scene as it is"],
      ["truth", "the truth of B, in double precision"],
    ],
    "",
  );
  private readonly method = makeSelect([], "");
  private readonly dt = makeNumber("1");
  private readonly iterations = makeNumber("1");
  private readonly contact = makeSelect(
    [
      ["points", "points"],
      ["surface", "surface"],
      ["", "none"],
    ],
    "points",
  );
  private readonly stiffness = makeNumber("1", "1");
  private readonly time = makeNumber("5", String(standard.time));
  private readonly more = make("textarea", "compare-more");
  private readonly moreBox = make(
    "details",
    "lab-more",
    make("summary", "", "More changes, as a JSON patch"),
    this.more,
  );
  private readonly iterationsField = labelled("iterations", this.iterations);
  private readonly contactField = labelled("self-collision", this.contact, "what of the cloth keeps apart");
  private readonly present = make("p", "lab-fine");
  private touched = false; // else the form follows the scene

  constructor(private readonly document: () => SceneDocument | null) {
    this.more.rows = 4;
    this.more.spellcheck = false;
    this.more.setAttribute("aria-label", "More changes of B, as a JSON patch");
    this.more.placeholder = '{"wind": {"velocity": [3, 0, 0]}}';
    const b = this.side(
      "B",
      labelled("method", this.method),
      labelled("dt [ms]", this.dt, "the time step"),
      this.iterationsField,
      labelled("stiffness ×", this.stiffness, "all stiffnesses of all cloths, times this"),
      this.contactField,
      this.moreBox,
    );
    this.element.append(
      this.side("A", labelled("A is", this.truth, "what B is compared with"), this.present),
      b,
      make("div", "compare-side", labelled("simulate [s]", this.time, "from the start of the scene")),
    );
    b.addEventListener("input", () => (this.touched = true));
    this.method.addEventListener("change", () => this.methodChosen());
  }

  private side(name: string, ...children: HTMLElement[]): HTMLElement {
    const set = make("fieldset", "compare-side", make("legend", `compare-name ${name.toLowerCase()}`, name));
    set.append(...children);
    return set;
  }

  setMethods(methods: string[]): void {
    const { value } = this.method;
    this.method.replaceChildren(
      ...methods.filter((id) => id !== "auto").map((id) => new Option(methodText(id).name, id, false, id === value)),
    );
    this.sceneChanged();
  }

  sceneChanged(): void {
    if (!this.touched) this.take({ patch: [], truth: this.isTruth, time: numberIn(this.time) ?? standard.time });
    const kind = this.document()?.self_collision?.kind;
    if (kind && this.contactField.hidden) this.contact.value = kind;
    this.contactField.hidden = !kind;
  }

  get isTruth(): boolean {
    return this.truth.value !== "";
  }

  /// Fills the form in, so that it asks for this.
  take({ patch, truth, time }: { patch: Patch; truth: boolean; time: number }): void {
    const scene = this.document();
    if (!scene) return;
    this.touched = !Array.isArray(patch) || patch.length > 0;
    const target = applyPatch(scene, patch);
    const { solver } = target;
    this.truth.value = truth ? "truth" : "";
    this.time.value = String(time);
    this.method.value = solver.method;
    if (this.method.value === "") this.method.selectedIndex = this.indexOf("verlet");
    this.dt.value = String(Number((1000 * solver.dt).toPrecision(9)));
    this.iterations.value = String(solver.iterations);
    this.stiffness.value = "1";
    this.contactField.hidden = !scene.self_collision;
    this.contact.value = target.self_collision?.kind ?? "";
    const left = difference(this.changed(scene), target);
    this.more.value = left.length > 0 ? JSON.stringify(left, null, 1) : "";
    this.moreBox.open = left.length > 0;
    this.show();
  }

  private indexOf(method: string): number {
    return Math.max(
      0,
      [...this.method.options].findIndex(({ value }) => value === method),
    );
  }

  private methodChosen(): void {
    const { iterations } = methodText(this.method.value);
    if (iterations?.suits) this.iterations.value = String(iterations.suits.iterations);
    this.show();
  }

  private show(): void {
    this.iterationsField.hidden = methodText(this.method.value).iterations === null;
    const method = this.document()?.solver.method ?? "";
    say(
      this.present,
      method === "auto"
        ? "Its method is Auto: A is stepped by Verlet below its limit, as until the lab has chosen."
        : "",
    );
  }

  /// The scene with what the fields change, without the patch.
  private changed(scene: SceneDocument): SceneDocument {
    const dt = this.number(this.dt, "dt [ms]", 0) / 1000;
    const iterating = methodText(this.method.value).iterations !== null;
    const iterations = iterating ? this.number(this.iterations, "iterations", 0) : scene.solver.iterations;
    const factor = this.number(this.stiffness, "stiffness ×", 0);
    const cloths = scene.cloths.map((cloth) => {
      if (factor === 1) return cloth;
      const material = { ...cloth.material } as Record<string, unknown>;
      for (const key of stiffnesses) if (key in material) material[key] = scaled(material[key], factor);
      return { ...cloth, material };
    });
    const kind = this.contact.value;
    const contact = scene.self_collision && (kind === "" ? null : { ...scene.self_collision, kind });
    const solver = { ...scene.solver, method: this.method.value, dt, iterations };
    return { ...scene, cloths, self_collision: contact, solver } as SceneDocument;
  }

  private number(input: HTMLInputElement, name: string, least: number): number {
    const value = numberIn(input);
    if (value === undefined || !(value > least && value < Infinity))
      throw new Error(`${name} is ${input.value.trim() || "empty"}; allowed is a number above ${least}.`);
    return value;
  }

  /// What the form asks for: operations on the scene as it is shown. Throws an Error that says what is wrong.
  asked(): { patch: Operation[]; truth: boolean; time: number } {
    const scene = this.document();
    if (!scene) throw new Error("The scene has not come yet.");
    const time = this.number(this.time, "simulate [s]", 0);
    if (time < everything.least || time > everything.most)
      throw new Error(`simulate [s] is ${time}; allowed is ${everything.least} to ${everything.most}.`);
    const fields = this.changed(scene);
    return { patch: difference(scene, this.withMore(fields)), truth: this.isTruth, time };
  }

  private withMore(scene: SceneDocument): SceneDocument {
    if (this.more.value.trim() === "") return scene;
    const read = readJson(this.more.value);
    if (isFault(read)) throw new Error(`The patch, line ${read.line}, column ${read.column}: ${read.says}.`);
    const patch = read.value;
    if (!isObject(patch) && !Array.isArray(patch))
      throw new Error("The patch is neither an object (RFC 7396) nor an array (RFC 6902).");
    for (const { op, path } of Array.isArray(patch) ? (patch as Operation[]) : [])
      if (op !== "add" && valueAt(scene, path) === undefined)
        throw new Error(`The patch: there is nothing at ${path} in the scene.`);
    return applyPatch(scene, patch as Patch);
  }
}
