import type { Sample, SceneData } from "../document";
import { element } from "../dom";
import { formatNumber } from "../number_format";

type Order = "error" | "number";

/** The view whose error ranks the samples: the first that has errors (the prediction, where there is one). */
function rankingView(scene: SceneData): string | null {
  return (
    scene.views.find((view) => scene.samples.some((sample) => (sample.error_mm?.[view.key] ?? 0) > 0))?.key ?? null
  );
}

/** Picks a sample: by split, worst first or by number, from a list or one after the other. */
export class SamplePicker {
  readonly node: HTMLElement;
  private readonly list = element("select", { "aria-label": "Sample" });
  private readonly ranking: string | null;
  private order: Order;
  private split: string | null = null;
  private chosen: Sample;

  constructor(
    private readonly scene: SceneData,
    private readonly onPick: (sample: Sample) => void,
  ) {
    this.ranking = rankingView(scene);
    this.order = this.ranking ? "error" : "number";
    this.chosen = this.offered()[0]!;
    this.list.addEventListener("change", () => this.pick(this.offered()[this.list.selectedIndex]!));
    this.fill();
    this.node = element(
      "div",
      { class: "picker", role: "group", "aria-label": "Which sample" },
      this.makeSplitChoice(),
      this.makeOrderChoice(),
      this.makeStep("Previous sample", "‹", -1),
      this.list,
      this.makeStep("Next sample", "›", 1),
    );
  }

  current(): Sample {
    return this.chosen;
  }

  private pick(sample: Sample): void {
    this.chosen = sample;
    this.list.selectedIndex = this.offered().indexOf(sample);
    this.onPick(sample);
  }

  private errorOf(sample: Sample): number | null {
    return this.ranking ? (sample.error_mm?.[this.ranking] ?? null) : null;
  }

  private offered(): Sample[] {
    const samples = this.scene.samples.filter((sample) => this.split === null || sample.split === this.split);
    const byNumber = (a: Sample, b: Sample) => a.id - b.id;
    const byError = (a: Sample, b: Sample) => (this.errorOf(b) ?? -1) - (this.errorOf(a) ?? -1);
    return samples.sort(this.order === "error" ? byError : byNumber);
  }

  private fill(): void {
    const options = this.offered().map((sample) => {
      const error = this.errorOf(sample);
      const suffix = error === null ? "" : `, ${formatNumber(error, 3)} mm`;
      return element("option", {}, `${sample.id} (${sample.split})${suffix}`);
    });
    this.list.replaceChildren(...options);
    this.list.selectedIndex = Math.max(this.offered().indexOf(this.chosen), 0);
  }

  /** After another order or split: the first of the list is shown. */
  private refill(): void {
    this.fill();
    this.pick(this.offered()[0]!);
  }

  private makeSplitChoice(): HTMLElement | null {
    const splits = [...new Set(this.scene.samples.map((sample) => sample.split))];
    if (splits.length < 2) return null;
    const choice = element(
      "select",
      { "aria-label": "Split" },
      element("option", { value: "" }, "all splits"),
      ...splits.map((split) => element("option", { value: split }, split)),
    );
    choice.addEventListener("change", () => {
      this.split = choice.value || null;
      this.refill();
    });
    return choice;
  }

  private makeOrderChoice(): HTMLElement | null {
    if (!this.ranking) return null;
    const choice = element(
      "select",
      { "aria-label": "Order of the samples" },
      element("option", { value: "error" }, "worst first"),
      element("option", { value: "number" }, "by number"),
    );
    choice.addEventListener("change", () => {
      this.order = choice.value as Order;
      this.refill();
    });
    return choice;
  }

  private makeStep(label: string, sign: string, by: number): HTMLElement {
    const button = element("button", { type: "button", "aria-label": label }, sign);
    button.addEventListener("click", () => {
      const samples = this.offered();
      this.pick(samples[(samples.indexOf(this.chosen) + by + samples.length) % samples.length]!);
    });
    return button;
  }
}
