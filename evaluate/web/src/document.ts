// What the C++ program writes into the page as JSON (evaluate/report_document.h), member by member.

export interface ReportDocument {
  title: string;
  verdict: string[];
  facts: { name: string; value: string }[];
  sections: Section[];
  scene: SceneData | null;
}

export interface Section {
  id: string;
  title: string;
  text: string[];
  blocks: Block[];
}

export type Block = TableBlock | CurvesBlock | HistogramBlock | PictureBlock | ViewerBlock;

export interface TableBlock {
  type: "table";
  id: string;
  title: string;
  note?: string;
  columns: Column[];
  rows: Cell[][];
}

export interface Column {
  name: string;
  unit?: string;
  align?: "text" | "number";
  digits?: number;
}

export interface MeasuredCell {
  value: number | string | null;
  low?: number | null;
  high?: number | null;
  note?: string;
}

export type Cell = string | number | null | MeasuredCell;

export interface Axis {
  label: string;
  unit?: string;
  log?: boolean;
}

export interface CurvePoint {
  x: number | null;
  y: number | null;
  x_low?: number | null;
  x_high?: number | null;
  y_low?: number | null;
  y_high?: number | null;
  label?: string;
}

export interface CurvesBlock {
  type: "curves";
  id: string;
  title: string;
  note?: string;
  x: Axis;
  y: Axis;
  series: { name: string; points: CurvePoint[] }[];
}

export interface HistogramBlock {
  type: "histogram";
  id: string;
  title: string;
  note?: string;
  x: Axis;
  series: { name: string; edges: number[]; counts: number[] }[];
}

export interface PictureBlock {
  type: "picture";
  id: string;
  title: string;
  alt: string;
  src: string;
}

export interface ViewerBlock {
  type: "viewer";
  id: string;
  title: string;
}

/** [count x 3] positions as unsigned 16-bit integers that run from `low` to `high` [m]. */
export interface Positions {
  blob: string;
  low: [number, number, number];
  high: [number, number, number];
  count: number;
}

/** [count] numbers as unsigned 16-bit integers that run from `low` to `high`. */
export interface Scalars {
  blob: string;
  low: number;
  high: number;
  count: number;
}

export type ColourMapName = "stretch" | "sequential" | "diverging";

export interface Field {
  key: string;
  name: string;
  unit?: string;
  low: number;
  high: number;
  map: ColourMapName;
}

export interface View {
  key: string;
  name: string;
}

export interface ClothView {
  position: Positions;
  fields?: Record<string, Scalars>;
}

export interface Sample {
  id: number;
  split: string;
  error_mm?: Record<string, number | null>;
  body?: Positions | null;
  cloth: Record<string, ClothView>;
  image?: { name: string; src: string }[];
}

export interface SceneData {
  triangle: string;
  body_triangle?: string | null;
  views: View[];
  fields: Field[];
  samples: Sample[];
  vertex_fields?: Record<string, Scalars>;
}
