import { describe, expect, test } from "vitest";

import type { Document } from "../src/api/types";
import { neighbour } from "../src/model/runs";
import { onward, type Seen, STEPS } from "../src/model/tour";

const nothing: Seen = { document: null, selected: [], simulated: undefined, playing: false };
const of = (name: string, step: number): Seen["document"] => ({ name, step }) as Document;

describe("the tour", () => {
  test("waits at each step for what that step asks", () => {
    for (const step of STEPS.keys()) {
      const tour = { step, since: 3 };
      const seen = { ...nothing, document: of("other.yaml", 3) };
      expect(onward(tour, seen)).toBe(tour);
    }
  });

  test("goes on when it was done, and ends after the last", () => {
    const opened = { ...nothing, document: of("double_pendulum.yaml", 1) };
    expect(onward({ step: 0, since: 0 }, opened)).toEqual({ step: 1, since: 1 });
    const chosen = { ...opened, selected: ["bodies/lower"] };
    expect(onward({ step: 1, since: 1 }, chosen)).toEqual({ step: 2, since: 1 });
    expect(onward({ step: 2, since: 1 }, { ...opened, document: of("double_pendulum.yaml", 2) })?.step).toBe(3);
    expect(onward({ step: 4, since: 2 }, { ...opened, playing: true })).toBeNull();
  });

  test("a wire that is chosen is no body", () => {
    const wire = { ...nothing, document: of("double_pendulum.yaml", 1), selected: ["closures/loop"] };
    expect(onward({ step: 1, since: 1 }, wire)?.step).toBe(1);
  });
});

describe("a step in a run", () => {
  const t = [0, 0.1, 0.2];
  test.each([
    [0, 1, 0.1],
    [0.05, 1, 0.1],
    [0.2, 1, 0.2],
    [0.2, -1, 0.1],
    [0.15, -1, 0.1],
    [0, -1, 0],
  ] as const)("from %d by %d: %d", (at, by, to) => expect(neighbour(t, at, by)).toBe(to));
  test("without records, stays", () => expect(neighbour([], 0.3, 1)).toBe(0.3));
});
