import { Color } from "three";
import type { ColourMapName } from "../document";

/** Colours from a field's low to its high end, evenly spaced. */
const stops: Record<ColourMapName, string[]> = {
  stretch: ["#1f4fd8", "#ffffff", "#d8261f"],
  diverging: ["#2166ac", "#67a9cf", "#d1e5f0", "#f7f7f7", "#fddbc7", "#ef8a62", "#b2182b"],
  // viridis (Smith, van der Walt, CC0)
  sequential: ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"],
};

const tableSize = 256;

/** [256 x 3] linear colours, as three.js' vertex colours want them. */
function makeTable(name: ColourMapName): Float32Array {
  const colours = stops[name].map((stop) => new Color(stop));
  const table = new Float32Array(3 * tableSize);
  const mixed = new Color();
  for (let entry = 0; entry < tableSize; ++entry) {
    const at = (entry / (tableSize - 1)) * (colours.length - 1);
    const before = Math.min(Math.floor(at), colours.length - 2);
    mixed.lerpColors(colours[before]!, colours[before + 1]!, at - before).toArray(table, 3 * entry);
  }
  return table;
}

const tables = new Map<ColourMapName, Float32Array>();

/** Writes the colour of each value into `colours` [3 x count]; values beyond the range take the colour of its end. */
export function colourValues(
  values: Float32Array,
  low: number,
  high: number,
  map: ColourMapName,
  colours: Float32Array,
): void {
  let table = tables.get(map);
  if (!table) tables.set(map, (table = makeTable(map)));
  const scale = high > low ? (tableSize - 1) / (high - low) : 0;
  values.forEach((value, vertex) => {
    const entry = Math.min(Math.max(Math.round((value - low) * scale), 0), tableSize - 1);
    colours.set(table.subarray(3 * entry, 3 * entry + 3), 3 * vertex);
  });
}

/** The same colours for a legend. The style sheet mixes them in linear light too, as the view does. */
export function gradientOf(map: ColourMapName): string {
  return `linear-gradient(in srgb-linear to right, ${stops[map].join(", ")})`;
}
