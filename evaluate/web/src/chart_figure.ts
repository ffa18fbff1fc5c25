import { type Chart, seriesColour } from "./chart";
import type { TableBlock } from "./document";
import { element } from "./dom";
import { makeTable } from "./table";

/** A chart with its legend, whose buttons hide and show series, and with its numbers as a table to unfold. */
export function makeChartFigure(
  chart: Chart,
  seriesNames: string[],
  omitted: string | null,
  data: TableBlock,
): HTMLElement {
  return element(
    "div",
    { class: "chart-figure" },
    seriesNames.length > 1 && makeLegend(chart, seriesNames),
    chart.node,
    omitted && element("p", { class: "remark" }, omitted),
    makeDataTable(data),
  );
}

function makeLegend(chart: Chart, names: string[]): HTMLElement {
  const buttons = names.map((name, index) => {
    const swatch = element("span", { class: "swatch", "aria-hidden": "true" });
    swatch.style.background = seriesColour(index);
    const button = element("button", { type: "button", "aria-pressed": "true" }, swatch, name);
    button.addEventListener("click", () => {
      const visible = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(visible));
      chart.setVisible(name, visible);
    });
    return button;
  });
  return element("div", { class: "legend", role: "group", "aria-label": "Series" }, ...buttons);
}

// Made when it is unfolded: a report has many charts, and few of their tables are read.
function makeDataTable(data: TableBlock): HTMLElement {
  const details = element("details", { class: "data" }, element("summary", {}, "Data as a table"));
  details.addEventListener("toggle", () => details.append(makeTable(data)), { once: true });
  return details;
}
