// A file of the dialogue, or one part of it: cloth or body, and of a cloth its fabric, where it is held, and its shape
// at rest.
import { guessRole, holds, patternScale, type Role, type Up } from "./guess";
import type { Item } from "./scene";
import { make, makeSelect } from "../lab/dom";
import type { Part } from "../link/mesh_upload";

const roles: [Role, string][] = [
  ["cloth", "Cloth"],
  ["body", "Body"],
  ["none", "Leave out"],
];
let groups = 0; // radio buttons of a row have a name of their own

export class Row {
  readonly element = make("section", "open-row");
  private role: Role;
  private readonly options = make("div", "open-options");
  private readonly fabric: HTMLSelectElement;
  private readonly rest = makeSelect(
    [
      ["shape", "the shape in the file"],
      ["pattern", "the flat pattern"],
    ],
    "shape",
  );
  private readonly restNote = make("p", "open-note");
  private held = makeSelect([], "");
  private heldChosen: string | null = null; // by the user
  private up: Up = "y";
  private carried = false;

  /// `title`: of the part of a file; `changed`: what it is, or how large all is, has changed.
  constructor(
    private readonly file: string,
    readonly part: Part,
    title: string,
    fabrics: string[],
    private readonly changed: () => void,
  ) {
    this.role = guessRole(part, file);
    this.fabric = makeSelect(
      fabrics.map((name) => [name, name]),
      "cotton",
    );
    this.rest.onchange = () => this.tellRest();
    const count = `${part.vertices.toLocaleString("en")} vertices, ${part.triangles.toLocaleString("en")} triangles`;
    const head = make("div", "open-head", make("b", "", title), make("span", "open-count", count), this.choice(title));
    this.element.append(head, this.options);
    this.element.setAttribute("aria-label", title);
    if (part.no_cloth !== null) this.element.append(make("p", "open-note", `A body alone: ${part.no_cloth}.`));
  }

  item(): Item {
    const { file, part, role } = this;
    const pattern = part.pattern && this.rest.value === "pattern" ? patternScale(part) : null;
    const held = holds(part, this.up).find(({ name }) => name === this.held.value)?.vertices ?? [];
    return { file, part, role, fabric: this.fabric.value, pattern, held: role === "cloth" ? held : [] };
  }

  /// Which way is up, and whether a body carries the cloth.
  follow(up: Up, carried: boolean): void {
    this.up = up;
    this.carried = carried;
    this.showOptions();
  }

  private choice(title: string): HTMLElement {
    const name = `open-role-${++groups}`;
    const group = make("div", "open-roles");
    group.setAttribute("role", "radiogroup");
    group.setAttribute("aria-label", `${title} is`);
    for (const [role, text] of roles) {
      const input = make("input");
      Object.assign(input, { type: "radio", name, value: role, checked: role === this.role });
      input.disabled = role === "cloth" && this.part.no_cloth !== null;
      input.onchange = () => {
        this.role = role;
        this.changed();
      };
      group.append(make("label", "", input, make("span", "", text)));
    }
    return group;
  }

  private showOptions(): void {
    this.options.hidden = this.role !== "cloth";
    this.element.classList.toggle("left-out", this.role === "none");
    const all = holds(this.part, this.up);
    // what no body carries is held where it hangs, unless the user has said otherwise
    const usual = this.carried ? "" : (all[0]?.name ?? "");
    const chosen =
      this.heldChosen !== null && (this.heldChosen === "" || all.some(({ name }) => name === this.heldChosen));
    this.held = makeSelect(
      [
        ["", "nowhere"],
        ...all.map(({ name, vertices }): [string, string] => [name, `${name} (${vertices.length} pins)`]),
      ],
      chosen ? (this.heldChosen as string) : usual,
    );
    this.held.onchange = () => {
      this.heldChosen = this.held.value;
      this.changed();
    };
    const field = (text: string, control: HTMLElement): HTMLElement =>
      make("label", "open-field", make("span", "", text), control);
    const rest = this.part.pattern ? [field("at rest", this.rest), this.restNote] : [];
    this.options.replaceChildren(field("fabric", this.fabric), field("held at", this.held), ...rest);
    this.tellRest();
  }

  // Areas tell the pattern's unit.
  private tellRest(): void {
    this.restNote.hidden = this.rest.value === "shape";
    const scale = patternScale(this.part);
    const times = scale === 1 ? "in the unit of the vertices" : `scaled by ${scale} to the unit of the vertices`;
    const share = (scale * scale * this.part.pattern_area) / this.part.area;
    this.restNote.textContent = `The pattern is taken ${times}: its area is then ${share.toFixed(2)} of the mesh's.`;
  }
}
