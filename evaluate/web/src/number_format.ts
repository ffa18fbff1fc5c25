const missing = "–";

/** `digits` decimals; a number that those would show as zero, or that is very large, is written with an exponent. */
export function formatNumber(value: number | null | undefined, digits?: number): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return missing;
  if (digits === undefined) return formatSignificant(value);
  const magnitude = Math.abs(value);
  if (magnitude !== 0 && (magnitude < 0.5 * 10 ** -digits || magnitude >= 1e9)) return formatSignificant(value, 2);
  return withMinusSign(value.toFixed(digits));
}

/** A few significant digits, with an exponent where the number is far from 1. */
export function formatSignificant(value: number, significant = 4): string {
  const magnitude = Math.abs(value);
  if (magnitude === 0) return "0";
  if (Number.isInteger(value) && magnitude < 1e7) return withMinusSign(String(value));
  if (magnitude < 1e-3 || magnitude >= 1e6) {
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
  return formatSignificant(value, 3);
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
