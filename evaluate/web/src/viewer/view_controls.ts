import type { Field, SceneData, View } from "../document";
import { element } from "../dom";
import { formatShort, withUnit } from "../number_format";
import { gradientOf } from "./colour_map";

/** What the viewer shows of a sample. */
export interface Shown {
  views: Set<string>;
  body: boolean;
  overlay: boolean;
  /** Key of the field that colours the cloth, or null: each view in a colour of its own. */
  field: string | null;
}

export interface ViewControls {
  /** Side by side or overlay, and the field. */
  choices: HTMLElement;
  /** Check boxes for views and body, and the field's legend. */
  boxes: HTMLElement;
}

export function makeViewControls(
  scene: SceneData,
  shown: Shown,
  viewColours: Map<string, string>,
  onChange: () => void,
): ViewControls {
  const legend = element("div", { class: "field-legend" });
  const showLegend = () => legend.replaceChildren(...legendOf(scene.fields.find((field) => field.key === shown.field)));
  showLegend();
  const fieldChoice = makeFieldChoice(scene.fields, shown, () => {
    showLegend();
    onChange();
  });
  const boxes = [makeViewBoxes(scene.views, shown, viewColours, onChange), makeBodyBox(scene, shown, onChange), legend];
  return {
    choices: element("div", { class: "view-choices" }, makeLayoutChoice(shown, onChange), fieldChoice),
    boxes: element("div", { class: "view-boxes" }, ...boxes),
  };
}

function makeBox(label: string, checked: boolean, onChange: (checked: boolean) => void, swatch?: string): HTMLElement {
  const box = element("input", { type: "checkbox", checked });
  box.addEventListener("change", () => onChange(box.checked));
  const mark = swatch ? element("span", { class: "swatch", "aria-hidden": "true" }) : null;
  if (mark) mark.style.background = swatch!;
  return element("label", { class: "choice" }, box, mark, label);
}

function makeViewBoxes(views: View[], shown: Shown, colours: Map<string, string>, onChange: () => void): HTMLElement {
  const boxes = views.map((view) =>
    makeBox(
      view.name,
      shown.views.has(view.key),
      (checked) => {
        if (checked) shown.views.add(view.key);
        else shown.views.delete(view.key);
        onChange();
      },
      colours.get(view.key),
    ),
  );
  return element("div", { class: "choices", role: "group", "aria-label": "Cloth" }, ...boxes);
}

function makeBodyBox(scene: SceneData, shown: Shown, onChange: () => void): HTMLElement | null {
  if (!scene.body_triangle) return null;
  return makeBox("Body", shown.body, (checked) => {
    shown.body = checked;
    onChange();
  });
}

function makeLayoutChoice(shown: Shown, onChange: () => void): HTMLElement {
  const choice = element(
    "select",
    { "aria-label": "Layout" },
    element("option", { value: "side" }, "side by side"),
    element("option", { value: "overlay" }, "overlay"),
  );
  choice.addEventListener("change", () => {
    shown.overlay = choice.value === "overlay";
    onChange();
  });
  return choice;
}

function makeFieldChoice(fields: Field[], shown: Shown, onChange: () => void): HTMLElement {
  const choice = element(
    "select",
    { "aria-label": "Colour by" },
    element("option", { value: "" }, "plain colours"),
    ...fields.map((field) => element("option", { value: field.key, selected: field.key === shown.field }, field.name)),
  );
  choice.addEventListener("change", () => {
    shown.field = choice.value || null;
    onChange();
  });
  return choice;
}

function legendOf(field: Field | undefined): Node[] {
  if (!field) return [];
  const bar = element("span", { class: "bar", "aria-hidden": "true" });
  bar.style.background = gradientOf(field.map);
  const middle = field.map === "sequential" ? null : element("span", {}, formatShort((field.low + field.high) / 2));
  const ends = [field.low, field.high].map((end) => element("span", {}, withUnit(formatShort(end), field.unit)));
  return [
    element("span", { class: "name visually-hidden" }, field.name),
    element("span", { class: "scale" }, bar, element("span", { class: "ticks" }, ends[0], middle, ends[1])),
  ];
}
