import type { CustomSeriesRenderItemAPI, CustomSeriesRenderItemParams } from "echarts";
import { axisOption, baseOption, Chart, seriesColour, symbols } from "./chart";
import { makeChartFigure } from "./chart_figure";
import type { Axis, Cell, CurvePoint, CurvesBlock, TableBlock } from "./document";
import { element } from "./dom";
import { formatShort, withUnit } from "./number_format";

/** Curves with error bars in both directions; a point names itself when the mouse is over it. */
export function makeCurves(block: CurvesBlock): HTMLElement {
  const series = block.series.map(({ name, points }) => ({
    name,
    points: points.filter((point) => isDrawn(block, point)),
  }));
  const points = series.flatMap((one) => one.points);
  const xs = points.flatMap((point) => [point.x, point.x_low, point.x_high]);
  const ys = points.flatMap((point) => [point.y, point.y_low, point.y_high]);
  const chart = new Chart(describe(block), {
    ...baseOption(describe(block)),
    xAxis: axisOption(block.x, drawable(block.x, xs), 30),
    yAxis: axisOption(block.y, drawable(block.y, ys), 48),
    series: series.flatMap((one, index) => [line(block, one, index), errorBars(block, one, index)]),
  });
  const all = block.series.reduce((sum, one) => sum + one.points.length, 0);
  return makeChartFigure(
    chart,
    series.map((one) => one.name),
    omittedText(all - points.length, block),
    dataTable(block),
  );
}

function isDrawn(block: CurvesBlock, point: CurvePoint): boolean {
  return fits(block.x, point.x) && fits(block.y, point.y);
}

function fits(axis: Axis, value: number | null | undefined): value is number {
  return typeof value === "number" && Number.isFinite(value) && (!axis.log || value > 0);
}

function drawable(axis: Axis, values: (number | null | undefined)[]): number[] {
  return values.filter((value) => fits(axis, value));
}

function omittedText(count: number, block: CurvesBlock): string | null {
  if (count === 0) return null;
  const reason =
    block.x.log || block.y.log ? "not a finite number, or not above zero on a logarithmic axis" : "not a finite number";
  return `${count === 1 ? "One point is" : `${count} points are`} not drawn: ${reason}.`;
}

function describe(block: CurvesBlock): string {
  const names = block.series.map((one) => one.name).join(", ");
  return `${block.title}: ${block.y.label} against ${block.x.label}; ${names}`;
}

function line(block: CurvesBlock, one: { name: string; points: CurvePoint[] }, index: number): object {
  const colour = seriesColour(index);
  return {
    type: "line",
    name: one.name,
    data: one.points.map((point) => [point.x, point.y]),
    symbol: symbols[index % symbols.length],
    symbolSize: 8,
    showAllSymbol: true,
    color: colour,
    lineStyle: { width: 2, type: index < 8 ? "solid" : "dashed" },
    emphasis: { disabled: true },
    tooltip: { formatter: ({ dataIndex }: { dataIndex: number }) => tooltip(block, one.name, one.points[dataIndex]!) },
  };
}

function tooltip(block: CurvesBlock, name: string, point: CurvePoint): HTMLElement[] {
  const value = (axis: Axis, at: number | null, low?: number | null, high?: number | null) => {
    const interval = typeof low === "number" && typeof high === "number" && low !== high;
    const text = withUnit(formatShort(at!), axis.unit);
    return `${axis.label}: ${text}${interval ? ` [${formatShort(low)}, ${formatShort(high)}]` : ""}`;
  };
  return [
    element("strong", {}, point.label ? `${name}, ${point.label}` : name),
    element("div", {}, value(block.x, point.x, point.x_low, point.x_high)),
    element("div", {}, value(block.y, point.y, point.y_low, point.y_high)),
  ];
}

/** Whiskers with caps. A bar that a logarithmic axis cannot hold starts at the point itself. */
function errorBars(block: CurvesBlock, one: { name: string; points: CurvePoint[] }, index: number): object {
  const cap = 3;
  const within = (axis: Axis, end: number | null | undefined, at: number) => (fits(axis, end) ? end : at);
  const barsOf = (_: CustomSeriesRenderItemParams, api: CustomSeriesRenderItemAPI) => {
    const point = one.points[api.value(2) as number]!;
    const [x, y] = [point.x!, point.y!];
    const [left, right] = [within(block.x, point.x_low, x), within(block.x, point.x_high, x)];
    const [low, high] = [within(block.y, point.y_low, y), within(block.y, point.y_high, y)];
    const [px, top] = api.coord([x, high]) as [number, number];
    const bottom = api.coord([x, low])[1]!;
    const [west, py] = api.coord([left, y]) as [number, number];
    const east = api.coord([right, y])[0]!;
    const segments = [
      ...(high > low ? [px, top, px, bottom, px - cap, top, px + cap, top, px - cap, bottom, px + cap, bottom] : []),
      ...(right > left ? [west, py, east, py, west, py - cap, west, py + cap, east, py - cap, east, py + cap] : []),
    ];
    const style = { stroke: seriesColour(index), lineWidth: 1.25, fill: "none" };
    const lines = [];
    for (let at = 0; at < segments.length; at += 4) {
      const [x1, y1, x2, y2] = segments.slice(at, at + 4);
      lines.push({ type: "line" as const, shape: { x1, y1, x2, y2 }, style });
    }
    return { type: "group" as const, children: lines };
  };
  return {
    type: "custom",
    name: one.name,
    renderItem: barsOf,
    data: one.points.map((point, at) => [point.x, point.y, at]),
    color: seriesColour(index),
    silent: true,
    clip: true,
    tooltip: { show: false },
  };
}

function dataTable(block: CurvesBlock): TableBlock {
  const measured = (value: number | null, low?: number | null, high?: number | null): Cell =>
    typeof low === "number" && typeof high === "number" && low !== high ? { value, low, high } : value;
  return {
    type: "table",
    id: `${block.id}-data`,
    title: `Data of ${block.title}`,
    columns: [
      { name: "series" },
      { name: "point" },
      { name: block.x.label, unit: block.x.unit, align: "number" },
      { name: block.y.label, unit: block.y.unit, align: "number" },
    ],
    rows: block.series.flatMap((one) =>
      one.points.map((point) => [
        one.name,
        point.label ?? "",
        measured(point.x, point.x_low, point.x_high),
        measured(point.y, point.y_low, point.y_high),
      ]),
    ),
  };
}
