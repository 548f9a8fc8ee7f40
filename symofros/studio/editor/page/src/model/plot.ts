/** Numbers -> lines and scales. */

export type Span = readonly [number, number];

export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** The least and the greatest finite value, apart from each other so that one can divide by the difference. */
export function span(values: readonly (number | null)[]): Span {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value === null || !Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) return [0, 1];
  if (low < high) return [low, high];
  const margin = Math.abs(low) || 1;
  return [low - margin, high + margin];
}

/** Spans that hold the given ones, with one scale along both sides of a box. */
export function equal(xs: Span, ys: Span, box: Box): [Span, Span] {
  const scale = 1.06 * Math.max((xs[1] - xs[0]) / box.width, (ys[1] - ys[0]) / box.height);
  const about = ([low, high]: Span, extent: number): Span => {
    const middle = (low + high) / 2;
    return [middle - (scale * extent) / 2, middle + (scale * extent) / 2];
  };
  return [about(xs, box.width), about(ys, box.height)];
}

/** Round numbers inside a span, about as many as asked for. */
export function ticks([low, high]: Span, count: number): number[] {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = ([1, 2, 5, 10].find((each) => each * power >= rough) ?? 10) * power;
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

// More points than pixels are not seen.
const MOST = 1500;

/** A polyline; it breaks where a value is not finite. */
export function line(
  x: readonly (number | null)[],
  values: readonly (number | null)[],
  xs: Span,
  ys: Span,
  box: Box,
): string {
  const stride = Math.max(1, Math.ceil(x.length / MOST));
  let path = "";
  let pen = "M";
  for (let i = 0; i < x.length; i += stride) {
    const value = values[i];
    const at = x[i];
    if (value === undefined || value === null || at === undefined || at === null) {
      pen = "M";
      continue;
    }
    const px = box.x + (box.width * (at - xs[0])) / (xs[1] - xs[0]);
    const py = box.y + box.height * (1 - (value - ys[0]) / (ys[1] - ys[0]));
    path += `${pen}${px.toFixed(1)},${py.toFixed(1)}`;
    pen = "L";
  }
  return path;
}

/** The points of a curve inside a span, with the ones beside it, so that lines go on to its ends. */
export function within(
  x: readonly (number | null)[],
  y: readonly (number | null)[],
  range: Span | null,
): { x: readonly (number | null)[]; y: readonly (number | null)[] } {
  if (range === null) return { x, y };
  const first = x.findIndex((at) => at !== null && at >= range[0]);
  const last = x.findLastIndex((at) => at !== null && at <= range[1]);
  const [from, to] = [Math.max(0, (first < 0 ? x.length : first) - 1), last + 2];
  return { x: x.slice(from, to), y: y.slice(from, to) };
}

/** The place of the value that is nearest to one, in a list that rises. */
export function nearest(values: readonly (number | null)[], value: number): number {
  let [low, high] = [0, values.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if ((values[middle] ?? Infinity) <= value) low = middle;
    else high = middle;
  }
  const [before, after] = [values[low] ?? NaN, values[high] ?? NaN];
  return after - value < value - before ? high : low;
}

/** Four figures, short. */
export function brief(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-3 ? value.toExponential(2) : String(Number(value.toPrecision(4)));
}
