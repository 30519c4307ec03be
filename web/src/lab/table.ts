// The content of a drawing as a table. A click on a column's head sorts it.
import { make, makeButton } from "./dom";

export interface Column<Row> {
  title: string;
  hint?: string;
  text(row: Row): string | Node;
  order?(row: Row): number | string | null; ///< sorts the column, null last; a column without it cannot be sorted
  className?: string;
}

export class Table<Row> {
  readonly element = make("div", "lab-table");
  private readonly body = make("tbody");
  private readonly heads: HTMLTableCellElement[] = [];
  private rows: Row[] = [];
  private descending = false;

  /// `sorted`: the column that sorts the rows at first; without it they keep their order.
  constructor(
    caption: string,
    private readonly columns: Column<Row>[],
    private sorted: number | null,
    private readonly classOf: (row: Row) => string = () => "",
  ) {
    const row = make("tr");
    columns.forEach((column, i) => row.append(this.head(column, i)));
    const table = make("table", "", make("caption", "visually-hidden", caption), make("thead", "", row), this.body);
    this.element.append(table);
  }

  show(rows: Row[]): void {
    this.rows = rows;
    this.fill();
  }

  private head(column: Column<Row>, i: number): HTMLTableCellElement {
    const cell = make("th", column.className ?? "");
    cell.scope = "col";
    cell.title = column.hint ?? "";
    if (column.order) cell.append(makeButton(column.title, "lab-sort", () => this.sortBy(i)));
    else cell.append(column.title);
    this.heads.push(cell);
    return cell;
  }

  private sortBy(i: number): void {
    this.descending = this.sorted === i && !this.descending;
    this.sorted = i;
    this.fill();
  }

  private fill(): void {
    const focused = this.body.contains(document.activeElement)
      ? document.activeElement?.getAttribute("aria-label")
      : null;
    this.heads.forEach((head, i) => {
      if (i === this.sorted) head.setAttribute("aria-sort", this.descending ? "descending" : "ascending");
      else head.removeAttribute("aria-sort");
    });
    this.body.replaceChildren(
      ...this.inOrder().map((row) => {
        const line = make("tr", this.classOf(row));
        this.columns.forEach((column, i) => {
          const cell = make(i === 0 ? "th" : "td", column.className ?? "", column.text(row));
          if (i === 0) cell.scope = "row";
          line.append(cell);
        });
        return line;
      }),
    );
    if (focused)
      this.body.querySelector<HTMLElement>(`[aria-label="${CSS.escape(focused)}"]`)?.focus({ preventScroll: true });
  }

  private inOrder(): Row[] {
    const order = this.sorted === null ? undefined : this.columns[this.sorted]?.order;
    if (!order) return this.rows;
    const sign = this.descending ? -1 : 1;
    return [...this.rows].sort((one, other) => {
      const [a, b] = [order(one), order(other)];
      if (a === null || b === null) return Number(a === null) - Number(b === null);
      return sign * (typeof a === "string" ? a.localeCompare(String(b)) : a - Number(b));
    });
  }
}
