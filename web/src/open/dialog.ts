// The dialogue that asks what opened files do not say: what is cloth and what is body, the unit, which way is up.
import { around, guessUnit, guessUp, type Role, sizeText, turned, type Unit, units, type Up } from "./guess";
import { Row } from "./row";
import { type Answers, extent } from "./scene";
import { make, makeButton, makeSelect } from "../lab/dom";
import type { Uploaded } from "../link/mesh_upload";

export interface Question {
  files: Uploaded[];
  fabrics: string[];
  scene: string; ///< the name of the scene that is there
  adds: boolean; ///< likelier that this belongs to it
  carries: boolean; ///< it has bodies
  edge: number | null; ///< Answers.edge
  before: { unit: Unit; up: Up } | null; ///< of the files of this scene that were opened before
}

const upright: [Up, string][] = [
  ["y", "Y"],
  ["z", "Z"],
  ["x", "X"],
];

/// A file with a row for all of it, or a row for each part.
class Opened {
  readonly element = make("div", "open-file");
  private rows: Row[] = [];
  private apart = false;

  constructor(
    readonly file: Uploaded,
    private readonly fabrics: string[],
    private readonly changed: () => void,
  ) {
    this.build();
  }

  get shown(): Row[] {
    return this.rows;
  }

  private build(): void {
    const { file } = this;
    const parts = this.apart ? file.nodes : [file];
    this.rows = parts.map((part) => new Row(file.name, part, part.node ?? file.name, this.fabrics, this.changed));
    this.element.replaceChildren(...this.rows.map(({ element }) => element));
    if (file.nodes.length > 1) {
      const label = this.apart ? `${file.name} as one` : `Take apart: ${file.nodes.length} parts`;
      this.element.append(
        makeButton(label, "plain open-apart", () => {
          this.apart = !this.apart;
          this.build();
          this.changed();
        }),
      );
    }
    if (file.notes.length > 0)
      this.element.append(
        make(
          "details",
          "open-notes",
          make("summary", "", "Mended, or to be known"),
          make("ul", "", ...file.notes.map((note) => make("li", "", note))),
        ),
      );
  }
}

function radios<T extends string>(name: string, all: [T, string][], now: T, changed: (value: T) => void): HTMLElement {
  const group = make("div", "open-roles");
  group.setAttribute("role", "radiogroup");
  group.setAttribute("aria-label", name);
  for (const [value, text] of all) {
    const input = make("input");
    Object.assign(input, { type: "radio", name: `open-${name.replaceAll(" ", "-")}`, value, checked: value === now });
    input.onchange = () => changed(value);
    group.append(make("label", "", input, make("span", "", text)));
  }
  return group;
}

/// Asks. Null: the user does not want it.
export function ask(question: Question): Promise<Answers | null> {
  const { files, before } = question;
  const whole = around(files.map(({ box }) => box));
  let up = before?.up ?? guessUp(whole, files.length === 1 ? (files[0] as Uploaded).name : "");
  let unit = guessUnit(whole);
  if (before && guessUnit(whole.map((corner) => corner.map((x) => x * before.unit.factor)) as typeof whole).key === "m")
    unit = before.unit;
  let fresh = !question.adds;

  const size = make("output", "open-size");
  const opened = files.map((file) => new Opened(file, question.fabrics, () => update()));
  const answers = (): Answers => ({
    items: opened.flatMap(({ shown }) => shown.map((row) => row.item())),
    factor: unit.factor,
    up,
    fresh,
    edge: fresh ? null : question.edge,
  });
  const choose = makeSelect(
    units.map(({ key, name }) => [key, name]),
    unit.key,
  );
  choose.setAttribute("aria-label", "unit");
  choose.onchange = () => {
    unit = units.find(({ key }) => key === choose.value) as Unit;
    update();
  };
  const go = makeButton("Open", "", () => undefined);
  go.type = "submit";

  if (opened.every(({ shown }) => shown.every((row) => row.item().role === "body"))) fresh = false;

  // The rows follow what the others are: a body carries the cloths.
  function update(): void {
    const rows = opened.flatMap(({ shown }) => shown);
    const has = (role: Role): boolean => rows.some((row) => row.item().role === role);
    const carried = has("body") || (!fresh && question.carries);
    for (const row of rows) row.follow(up, carried);
    const box = extent(answers()) ?? turned(whole, up);
    size.textContent = has("cloth") || has("body") ? sizeText(box) : "nothing";
    go.disabled = !has("cloth") && (!has("body") || fresh);
    alone.hidden = has("cloth") || !has("body") || !fresh;
  }

  const alone = make("p", "open-note", "A scene needs a cloth: add the body to the scene that is there.");
  const where = radios(
    "where",
    [
      ["new", "A new scene"],
      ["add", `Added to ${question.scene || "this scene"}`],
    ],
    fresh ? "new" : "add",
    (value) => {
      fresh = value === "new";
      update();
    },
  );
  const upChoice = radios("up", upright, up, (value) => {
    up = value;
    update();
  });
  const title = make(
    "h2",
    "",
    files.length === 1 ? `Open ${(files[0] as Uploaded).name}` : `Open ${files.length} files`,
  );
  title.id = "open-title";
  const line = (text: string, ...controls: HTMLElement[]): HTMLElement =>
    make("div", "open-line", make("span", "open-label", text), ...controls);
  const cancel = makeButton("Cancel", "plain", () => dialog.close());
  const form = make(
    "form",
    "",
    title,
    make("div", "open-files", ...opened.map(({ element }) => element)),
    line("The files are in", choose, size),
    line("Up is", upChoice),
    line("They become", where),
    alone,
    make("div", "open-buttons", go, cancel),
  );
  form.method = "dialog";
  const dialog = make("dialog", "open-dialog", form);
  dialog.setAttribute("aria-labelledby", title.id);
  update();
  document.body.append(dialog);
  dialog.showModal();
  go.focus();
  return new Promise((resolve) => {
    let taken: Answers | null = null;
    form.onsubmit = () => {
      taken = answers();
    };
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(taken);
    });
  });
}
