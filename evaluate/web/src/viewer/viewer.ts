import { Box3, Sphere } from "three";
import { readIndices, readPositions, readScalars } from "../blobs";
import type { Field, Sample, Scalars, SceneData, View, ViewerBlock } from "../document";
import { element } from "../dom";
import { formatNumber } from "../number_format";
import { colourValues } from "./colour_map";
import { SamplePicker } from "./sample_picker";
import { ColouredMesh, type Panel, Stage } from "./stage";
import { makeViewControls, type Shown } from "./view_controls";

/** Plain colours of the views, by their place in the scene. */
const clothColours = ["#8fb3d9", "#e8a15c", "#7fbf8e", "#b79ad6", "#d98f9c", "#9aa7b5"];
const bodyColour = "#c9b8a8";
/** Width of a panel below which the panels take another row [px]. */
const narrowestPanel = 190;
/** Where a vertex has no value of the field. */
const noValueColour = "#9a9a9a";

/** The meshes of one sample as the GPU holds them. */
interface LoadedSample {
  sample: Sample;
  cloth: Map<string, ColouredMesh>;
  body: ColouredMesh | null;
}

/** Samples in 3D: body, ground truth, prediction and priors, side by side or over each other, coloured by a field. */
export function makeViewer(block: ViewerBlock, scene: SceneData): HTMLElement {
  return new Viewer(block, scene).node;
}

class Viewer {
  readonly node: HTMLElement;
  private readonly colours: Map<string, string>;
  private readonly shown: Shown;
  private readonly picker: SamplePicker;
  private readonly canvas = element("canvas", { "aria-hidden": "true" });
  private readonly panels = element("div", { class: "panels" });
  private readonly status = element("p", { class: "viewer-status", role: "status" });
  private readonly printCaption = element("p", { class: "print-caption" });
  private readonly images = element("div", { class: "images" });
  private readonly handle: HTMLElement;
  private stage: Stage | null = null;
  private loaded: LoadedSample | null = null;

  constructor(
    block: ViewerBlock,
    private readonly scene: SceneData,
  ) {
    this.colours = new Map(scene.views.map((view, index) => [view.key, clothColours[index % clothColours.length]!]));
    this.shown = {
      views: new Set(scene.views.map((view) => view.key)),
      body: true,
      overlay: false,
      field: scene.fields[0]?.key ?? null,
    };
    this.picker = new SamplePicker(scene, () => void this.load());
    this.handle = element(
      "div",
      {
        class: "stage",
        role: "application",
        tabindex: 0,
        "aria-label": `${block.title}: arrow keys turn the view, plus and minus zoom, 0 resets it`,
      },
      this.canvas,
      this.panels,
    );
    this.handle.addEventListener("keydown", (event) => this.onKey(event));
    const { choices, boxes } = makeViewControls(scene, this.shown, this.colours, () => void this.arrange());
    this.node = element(
      "div",
      { class: "viewer" },
      element("div", { class: "viewer-controls" }, this.picker.node, choices),
      boxes,
      this.handle,
      this.printCaption,
      element(
        "p",
        { class: "hint" },
        "Drag or use the arrow keys to turn; + and − zoom, 0 resets. All views turn together.",
      ),
      this.status,
      this.images,
    );
    new ResizeObserver(() => this.start()).observe(this.handle);
  }

  /** Called whenever the size changes: the first time that the viewer is seen, it loads its first sample. */
  private start(): void {
    if (this.handle.clientWidth === 0) return;
    if (this.stage) {
      this.arrange();
      return;
    }
    try {
      this.stage = new Stage(this.canvas, this.handle);
    } catch (reason) {
      this.handle.hidden = true;
      this.status.textContent = `The 3D view needs WebGL 2, which this browser does not offer (${String(reason)}).`;
      return;
    }
    void this.load();
  }

  private async load(): Promise<void> {
    const sample = this.picker.current();
    this.showImages(sample);
    this.printCaption.textContent = `Sample ${sample.id}, ${sample.split} split`;
    if (!this.stage) return;
    this.handle.setAttribute("aria-busy", "true");
    try {
      await documentParsed();
      const next = await loadSample(this.scene, sample);
      if (sample !== this.picker.current()) return; // another one was picked meanwhile
      const first = this.loaded === null;
      const previous = this.loaded;
      this.loaded = next;
      this.stage.frame(boundsOf(next));
      if (first) this.stage.resetCamera();
      await this.arrange();
      previous?.cloth.forEach((mesh) => mesh.dispose());
      previous?.body?.dispose();
      this.status.textContent = "";
    } catch (reason) {
      this.status.textContent = `Sample ${sample.id} cannot be shown: ${String(reason)}`;
    }
    this.handle.removeAttribute("aria-busy");
  }

  /** Lays out the panels for what is to be shown, paints the meshes and draws. */
  private async arrange(): Promise<void> {
    const { loaded, stage } = this;
    if (!loaded || !stage) return;
    const field = this.scene.fields.find((one) => one.key === this.shown.field);
    const views = this.scene.views.filter((view) => this.shown.views.has(view.key) && loaded.cloth.has(view.key));
    await Promise.all(views.map((view) => this.paint(view, loaded, field)));
    const body = this.shown.body && loaded.body ? [loaded.body.mesh] : [];
    const groups = this.shown.overlay ? [views] : views.map((view) => [view]);
    const nodes = groups.map((group) => element("div", { class: "panel" }, this.caption(group, loaded.sample)));
    const columns = Math.max(Math.min(groups.length, Math.floor(this.handle.clientWidth / narrowestPanel)), 1);
    this.panels.style.setProperty("--columns", String(columns));
    this.panels.replaceChildren(...nodes);
    stage.show(
      groups.map((group, index) => ({
        meshes: [...body, ...group.map((view) => loaded.cloth.get(view.key)!.mesh)],
        ...rectangleOf(nodes[index]!),
      })),
    );
    this.handle.dataset.drawn = String(loaded.sample.id);
  }

  private async paint(view: View, loaded: LoadedSample, field: Field | undefined): Promise<void> {
    const mesh = loaded.cloth.get(view.key)!;
    if (!field) {
      mesh.paint(this.colours.get(view.key)!);
      return;
    }
    const scalars = fieldOf(this.scene, loaded.sample, view, field);
    if (!scalars) {
      mesh.paint(noValueColour);
      return;
    }
    colourValues(await readScalars(scalars), field.low, field.high, field.map, mesh.colours);
    mesh.coloursChanged();
  }

  private caption(group: View[], sample: Sample): HTMLElement {
    const lines = group.map((view) => {
      const error = sample.error_mm?.[view.key];
      const suffix = typeof error === "number" && error > 0 ? `${formatNumber(error, 3)} mm` : null;
      return element("div", {}, view.name, suffix && element("span", { class: "error" }, suffix));
    });
    return element("div", { class: "caption" }, ...lines);
  }

  private showImages(sample: Sample): void {
    const pictures = (sample.image ?? []).map(({ name, src }) =>
      element(
        "figure",
        {},
        element("img", { src, alt: `${name} of sample ${sample.id}`, loading: "lazy" }),
        element("figcaption", {}, name),
      ),
    );
    this.images.replaceChildren(...pictures);
  }

  private onKey(event: KeyboardEvent): void {
    if (!this.stage || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = Math.PI / 18;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.stage!.turn(-step, 0),
      ArrowRight: () => this.stage!.turn(step, 0),
      ArrowUp: () => this.stage!.turn(0, step),
      ArrowDown: () => this.stage!.turn(0, -step),
      "+": () => this.stage!.turn(0, 0, 1.15),
      "=": () => this.stage!.turn(0, 0, 1.15),
      "-": () => this.stage!.turn(0, 0, 1 / 1.15),
      "0": () => this.stage!.resetCamera(),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }
}

async function loadSample(scene: SceneData, sample: Sample): Promise<LoadedSample> {
  const index = await readIndices(scene.triangle);
  const cloth = new Map<string, ColouredMesh>();
  for (const [key, view] of Object.entries(sample.cloth)) {
    cloth.set(key, new ColouredMesh(index, await readPositions(view.position)));
  }
  let body: ColouredMesh | null = null;
  if (scene.body_triangle && sample.body) {
    body = new ColouredMesh(await readIndices(scene.body_triangle), await readPositions(sample.body));
    body.paint(bodyColour);
  }
  return { sample, cloth, body };
}

/** A field's values of a view: the sample's own, or those that all samples share (such as μ). */
function fieldOf(scene: SceneData, sample: Sample, view: View, field: Field): Scalars | undefined {
  return sample.cloth[view.key]?.fields?.[field.key] ?? scene.vertex_fields?.[field.key];
}

function boundsOf(loaded: LoadedSample): Sphere {
  const box = new Box3();
  loaded.cloth.forEach((cloth) => box.expandByObject(cloth.mesh));
  return box.getBoundingSphere(new Sphere());
}

function rectangleOf(node: HTMLElement): Omit<Panel, "meshes"> {
  return { left: node.offsetLeft, top: node.offsetTop, width: node.offsetWidth, height: node.offsetHeight };
}

/** The blobs stand at the end of the page, so that all else is seen before they have been read. */
function documentParsed(): Promise<void> {
  if (document.readyState !== "loading") return Promise.resolve();
  return new Promise((resolve) => document.addEventListener("DOMContentLoaded", () => resolve(), { once: true }));
}
