export interface AxisRange {
  min: number;
  max: number;
  /** Where ticks, labels and grid lines go. */
  ticks: number[];
}

/** Whole decades, or 1-2-5 steps where the values span less; ticks at 1-2-5 up to three decades. */
export function logRange(values: number[]): AxisRange {
  const low = Math.min(...finite(values));
  const high = Math.max(...finite(values));
  if (!(low > 0) || !Number.isFinite(high)) return { min: 1, max: 10, ticks: [1, 10] };
  const narrow = Math.log10(high / low) < 2;
  const steps = narrow ? oneTwoFive(low, high) : powersOfTen(low, high);
  const min = steps.filter((step) => step <= low * 1.0001).at(-1)!;
  const max = steps.find((step) => step >= high * 0.9999 && step > min)!;
  const decades = Math.log10(max / min);
  const candidates = decades <= 3.01 ? oneTwoFive(min, max) : powersOfTen(min, max);
  const inside = candidates.filter((tick) => tick >= min * 0.9999 && tick <= max * 1.0001);
  const stride = Math.ceil(inside.length / 12);
  return { min, max, ticks: inside.filter((_, index) => index % stride === 0) };
}

function finite(values: number[]): number[] {
  return values.filter(Number.isFinite);
}

function powersOfTen(low: number, high: number): number[] {
  const steps: number[] = [];
  for (let exponent = Math.floor(Math.log10(low)) - 1; exponent <= Math.ceil(Math.log10(high)) + 1; ++exponent) {
    steps.push(Number(`1e${exponent}`));
  }
  return steps;
}

function oneTwoFive(low: number, high: number): number[] {
  return powersOfTen(low, high).flatMap((power) => [power, 2 * power, 5 * power]);
}
