/** The bar that says how large a picture shows things. */

export interface ScaleBar {
  /** Of the picture's height. */
  share: number;
  text: string;
}

const LONGEST = 0.3;
const UNITS = [
  [1000, "km"],
  [1, "m"],
  [0.01, "cm"],
  [0.001, "mm"],
] as const;
const SMALLEST = [1e-6, "µm"] as const;

/**
 * The longest bar of 1, 2 or 5 times a power of ten that is at most a third of the picture.
 *
 * @param height Of the picture, at the depth of what its camera looks at [m].
 */
export function scaleBar(height: number): ScaleBar | null {
  if (!(height > 0) || !Number.isFinite(height)) return null;
  const most = LONGEST * height;
  const power = 10 ** Math.floor(Math.log10(most));
  const length = (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1) * power;
  const [unit, name] = UNITS.find(([each]) => length >= 0.999 * each) ?? SMALLEST;
  return { share: length / height, text: `${Number((length / unit).toPrecision(6))} ${name}` };
}
