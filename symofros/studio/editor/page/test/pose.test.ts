import { expect, test } from "vitest";

import { merged, requestsOf } from "../src/model/pose";

test("looks that wait outlive the instant of a run, sliders do not", () => {
  const waiting = { dark: true, marked: ["bodies/arm"], q: { q1: 1 }, par: { L: 2 } };
  const both = merged(waiting, { run: "3", t: 0.5, block: "" });
  expect(both).toEqual({ dark: true, marked: ["bodies/arm"], run: "3", t: 0.5, block: "" });
  expect(requestsOf(both)).toEqual([
    { dark: true, marked: ["bodies/arm"] },
    { run: "3", t: 0.5, block: "" },
  ]);
  expect(merged(both, { q: { q2: 4 } })).toEqual({ dark: true, marked: ["bodies/arm"], q: { q2: 4 } });
});

test("the newest of each value waits", () => {
  expect(merged({ q: { q1: 1, q2: 2 } }, { q: { q1: 3 } })).toEqual({ q: { q1: 3, q2: 2 }, par: {} });
  expect(requestsOf({ q: { q1: 3 } })).toEqual([{ q: { q1: 3 } }]);
  expect(merged(null, { reset: true })).toEqual({ reset: true });
});
