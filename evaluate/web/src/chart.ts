import { CustomChart, LineChart } from "echarts/charts";
import { AriaComponent, GridComponent, LegendComponent, TooltipComponent } from "echarts/components";
import { type EChartsCoreOption, type EChartsType, init, use } from "echarts/core";
import { SVGRenderer } from "echarts/renderers";
import type { Axis } from "./document";
import { element } from "./dom";
import { logRange } from "./log_axis";
import { formatShort, formatTick } from "./number_format";

use([LineChart, CustomChart, GridComponent, TooltipComponent, LegendComponent, AriaComponent, SVGRenderer]);

const printWidth = 680;
const height = 380;

/** Colours are the style sheet's variables: charts, drawn as SVG, follow light, dark and print by themselves. */
export const palette = [1, 2, 3, 4, 5, 6, 7, 8].map((index) => `var(--series-${index})`);
export const symbols = ["circle", "rect", "triangle", "diamond"];

export function seriesColour(index: number): string {
  return palette[index % palette.length]!;
}

/** What every chart shares: margins, fonts, tooltip, no animation. */
export function baseOption(description: string): EChartsCoreOption {
  return {
    animation: false,
    aria: { enabled: true, label: { description } },
    textStyle: { fontFamily: "inherit" },
    legend: { show: false },
    grid: { left: 16, right: 24, top: 16, bottom: 16, outerBoundsMode: "same", outerBoundsContain: "all" },
    tooltip: {
      trigger: "item",
      confine: true,
      transitionDuration: 0,
      backgroundColor: "var(--raised)",
      borderColor: "var(--line)",
      textStyle: { color: "var(--ink)", fontSize: 13 },
    },
  };
}

export function axisOption(axis: Axis, values: number[], nameGap: number): object {
  const range = axis.log ? logRange(values) : null;
  return {
    type: axis.log ? "log" : "value",
    name: axis.unit ? `${axis.label} [${axis.unit}]` : axis.label,
    nameLocation: "middle",
    nameGap,
    nameTextStyle: { color: "var(--ink)", fontSize: 13 },
    scale: true,
    ...(range && { min: range.min, max: range.max }),
    axisLine: { show: true, lineStyle: { color: "var(--muted)" } },
    axisTick: { show: true, lineStyle: { color: "var(--muted)" }, ...(range && { customValues: range.ticks }) },
    axisLabel: {
      color: "var(--muted)",
      hideOverlap: true,
      formatter: (value: number) => (axis.log ? formatTick(value) : formatShort(value, 6)),
      ...(range && { customValues: range.ticks }),
    },
    splitLine: { show: true, lineStyle: { color: "var(--line)" } },
  };
}

/** A chart that is drawn when it is first seen or printed, and that fills its width. */
export class Chart {
  readonly node: HTMLElement;
  private chart: EChartsType | null = null;

  constructor(
    label: string,
    private readonly option: EChartsCoreOption,
  ) {
    this.node = element("div", { class: "chart", role: "img", "aria-label": label });
    this.node.style.height = `${height}px`;
    new ResizeObserver(([entry]) => {
      const width = entry!.contentRect.width;
      if (width > 0 && !printing) this.draw(width);
    }).observe(this.node);
    charts.add(this);
  }

  draw(width: number): void {
    if (this.chart) {
      this.chart.resize({ width, height });
      this.chart.getZr().flush(); // paper does not wait for the next frame
      return;
    }
    this.chart = init(this.node, null, { renderer: "svg", width, height });
    this.chart.setOption(this.option);
    this.chart.getZr().flush();
  }

  setVisible(name: string, visible: boolean): void {
    this.chart?.dispatchAction({ type: visible ? "legendSelect" : "legendUnSelect", name });
  }
}

const charts = new Set<Chart>();
let printing = false;

// Paper has its own width, which the page learns of too late to draw for: charts take a fixed one that fits A4 and Letter.
window.addEventListener("beforeprint", () => {
  printing = true;
  charts.forEach((chart) => chart.draw(printWidth));
});
window.addEventListener("afterprint", () => {
  printing = false;
  charts.forEach((chart) => chart.node.clientWidth > 0 && chart.draw(chart.node.clientWidth));
});
