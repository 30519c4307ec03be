// The tab with the stability map: where each method blows up, measured and predicted.
import { labelled, make, makeNumber, makeSelect, numberIn } from "./dom";
import { Drawing } from "./drawing";
import { numbersOf } from "./numbers";
import { Picture, type Tip } from "./picture";
import { Tab, type TabHost } from "./tab";
import { Table } from "./table";
import { stepText } from "./text";
import type { MapCell, MapColumn, StabilityMap } from "./types";
import { methodText } from "../panel/methods";
import { valueAt } from "../link/json_patch";
import type { Material, Operation, SceneDocument } from "../link/scene_types";

const allStiffnesses = "stiffness";
/// All stiffnesses of a material: their places in it, and their values.
function stiffnessesOf(material: Material): [string, number][] {
  if (material.model === "springs")
    return [
      ["structural", material.structural],
      ["shear", material.shear],
      ["bend", material.bend],
    ];
  const { warp, weft, shear, bending } = material;
  const sheet: [string, number][] = [
    ["warp", warp],
    ["weft", weft],
    ["shear", shear],
  ];
  if (typeof bending === "number") return [...sheet, ["bending", bending]];
  const parts = Object.entries(bending).flatMap(([key, value]): [string, number][] =>
    value === null ? [] : [[`bending/${key}`, value]],
  );
  return [...sheet, ...parts];
}

interface Row {
  method: string;
  column: MapColumn;
}
interface Found {
  method: string;
  column: MapColumn;
  cell: MapCell;
}

const near = (a: number, b: number): boolean => Math.abs(a - b) <= 1e-6 * Math.abs(b);
const limit = (seconds: number | null): string =>
  seconds === null ? "none" : seconds === 0 ? "no step" : stepText(seconds);

export class StabilityTab extends Tab<"stability"> {
  private readonly field = makeSelect([[allStiffnesses, "all stiffnesses together"]], allStiffnesses);
  private readonly from = makeNumber("÷ 100");
  private readonly to = makeNumber("× 100");
  private readonly columns = makeSelect(
    [
      ["5", "5"],
      ["9", "9"],
      ["17", "17"],
      ["33", "33"],
    ],
    "9",
  );
  private readonly picture = new Picture(
    {
      tip: (key) => this.tip(key),
      choose: (key) => this.applyCell(key),
      order: (key) => {
        const [method, column, cell] = key.split("/");
        return { curve: `${method}/${column}`, along: Number(cell) + 1 };
      },
    },
    true,
  );
  private readonly drawing = new Drawing(
    "stability",
    this.host.jobs,
    this.picture,
    "Stability map: arrow keys go from trial to trial, Enter applies one, or shows how it fails",
    (error) => this.host.problem("The map could not be drawn", error),
  );
  private readonly tableTitle = make("summary");
  private readonly table = new Table<Row>(
    "Longest stable time step",
    [
      {
        title: "Method",
        text: ({ method }) => methodText(method).name,
        order: ({ method }) => methodText(method).name,
      },
      {
        title: "Value",
        text: ({ column }) => this.valueText(column.value),
        order: ({ column }) => column.value,
        className: "number",
      },
      {
        title: "Held",
        hint: "longest step that held",
        text: ({ column }) => (column.held_s === null ? "–" : stepText(column.held_s)),
        order: ({ column }) => column.held_s,
        className: "number",
      },
      {
        title: "Failed",
        hint: "shortest longer one that failed",
        text: ({ column }) => (column.failed_s === null ? "none" : stepText(column.failed_s)),
        order: ({ column }) => column.failed_s,
        className: "number",
      },
      {
        title: "Theory",
        text: ({ column }) => limit(column.theory_s),
        order: ({ column }) => column.theory_s,
        className: "number",
      },
      {
        title: "",
        text: ({ column }) => {
          const sign = make("span", "", column.disagrees ? "≠" : "");
          sign.title = column.disagrees ? `More than 5 % apart. ${column.reason}` : "";
          return sign;
        },
      },
    ],
    null,
    ({ column }) => (column.disagrees ? "disagrees" : ""),
  );
  private result: StabilityMap | null = null;
  private offered = "";

  constructor(host: TabHost) {
    super("stability", host, {
      lead:
        "How long may a time step be before a method blows up? Measured by trial on this scene, " +
        "over one of its numbers, with theory's line beside it.",
      start: "Measure the map",
      file: "stability",
      awaits: "The map: a picture for each method, the time step over the stiffness, coloured by what the energy does.",
    });
    this.addMethods();
    this.addOptions(
      labelled("over", this.field, "the number of the scene along the map's axis"),
      labelled("from", this.from, "empty: a hundredth of what it is"),
      labelled("to", this.to, "empty: a hundred times what it is"),
      labelled("values", this.columns, "how many, evenly spaced"),
    );
    this.field.onchange = () => {
      this.from.value = this.to.value = "";
    };
    this.content.append(this.picture.element, make("details", "lab-more", this.tableTitle, this.table.element));
  }

  /// Updates the list of numbers to the scene.
  override sceneChanged(): void {
    const document = this.host.document();
    if (!document) return;
    this.showPresent(document);
    const numbers = numbersOf(document);
    const offered = JSON.stringify(numbers.map(({ path, name }) => [path, name]));
    if (offered === this.offered) return;
    this.offered = offered;
    const chosen = this.field.value;
    this.field.replaceChildren(
      new Option("all stiffnesses together", allStiffnesses),
      ...numbers.map(({ path, name }) => new Option(name, path)),
    );
    this.field.value = numbers.some(({ path }) => path === chosen) ? chosen : allStiffnesses;
  }

  protected override extent({ time_s, steps }: StabilityMap): string {
    return `At most ${Number(time_s.toPrecision(3))} s and ${steps} steps a trial`;
  }

  // Methods that iterate are meant to be stable at any step: they are measured on request only.
  protected override byDefault(method: string): boolean {
    return methodText(method).iterations === null;
  }

  protected override drawn(): string | null {
    return this.drawing.text;
  }

  protected override params(): Record<string, unknown> {
    const [from, to] = [numberIn(this.from), numberIn(this.to)];
    return {
      field: this.field.value,
      columns: Number(this.columns.value),
      ...(from === undefined ? {} : { from }),
      ...(to === undefined ? {} : { to }),
    };
  }

  protected override show(map: StabilityMap): void {
    this.result = map;
    this.drawing.want(map, "position");
    const rows = map.methods.flatMap(({ method, columns }) => columns.map((column) => ({ method, column })));
    this.tableTitle.textContent = `All boundaries as a table (${rows.length})`;
    this.table.show(rows);
    const document = this.host.document();
    if (document) this.showPresent(document);
  }

  // Marks the present setting. A factor on all stiffnesses refers to the measured scene, so it keeps its value.
  private showPresent(document: SceneDocument): void {
    if (!this.result) return;
    const { field, present } = this.result;
    const { method, dt } = document.solver;
    const value = field === allStiffnesses ? present.value : Number(valueAt(document, field));
    this.picture.showPresent({ panel: method, x: value, y: dt });
  }

  private valueText(value: number): string {
    const number = String(Number(value.toPrecision(3)));
    return this.result?.field === allStiffnesses ? `× ${number}` : `${number} ${this.result?.unit ?? ""}`.trim();
  }

  private found(key: string): Found | null {
    const [name, at, inside] = key.split("/");
    const method = this.result?.methods.find((one) => one.method === name);
    const column = method?.columns[Number(at)];
    const cell = column?.cells[Number(inside)];
    return method && column && cell ? { method: method.method, column, cell } : null;
  }

  private tip(key: string): Tip | null {
    const found = this.found(key);
    if (!found) return null;
    const { method, column, cell } = found;
    const what =
      this.result?.field === allStiffnesses ? "stiffness" : this.result?.field.split("/").at(-1)?.replaceAll("_", " ");
    return {
      title: `${methodText(method).name}, dt ${stepText(cell.dt_s)}, ${what} ${this.valueText(column.value)}`,
      lines: [
        cell.blew_up
          ? "blew up"
          : `held: energy at most ${Number((10 ** cell.growth).toPrecision(2))} times a stable run's`,
        `theory's limit: ${limit(column.theory_s)}`,
        ...(column.disagrees ? [`measured and theory disagree: ${column.reason}`] : []),
      ],
      action: this.host.mayEdit() && this.operations(found) ? (cell.blew_up ? "Show how it fails" : "Apply") : null,
    };
  }

  /// The operations that give the scene the setting of a cell. null if the cell was measured for an earlier scene and
  /// holds a factor on that scene's stiffnesses.
  private operations({ method, column, cell }: Found): Operation[] | null {
    const map = this.result as StabilityMap;
    const solver: Operation[] = [
      { op: "replace", path: "/solver/method", value: method },
      { op: "replace", path: "/solver/dt", value: cell.dt_s },
    ];
    if (near(column.value, map.present.value)) return solver;
    if (map.field !== allStiffnesses) return [...solver, { op: "replace", path: map.field, value: column.value }];
    const document = this.host.document();
    if (!document || this.host.jobs.of("stability").stale) return null;
    const scaled = document.cloths.flatMap(({ material }, i) =>
      stiffnessesOf(material).map(
        ([path, value]): Operation => ({
          op: "replace",
          path: `/cloths/${i}/material/${path}`,
          value: Number((value * column.value).toPrecision(6)),
        }),
      ),
    );
    return [...solver, ...scaled];
  }

  private applyCell(key: string): void {
    const found = this.found(key);
    const operations = found && this.operations(found);
    if (!found || !operations) return;
    const what = `${methodText(found.method).name}, dt ${stepText(found.cell.dt_s)}, ${this.valueText(found.column.value)}`;
    if (found.cell.blew_up) this.host.fail(operations, what);
    else this.host.apply(operations, what);
  }
}
