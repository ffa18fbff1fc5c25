import type { Cell, Column, MeasuredCell, TableBlock } from "./document";
import { element, hiddenText } from "./dom";
import { formatAlike, formatNumber } from "./number_format";

const defaultDigits = 3;
/** Tables longer than this get a field that filters their rows. */
const filterFrom = 25;
/** More distinct notes than this are not listed below their table. */
const mostListedNotes = 8;

interface Row {
  cells: Cell[];
  node: HTMLTableRowElement;
}

/** A table whose header buttons sort it, and whose cells' notes are listed below it. */
export function makeTable(block: TableBlock): HTMLElement {
  const notes = new Notes(block.rows);
  const rows: Row[] = block.rows.map((cells) => ({ cells, node: makeRow(block.columns, cells, notes) }));
  const body = element("tbody", {}, ...rows.map((row) => row.node));
  const headers = block.columns.map((column, index) => makeHeader(column, () => sortBy(index)));

  function sortBy(index: number): void {
    const header = headers[index]!;
    const direction = header.getAttribute("aria-sort") === "ascending" ? "descending" : "ascending";
    headers.forEach((other) => other.removeAttribute("aria-sort"));
    header.setAttribute("aria-sort", direction);
    const sorted = rows
      .slice()
      .sort((a, b) => compare(a.cells[index] ?? null, b.cells[index] ?? null, direction === "ascending" ? 1 : -1));
    body.append(...sorted.map((row) => row.node));
  }

  const table = element(
    "table",
    {},
    element("caption", { class: "visually-hidden" }, block.title),
    element("thead", {}, element("tr", {}, ...headers)),
    body,
  );
  // Wide tables scroll inside a region that the keyboard can reach.
  const region = element(
    "div",
    { class: "table-scroll", role: "region", "aria-label": block.title, tabindex: 0 },
    table,
  );
  const filter = rows.length > filterFrom && makeFilter(block.title, rows);
  return element("div", { class: "table" }, filter, region, notes.list());
}

function makeHeader(column: Column, sort: () => void): HTMLTableCellElement {
  const button = element(
    "button",
    { type: "button" },
    column.name,
    column.unit ? element("span", { class: "unit" }, ` [${column.unit}]`) : null,
  );
  button.addEventListener("click", sort);
  return element("th", { scope: "col", class: column.align === "number" ? "number" : "text" }, button);
}

function makeRow(columns: Column[], cells: Cell[], notes: Notes): HTMLTableRowElement {
  const nodes = columns.map((column, index) => {
    const content = cellContent(cells[index] ?? null, column, notes);
    if (index === 0 && column.align !== "number") return element("th", { scope: "row", class: "text" }, ...content);
    return element("td", { class: column.align === "number" ? "number" : textClass(cells[index]) }, ...content);
  });
  return element("tr", {}, ...nodes);
}

/** A few words stay on one line. */
function textClass(cell: Cell | undefined): string {
  return typeof cell === "string" && cell.length <= 40 ? "text short" : "text";
}

function cellContent(cell: Cell, column: Column, notes: Notes): (Node | string)[] {
  if (!isMeasured(cell)) return [plainContent(cell, column)];
  const content: (Node | string)[] = [plainContent(cell.value, column)];
  if (typeof cell.low === "number" && typeof cell.high === "number") {
    const model = typeof cell.value === "number" ? cell.value : cell.low;
    const ends = [cell.low, cell.high].map((end) => formatAlike(end, model, column.digits ?? defaultDigits));
    const interval = `[${ends.join(", ")}]`;
    content.push(" ", element("small", { class: "interval", title: "95 % interval" }, interval));
  }
  if (cell.note) content.push(notes.mark(cell.note));
  return content;
}

function plainContent(value: string | number | null, column: Column): string {
  return typeof value === "string" ? value : formatNumber(value, column.digits ?? defaultDigits);
}

function isMeasured(cell: Cell): cell is MeasuredCell {
  return typeof cell === "object" && cell !== null;
}

function makeFilter(title: string, rows: Row[]): HTMLElement {
  const input = element("input", {
    type: "search",
    placeholder: "Filter rows",
    "aria-label": `Filter the rows of ${title}`,
  });
  const count = element("span", { class: "count", role: "status" }, `${rows.length} rows`);
  const texts = rows.map((row) => row.node.textContent!.toLowerCase());
  input.addEventListener("input", () => {
    const words = input.value.toLowerCase().split(/\s+/);
    let shown = 0;
    rows.forEach((row, index) => {
      const fits = words.every((word) => texts[index]!.includes(word));
      row.node.hidden = !fits;
      shown += Number(fits);
    });
    count.textContent = shown === rows.length ? `${shown} rows` : `${shown} of ${rows.length} rows`;
  });
  return element("div", { class: "table-filter" }, input, count);
}

/**
 * The distinct notes of a table's cells. A few are numbered and listed below the table; where nearly every cell has one of
 * its own, the pointer shows them and screen readers say them.
 */
class Notes {
  private readonly texts: string[];
  private readonly listed: boolean;

  constructor(rows: Cell[][]) {
    const notes = rows.flat().map((cell) => (isMeasured(cell) && cell.note) || null);
    this.texts = [...new Set(notes.filter((note) => note !== null))];
    this.listed = this.texts.length <= mostListedNotes;
  }

  mark(text: string): HTMLElement {
    const sign = this.listed ? String(this.texts.indexOf(text) + 1) : "…";
    return element("sup", { class: "note-mark", title: text }, sign, hiddenText(` (${text})`));
  }

  list(): HTMLElement | null {
    if (!this.listed || this.texts.length === 0) return null;
    return element("ol", { class: "notes" }, ...this.texts.map((text) => element("li", {}, text)));
  }
}

/** Numbers by value, text by the alphabet with its numbers by value; cells that hold nothing come last either way. */
function compare(a: Cell, b: Cell, sign: number): number {
  const left = isMeasured(a) ? a.value : a;
  const right = isMeasured(b) ? b.value : b;
  if (left === null || right === null) return Number(left === null) - Number(right === null);
  if (typeof left === "number" && typeof right === "number") return sign * (left - right);
  return sign * String(left).localeCompare(String(right), "en", { numeric: true });
}
