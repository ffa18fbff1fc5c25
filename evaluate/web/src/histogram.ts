import type { CustomSeriesRenderItemAPI, CustomSeriesRenderItemParams } from "echarts";
import { axisOption, baseOption, Chart, seriesColour } from "./chart";
import { makeChartFigure } from "./chart_figure";
import type { HistogramBlock, TableBlock } from "./document";
import { element } from "./dom";
import { formatShort, withUnit } from "./number_format";

interface Bin {
  low: number;
  high: number;
  count: number;
}

/** Histograms over each other, bars as wide as their bins, translucent where there are several series. */
export function makeHistogram(block: HistogramBlock): HTMLElement {
  const series = block.series.map(({ name, edges, counts }) => ({ name, bins: toBins(edges, counts, block.x.log) }));
  const edges = series.flatMap((one) => one.bins.flatMap((bin) => [bin.low, bin.high]));
  const label = `${block.title}: how often ${block.x.label} takes which value; ${series.map((one) => one.name).join(", ")}`;
  const chart = new Chart(label, {
    ...baseOption(label),
    xAxis: { ...axisOption(block.x, edges, 30), splitLine: { show: false } },
    yAxis: { ...axisOption({ label: "count" }, [], 48), min: 0, minInterval: 1 },
    series: series.map((one, index) => bars(block, one, index, series.length > 1)),
  });
  const omitted =
    block.series.reduce((sum, one) => sum + one.counts.length, 0) -
    series.reduce((sum, one) => sum + one.bins.length, 0);
  return makeChartFigure(
    chart,
    series.map((one) => one.name),
    omitted > 0 ? "Bins that begin at zero or below are not drawn on the logarithmic axis." : null,
    dataTable(block),
  );
}

function toBins(edges: number[], counts: number[], log?: boolean): Bin[] {
  return counts
    .map((count, index) => ({ low: edges[index]!, high: edges[index + 1]!, count }))
    .filter((bin) => !log || bin.low > 0);
}

function bars(block: HistogramBlock, one: { name: string; bins: Bin[] }, index: number, translucent: boolean): object {
  const total = one.bins.reduce((sum, bin) => sum + bin.count, 0);
  const colour = seriesColour(index);
  return {
    type: "custom",
    name: one.name,
    color: colour,
    data: one.bins.map((bin, at) => [bin.low, bin.count, at]),
    renderItem: (_: CustomSeriesRenderItemParams, api: CustomSeriesRenderItemAPI) => {
      const bin = one.bins[api.value(2) as number]!;
      const [left, top] = api.coord([bin.low, bin.count]) as [number, number];
      const [right, bottom] = api.coord([bin.high, 0]) as [number, number];
      return {
        type: "rect" as const,
        shape: { x: left, y: top, width: Math.max(right - left, 1), height: bottom - top },
        style: {
          fill: colour,
          fillOpacity: translucent ? 0.35 : 0.8,
          stroke: colour,
          lineWidth: bin.count > 0 ? 1 : 0,
        },
      };
    },
    tooltip: {
      formatter: ({ dataIndex }: { dataIndex: number }) => {
        const bin = one.bins[dataIndex]!;
        const range = `${formatShort(bin.low)} to ${withUnit(formatShort(bin.high), block.x.unit)}`;
        const share = formatShort((100 * bin.count) / Math.max(total, 1), 3);
        return [
          element("strong", {}, one.name),
          element("div", {}, range),
          element("div", {}, `${bin.count} (${share} %)`),
        ];
      },
    },
  };
}

function dataTable(block: HistogramBlock): TableBlock {
  return {
    type: "table",
    id: `${block.id}-data`,
    title: `Data of ${block.title}`,
    columns: [
      { name: "series" },
      { name: "from", unit: block.x.unit, align: "number" },
      { name: "to", unit: block.x.unit, align: "number" },
      { name: "count", align: "number" },
    ],
    rows: block.series.flatMap((one) =>
      one.counts.map((count, index) => [one.name, one.edges[index]!, one.edges[index + 1]!, count]),
    ),
  };
}
