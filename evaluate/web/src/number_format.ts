const missing = "–";

/** A number with `significant` digits, with an exponent where it is far from 1; whole numbers are written in full. */
export function formatNumber(value: number | null | undefined, significant = 4): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return missing;
  return formatAlike(value, value, significant);
}

/** A number with the decimals that `model` gets for its significant digits: for the ends of its interval. */
export function formatAlike(value: number, model: number, significant: number): string {
  const magnitude = Math.abs(model);
  if (value === 0 || (Number.isInteger(value) && Number.isInteger(model) && Math.abs(value) < 1e7))
    return withMinusSign(String(value));
  if (magnitude !== 0 && (magnitude < 1e-3 || magnitude >= 1e7)) return exponential(value, significant);
  const whole = magnitude === 0 ? 1 : Math.floor(Math.log10(magnitude)) + 1;
  return withMinusSign(value.toFixed(Math.min(Math.max(significant - whole, 0), 20)));
}

function exponential(value: number, significant: number): string {
  return withMinusSign(value.toExponential(Math.max(significant - 1, 0)).replace("e+", "e"));
}

/** A few significant digits without trailing zeros. */
export function formatShort(value: number, significant = 4): string {
  const magnitude = Math.abs(value);
  if (magnitude !== 0 && (magnitude < 1e-3 || magnitude >= 1e6)) {
    const [mantissa, exponent] = value.toExponential(significant - 1).split("e");
    return withMinusSign(`${Number(mantissa)}e${Number(exponent)}`);
  }
  return withMinusSign(String(Number(value.toPrecision(significant))));
}

/** A label of a logarithmic axis: 0.01, 1, 500, 10⁵. */
export function formatTick(value: number): string {
  const exponent = Math.round(Math.log10(Math.abs(value)));
  const isPowerOfTen = Math.abs(value / 10 ** exponent - 1) < 1e-9;
  if (isPowerOfTen && (exponent < -3 || exponent > 4)) return `10${superscript(exponent)}`;
  return formatShort(value, 3);
}

export function withUnit(text: string, unit?: string): string {
  return unit ? `${text} ${unit}` : text;
}

function superscript(exponent: number): string {
  return [...String(exponent)].map((digit) => (digit === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(digit)])).join("");
}

function withMinusSign(text: string): string {
  return text.replaceAll("-", "−");
}
