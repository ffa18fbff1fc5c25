import { makeCurves } from "./curves";
import type { Block, PictureBlock, SceneData } from "./document";
import { element } from "./dom";
import { makeHistogram } from "./histogram";
import { makeTable } from "./table";
import { makeViewer } from "./viewer/viewer";

/** A block under its title; nothing for a viewer without a scene. */
export function makeBlock(block: Block, scene: SceneData | null): HTMLElement | null {
  if (block.type === "viewer" && (!scene || scene.samples.length === 0)) return null;
  return element(
    "article",
    { id: block.id, class: `block ${block.type}-block` },
    block.title ? element("h3", {}, block.title) : null,
    "note" in block && block.note ? element("p", { class: "block-note" }, block.note) : null,
    makeContent(block, scene),
  );
}

function makeContent(block: Block, scene: SceneData | null): HTMLElement {
  switch (block.type) {
    case "table":
      return makeTable(block);
    case "curves":
      return makeCurves(block);
    case "histogram":
      return makeHistogram(block);
    case "picture":
      return makePicture(block);
    case "viewer":
      return makeViewer(block, scene!);
  }
}

function makePicture(block: PictureBlock): HTMLElement {
  return element("img", { src: block.src, alt: block.alt, class: "picture" });
}
