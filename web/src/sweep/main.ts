// The page of a sweep: any two columns of its table against each other, coloured by an axis.
import { followSystemTheme } from "../system_theme";
import { brief, type Scale, scaleOf, type Value } from "./scale";

interface Table {
  sweep: string;
  axes: string[];
  columns: string[];
  points: number;
  missing: number;
  rows: Value[][];
  pictures: string[]; // files beside the page
}

const table = JSON.parse(document.getElementById("data")?.textContent ?? "") as Table;
const part = (id: string): HTMLElement => document.getElementById(id) as HTMLElement;
const plot = document.getElementById("plot") as unknown as SVGSVGElement;
const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6bb1", "#7f7f7f"];
const box = { left: 92, top: 16, right: 884, bottom: 456 };
const [least, most] = [340, 900]; // width of the plot [px]
const everything = "all";
const nothing = "nothing";
const hint = "Point at a mark, or move to it with Tab, to read all that is known about it.";

const columns = new Map(table.columns.map((name, i) => [name, i]));
const cell = (row: Value[], name: string): Value => row[columns.get(name) ?? -1] ?? null;
const inWords = (value: Value): string => (typeof value === "number" ? brief(value) : String(value));
const isNumber = (name: string): boolean =>
  table.rows.some((row) => typeof cell(row, name) === "number") &&
  table.rows.every((row) => ["number", "object"].includes(typeof cell(row, name)));
const above0 = (name: string): boolean =>
  table.rows.every((row) => cell(row, name) === null || Number(cell(row, name)) > 0);
/// Columns worth a plot: numbers, and words that are not all the same.
const drawable = table.columns.filter(
  (name) => isNumber(name) || (name !== "id" && new Set(table.rows.map((row) => cell(row, name))).size > 1),
);

function element<K extends keyof HTMLElementTagNameMap>(
  name: K,
  text = "",
  attributes: Record<string, string> = {},
): HTMLElementTagNameMap[K] {
  const made = document.createElement(name);
  made.textContent = text;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

function svg(name: string, attributes: Record<string, string | number>, text = ""): SVGElement {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  made.textContent = text;
  return made;
}

const selects = new Map<string, HTMLSelectElement>();
const checks = new Map<string, HTMLInputElement>();
const chosen = (key: string): string => selects.get(key)?.value ?? "";
const isLog = (key: string): boolean =>
  (checks.get(key)?.checked ?? false) && isNumber(chosen(key)) && above0(chosen(key));

function choice(key: string, label: string, options: string[], first: string): void {
  const select = element("select", "", { name: key });
  for (const option of options) select.append(element("option", option, { value: option }));
  select.value = first;
  const around = element("label", label);
  around.append(select);
  part("choices").append(around);
  selects.set(key, select);
}

function check(key: string, label: string): void {
  const input = element("input", "", { type: "checkbox", name: `log ${key}` });
  input.checked = true;
  const around = element("label", "", { class: "check" });
  around.append(input, label);
  part("choices").append(around);
  checks.set(key, input);
}

/// The rows that the filters leave and that have both values.
function shown(): Value[][] {
  return table.rows.filter(
    (row) =>
      cell(row, chosen("x")) !== null &&
      cell(row, chosen("y")) !== null &&
      table.axes.every((axis) => {
        const only = selects.get(`only ${axis}`)?.value ?? everything;
        return only === everything || only === inWords(cell(row, axis));
      }),
  );
}

function describe(row: Value[]): string {
  return table.columns
    .filter((name) => cell(row, name) !== null && name !== "id")
    .map((name) => `${name} ${inWords(cell(row, name))}`)
    .join(", ");
}

function drawAxes(x: Scale, y: Scale): void {
  const { left, top, right, bottom } = box;
  for (const { at, label } of x.ticks) {
    plot.append(svg("line", { class: "grid", x1: at, x2: at, y1: top, y2: bottom }));
    plot.append(svg("text", { x: at, y: bottom + 20, "text-anchor": "middle" }, label));
  }
  for (const { at, label } of y.ticks) {
    plot.append(svg("line", { class: "grid", x1: left, x2: right, y1: at, y2: at }));
    plot.append(svg("text", { x: left - 8, y: at + 5, "text-anchor": "end" }, label));
  }
  plot.append(svg("rect", { class: "frame", x: left, y: top, width: right - left, height: bottom - top }));
  const middle = (top + bottom) / 2,
    name = { class: "axis", "text-anchor": "middle" };
  plot.append(svg("text", { ...name, x: (left + right) / 2, y: 506 }, chosen("x")));
  plot.append(svg("text", { ...name, x: 20, y: middle, transform: `rotate(-90 20 ${middle})` }, chosen("y")));
}

interface Mark {
  row: Value[];
  x: number;
  y: number;
}

/// Joins the marks that differ only in the value of one axis.
function drawLines(marks: Mark[], colour: string): void {
  if (chosen("along") === nothing) return;
  const others = table.axes.filter((axis) => axis !== chosen("along"));
  const lines = new Map<string, string[]>();
  for (const { row, x, y } of marks) {
    const line = JSON.stringify(others.map((axis) => cell(row, axis)));
    lines.set(line, lines.get(line) ?? []);
    lines.get(line)?.push(`${x.toFixed(1)} ${y.toFixed(1)}`);
  }
  for (const line of lines.values()) plot.append(svg("path", { d: `M${line.join("L")}`, stroke: colour }));
}

function drawMark({ row, x, y }: Mark, colour: string): void {
  const at = { class: "point", cx: x, cy: y, r: 6, fill: colour };
  const mark = svg("circle", { ...at, tabindex: 0, role: "button", "aria-label": describe(row) });
  const pick = (): void => {
    for (const other of plot.querySelectorAll(".picked")) other.classList.remove("picked");
    mark.classList.add("picked");
    part("picked").textContent = describe(row);
  };
  mark.addEventListener("pointerenter", pick);
  mark.addEventListener("focus", pick);
  plot.append(mark);
}

function draw(): void {
  const width = Math.min(Math.max(plot.clientWidth, least), most);
  box.right = width - 16;
  plot.setAttribute("viewBox", `0 0 ${width} 520`);
  plot.replaceChildren();
  part("legend").replaceChildren();
  part("picked").textContent = hint;
  const [x, y, by] = [chosen("x"), chosen("y"), chosen("colour")];
  const rows = shown();
  part("caption").textContent =
    `${y} against ${x}: ${rows.length} of ${table.rows.length} points` +
    (rows.length < table.rows.length ? "; the others lack one of the two, or are filtered out" : "");
  if (rows.length === 0) return;
  const all = (name: string) => rows.map((row) => cell(row, name) as number | string);
  const across = scaleOf(all(x), box.left, box.right, isLog("x")),
    up = scaleOf(all(y), box.bottom, box.top, isLog("y"));
  drawAxes(across, up);

  const groups = new Map<string, Mark[]>();
  for (const row of rows) {
    const group = by === nothing ? "" : inWords(cell(row, by));
    const place = (scale: Scale, name: string): number => scale.place(cell(row, name) as number | string);
    const mark = { row, x: place(across, x), y: place(up, y) };
    groups.set(group, groups.get(group) ?? []);
    groups.get(group)?.push(mark);
  }
  [...groups].forEach(([group, marks], i) => {
    const colour = colours[i % colours.length] ?? "";
    drawLines(marks, colour);
    for (const mark of marks) drawMark(mark, colour);
    if (by === nothing) return;
    const entry = element("li");
    entry.append(element("span", "", { style: `background: ${colour}` }), `${by} ${group}`);
    part("legend").append(entry);
  });
}

function fillTable(): void {
  const all = element("table"),
    head = element("tr");
  for (const name of table.columns) head.append(element("th", name, { scope: "col" }));
  all.append(head);
  for (const row of table.rows) {
    const line = element("tr");
    for (const value of row) line.append(element("td", value === null ? "" : inWords(value)));
    all.append(line);
  }
  part("table").append(all);
}

part("name").textContent = table.sweep;
part("about").textContent =
  `${table.rows.length} of ${table.points} points measured` +
  (table.missing > 0 ? `; ${table.missing} are missing` : "");
part("pictures").append(
  ...(table.pictures.length > 0 ? ["Pictures: "] : []),
  ...table.pictures.flatMap((name, i) => [i > 0 ? ", " : "", element("a", name, { href: name })]),
);
const prefer = (...names: string[]): string => names.find((name) => drawable.includes(name)) ?? drawable[0] ?? "";
const numbers = table.axes.filter(isNumber);
choice("x", "Across", drawable, prefer("error_position_over_size", ...numbers.slice(-1)));
choice("y", "Up", drawable, prefer("cost_median_ms_per_simulated_s", "largest_strain"));
choice("colour", "Colour", [nothing, ...table.axes], table.axes.find((axis) => !isNumber(axis)) ?? nothing);
choice("along", "Lines along", [nothing, ...table.axes], table.axes.at(-1) ?? nothing);
for (const axis of table.axes) {
  const values = [...new Set(table.rows.map((row) => inWords(cell(row, axis))))];
  if (values.length > 1 && values.length <= 100)
    choice(`only ${axis}`, `Only ${axis}`, [everything, ...values], everything);
}
check("x", "Logarithmic across");
check("y", "Logarithmic up");
part("choices").addEventListener("change", draw);
addEventListener("resize", draw);
part("rows").addEventListener("toggle", fillTable, { once: true });
followSystemTheme(draw);
