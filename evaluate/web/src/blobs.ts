import type { Positions, Scalars } from "./document";

const inflated = new Map<string, Promise<ArrayBuffer>>();

/** The bytes of a blob, inflated when they are first asked for. */
export function readBlob(id: string): Promise<ArrayBuffer> {
  let bytes = inflated.get(id);
  if (!bytes) {
    bytes = inflate(id);
    inflated.set(id, bytes);
  }
  return bytes;
}

async function inflate(id: string): Promise<ArrayBuffer> {
  const node = document.getElementById(id);
  if (!node) throw new Error(`the report holds no blob "${id}"`);
  const packed = Uint8Array.from(atob(node.textContent!.trim()), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

export async function readIndices(id: string): Promise<Uint32Array> {
  return new Uint32Array(await readBlob(id));
}

/** [count x 3] positions [m]. */
export async function readPositions(positions: Positions): Promise<Float32Array> {
  const whole = new Uint16Array(await readBlob(positions.blob));
  if (whole.length !== 3 * positions.count) throw new Error(`blob "${positions.blob}" has another size than announced`);
  const scale = positions.low.map((low, axis) => (positions.high[axis]! - low) / 65535);
  return Float32Array.from(whole, (value, index) => positions.low[index % 3]! + value * scale[index % 3]!);
}

/** [count] numbers in the field's unit. */
export async function readScalars(scalars: Scalars): Promise<Float32Array> {
  const whole = new Uint16Array(await readBlob(scalars.blob));
  if (whole.length !== scalars.count) throw new Error(`blob "${scalars.blob}" has another size than announced`);
  const scale = (scalars.high - scalars.low) / 65535;
  return Float32Array.from(whole, (value) => scalars.low + value * scale);
}
