// A report as the C++ program writes it, from made-up numbers and cloth: the same for the same arguments.
import { deflateSync } from "node:zlib";

/** A small repeatable generator of numbers in [0, 1) (mulberry32). */
function seededRandom(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** Blobs by number, as the page finds them. */
class Blobs {
  scripts = [];

  add(typedArray) {
    const id = `blob-${this.scripts.length}`;
    const packed = deflateSync(Buffer.from(typedArray.buffer)).toString("base64");
    this.scripts.push(`<script type="application/octet-stream" id="${id}">${packed}</script>`);
    return id;
  }

  scalars(values) {
    const low = Math.min(...values);
    const high = Math.max(...values);
    const whole = Uint16Array.from(values, (value) => (high > low ? (65535 * (value - low)) / (high - low) : 0));
    return { blob: this.add(whole), low, high, count: values.length };
  }

  positions(points) {
    const low = [0, 1, 2].map((axis) => Math.min(...points.map((point) => point[axis])));
    const high = [0, 1, 2].map((axis) => Math.max(...points.map((point) => point[axis])));
    const whole = Uint16Array.from(points.flat(), (value, index) => {
      const axis = index % 3;
      return (65535 * (value - low[axis])) / (high[axis] - low[axis]);
    });
    return { blob: this.add(whole), low, high, count: points.length };
  }
}

/** An open tube about the y axis: [rings x around] points and triangles, with folds and noise for cloth. */
function makeTube({ rings, around, radius, height, folds = 0, noise = 0, random = Math.random }) {
  const points = [];
  for (let ring = 0; ring < rings; ++ring) {
    for (let step = 0; step < around; ++step) {
      const angle = (2 * Math.PI * step) / around;
      const down = ring / (rings - 1);
      const r = radius * (1 + 0.35 * down * folds * Math.cos(7 * angle) + 0.25 * down) + noise * (random() - 0.5);
      points.push([r * Math.cos(angle), 1.35 - height * down, 0.6 * r * Math.sin(angle)]);
    }
  }
  const triangles = [];
  for (let ring = 0; ring + 1 < rings; ++ring) {
    for (let step = 0; step < around; ++step) {
      const a = ring * around + step;
      const b = ring * around + ((step + 1) % around);
      triangles.push(a, b, a + around, b, b + around, a + around);
    }
  }
  return { points, triangles: Int32Array.from(triangles) };
}

const views = [
  { key: "target", name: "ground truth" },
  { key: "predicted", name: "prediction (ridge)" },
  { key: "inextensibility", name: "inextensibility" },
  { key: "quasistatic", name: "quasistatic, μ = 0.1" },
];

const fields = [
  { key: "stretch", name: "stretch", unit: "", low: 0.75, high: 1.25, map: "stretch" },
  { key: "distance", name: "distance to ground truth", unit: "mm", low: 0, high: 40, map: "sequential" },
  { key: "strain", name: "strain", unit: "", low: -0.2, high: 0.2, map: "diverging" },
  { key: "mu", name: "μ", unit: "", low: 0.01, high: 1, map: "sequential" },
];

/** Four red, green, blue and white pixels: enough for a picture. */
const picture =
  "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFklEQVR4nGP4z8DwHwyBBBgzMPwHAEKJBfxVi3DzAAAAAElFTkSuQmCC";

function makeScene(blobs, embedded, random) {
  const shape = { rings: 40, around: 64, radius: 0.2, height: 0.62 };
  const body = makeTube({ rings: 30, around: 48, radius: 0.15, height: 0.95 });
  const triangle = blobs.add(makeTube(shape).triangles);
  const bodyTriangle = blobs.add(body.triangles);
  const samples = [];
  for (let sample = 0; sample < embedded; ++sample) {
    const cloth = {};
    const error = {};
    const count = shape.rings * shape.around;
    for (const [index, view] of views.entries()) {
      const noise = [0, 0.012, 0.005, 0.003][index];
      const folds = 0.3 + 0.05 * sample + 0.05 * index;
      error[view.key] = index === 0 ? 0 : 5 + sample + 2 * (3 - index);
      cloth[view.key] = {
        position: blobs.positions(makeTube({ ...shape, folds, noise, random }).points),
        fields: {
          stretch: blobs.scalars(Float64Array.from({ length: count }, (_, v) => 1 + 0.3 * Math.sin((v % 64) / 10))),
          distance: blobs.scalars(Float64Array.from({ length: count }, (_, v) => (40 * v) / count)),
          strain: blobs.scalars(Float64Array.from({ length: count }, (_, v) => 0.2 * Math.cos(v / 300))),
        },
      };
    }
    samples.push({
      id: 1000 - 7 * sample,
      split: ["test", "validation", "train"][sample % 3],
      error_mm: error,
      body: blobs.positions(body.points),
      cloth,
      image: [
        { name: "displacement, front", src: picture },
        { name: "displacement, back", src: picture },
      ],
    });
  }
  const mu = blobs.scalars(Float64Array.from({ length: shape.rings * shape.around }, (_, v) => 0.01 + (v % 64) / 65));
  return { triangle, body_triangle: bodyTriangle, views, fields, samples, vertex_fields: { mu } };
}

/** A name as nobody should choose it. */
export const hostileName = `</script><img src=x onerror="document.title='broken'"> & "quoted"`;

function accuracySection(rows, random) {
  const columns = [
    { name: "split", align: "text" },
    { name: "method", align: "text" },
    { name: "sqrt MSE", unit: "mm", align: "number", digits: 2 },
    { name: "largest distance", unit: "mm", align: "number", digits: 1 },
    { name: "overstretched edges", unit: "%", align: "number", digits: 2 },
  ];
  const methods = ["predicted", "inextensibility@limit=0", "quasistatic@mu=0.1", hostileName];
  const summary = ["train", "validation", "test"].flatMap((split, s) =>
    methods.map((method, m) => {
      const value = 9 - m + 2 * s;
      const note = m === 2 ? "differs from the prediction by less than the simulator's noise" : undefined;
      return [split, method, { value, low: value - 0.4, high: value + 0.5, note }, 40 - 3 * m, m === 3 ? null : 0.004];
    }),
  );
  const perSample = Array.from({ length: rows }, (_, id) => [
    String(id),
    methods[id % 3],
    20 * random() ** 2,
    90 * random(),
    id % 50 === 0 ? null : 5 * random(),
  ]);
  const edges = Array.from({ length: 31 }, (_, index) => index / 1.5);
  const counts = (shift) =>
    edges.slice(1).map((edge) => Math.round((rows / 8) * Math.exp(-(((edge - 6 - shift) / 3) ** 2))));
  return {
    id: "accuracy",
    title: "Accuracy",
    text: [
      "Distances to the ground truth in each split, before and after each prior. Intervals are 95 % over samples.",
    ],
    blocks: [
      {
        type: "table",
        id: "accuracy-table",
        title: "Errors by split",
        note: "Click a header to sort.",
        columns,
        rows: summary,
      },
      {
        type: "histogram",
        id: "accuracy-histogram",
        title: "Errors over samples",
        x: { label: "sqrt MSE", unit: "mm", log: false },
        series: [
          { name: "predicted", edges, counts: counts(2) },
          { name: "quasistatic@mu=0.1", edges, counts: counts(0) },
        ],
      },
      {
        type: "table",
        id: "sample-table",
        title: "Every sample",
        columns: [{ name: "sample", align: "text" }, ...columns.slice(1)],
        rows: perSample,
      },
      { type: "picture", id: "picture", title: "A picture", alt: "four pixels", src: picture },
    ],
  };
}

function runtimeSection(random) {
  const series = ["inextensibility", "quasistatic", "position-based", "implicit", "xpbd", "bullet", hostileName].map(
    (name, index) => ({
      name,
      points: Array.from({ length: 8 }, (_, step) => {
        const x = 1e-3 * 3 ** index * 2 ** step;
        const y = 30 * 10 ** (-step * (1 - 0.1 * index)) * (0.8 + 0.4 * random());
        return {
          x,
          y,
          x_low: 0.9 * x,
          x_high: 1.2 * x,
          y_low: 0.7 * y,
          y_high: 1.4 * y,
          label: `tolerance 1e-${step}`,
        };
      }),
    }),
  );
  series[0].points.push({ x: 0, y: null, label: "nothing to draw" });
  return {
    id: "runtime",
    title: "Run time",
    text: ["Error against seconds per sample, all methods in one run."],
    blocks: [
      {
        type: "curves",
        id: "runtime-curves",
        title: "Error against time",
        note: "Bars are quartiles of the repetitions.",
        x: { label: "time", unit: "s", log: true },
        y: { label: "error", unit: "mm", log: true },
        series,
      },
      {
        type: "curves",
        id: "narrow-curves",
        title: "Cost against size",
        x: { label: "vertices", unit: "", log: true },
        y: { label: "time", unit: "s", log: false },
        series: [{ name: "quasistatic", points: [1000, 3000, 8000].map((x) => ({ x, y: x / 4e4, label: "" })) }],
      },
    ],
  };
}

/** The data of a report with `rows` samples' figures, of which `embedded` can be seen in 3D (0: no scene), and its blobs. */
export function makeReport({ rows = 1000, embedded = 12, seed = 1 } = {}) {
  const random = seededRandom(seed);
  const blobs = new Blobs();
  const data = {
    title: "T-shirt, 1,000 poses: evaluation",
    verdict: [
      "On the test split the prediction is off by 11.0 mm; quasistatic@mu=0.1 brings it to 9.0 mm.",
      "Inextensibility removes every overstretched edge and moves the error by less than the simulator's noise.",
      "The fastest prior at 1e-4 takes 18 ms a sample.",
      "All stability cases pass.",
    ],
    facts: [
      { name: "data set", value: "out/quick/dataset.h5" },
      { name: "samples", value: `${rows}` },
      { name: "vertices", value: "2,560" },
      { name: "program", value: "toile 0.1.0" },
      { name: "command", value: `toile report ${hostileName}` },
    ],
    sections: [
      {
        id: "look",
        title: "Look",
        text: ["Drag to turn; all views turn together."],
        blocks: [{ type: "viewer", id: "viewer", title: "Samples in 3D" }],
      },
      accuracySection(rows, random),
      runtimeSection(random),
    ],
    scene: embedded > 0 ? makeScene(blobs, embedded, random) : null,
  };
  return { data, blobs: blobs.scripts };
}

/** Fills the template as evaluate/report_document.cpp does. */
export function fillTemplate(template, { data, blobs }) {
  const json = JSON.stringify(data).replaceAll("<", "\\u003c");
  const [head, rest] = template.split("<!--TOILE_DATA-->");
  const [middle, tail] = rest.split("<!--TOILE_BLOBS-->");
  return [head, `<script type="application/json" id="data">${json}</script>`, middle, blobs.join("\n"), tail].join("");
}
