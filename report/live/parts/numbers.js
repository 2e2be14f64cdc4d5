// Numbers in words and on axes.

/** With so many significant digits, as a person writes it; a true minus sign. */
export function digits(value, count = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const size = Math.abs(Number(value.toPrecision(count)));
  if (size === 0) return "0";
  if (size >= 1e6 || size < 1e-4) return value.toExponential(count - 1).replace("-", "−");
  const places = Math.max(0, count - 1 - Math.floor(Math.log10(size)));
  return fixed(value, places);
}

/** With so many places. */
export function fixed(value, places) {
  if (!Number.isFinite(value)) return "–";
  return value.toFixed(places).replace("-", "−");
}

/** With its sign. */
export function signed(value, count = 3) {
  return (value > 0 ? "+" : "") + digits(value, count);
}

/** Places of an axis' labels: at most `most` even numbers from low to high. */
export function ticks(low, high, most = 6) {
  const span = high - low;
  if (!(span > 0) || !Number.isFinite(span)) return { at: [low], places: 2 };
  const raw = span / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find(f => f * power >= raw * (1 - 1e-9));
  const at = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * span; k++) at.push(k * step);
  return { at, places: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

/** Root of the mean of squares. */
export function rms(values) {
  let sum = 0;
  for (const v of values) sum += v * v;
  return Math.sqrt(sum / Math.max(values.length, 1));
}

/** A quantile of numbers; those that are none are left out. */
export function quantile(values, share) {
  const sorted = Float64Array.from(values).filter(Number.isFinite).sort();
  if (!sorted.length) return NaN;
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}
