import { expect, test } from "vitest";

import { scaleBar } from "../src/model/scale";

test.each<[number, number, string]>([
  [1.4, 0.2, "20 cm"],
  [10, 2, "2 m"],
  [17, 5, "5 m"],
  [0.005, 0.001, "1 mm"],
  [0.0034, 0.001, "1 mm"],
  [0.0033, 0.0005, "500 µm"],
  [0.04, 0.01, "1 cm"],
  [9000, 2000, "2 km"],
])("a picture of %d m has a bar of %d m", (height, length, text) => {
  const bar = scaleBar(height);
  expect(bar?.text).toBe(text);
  expect(bar?.share).toBeCloseTo(length / height, 12);
  expect(bar?.share).toBeLessThanOrEqual(0.3);
  expect(bar?.share).toBeGreaterThan(0.3 / 2.5 - 1e-12);
});

test("a picture without a height has none", () => {
  expect([0, -1, Infinity, NaN].map(scaleBar)).toEqual([null, null, null, null]);
});
