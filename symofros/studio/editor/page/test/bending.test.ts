import { expect, test } from "vitest";

import type { BentBeam, Job } from "../src/api/jobs";
import { badge, bentBy, cantilever, percent } from "../src/model/bending";

const bent = (beam: string, error: number | null): BentBeam => ({
  beam,
  slope: 0.3,
  station: 1,
  t: 0.5,
  error,
  exact: false,
  grade: "noted",
  text: "",
  remedy: "",
});
const job = (beams: BentBeam[], revision = 3): Job => ({
  id: "1",
  kind: "simulate",
  revision,
  path: "arm.yaml",
  state: "done",
  progress: { done: 1, total: 1, text: "" },
  result: { beams },
  error: null,
});

test("estimates have the figures of an estimate", () => {
  expect([0, 2e-5, 4e-4, 0.0123, 0.456, 3, null].map(percent)).toEqual([
    "below 0.01 %",
    "below 0.01 %",
    "0.04 %",
    "1.2 %",
    "46 %",
    "300 %",
    "beyond its critical load",
  ]);
  expect(badge(bent("a", 0.03))).toBe("± 3 %");
  expect(badge({ ...bent("a", 0), slope: 0 })).toBe("");
});

test("of a beam in segments the worst counts, and of a model that has changed nothing", () => {
  const run = job([bent("boom", 0.01), bent("boom.2", 0.2), bent("boom.3", 0.1), bent("mast", null)]);
  expect(bentBy(run, 3).get("boom")?.error).toBe(0.2);
  expect(bentBy(run, 3).get("mast")?.error).toBeNull();
  expect(bentBy(run, 4).size).toBe(0);
  expect(bentBy(undefined, 3).size).toBe(0);
});

test("a vibrating cantilever is clamped at its root, swings by 2 at its tip, and has a node more in each mode", () => {
  for (const mode of [0, 1, 2]) {
    expect(cantilever(mode, 0)).toBe(0);
    expect(Math.abs(cantilever(mode, 1))).toBeCloseTo(2, 9);
    const along = Array.from({ length: 200 }, (_, i) => cantilever(mode, 0.01 + 0.0049 * i));
    expect(along.filter((value, i) => i > 0 && value * (along[i - 1] ?? 0) < 0)).toHaveLength(mode);
  }
});
