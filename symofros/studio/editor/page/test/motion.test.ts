import { expect, test } from "vitest";

import type { JsonMap } from "../src/api/types";
import { anglesOfTurn, quaternion, startTexts } from "../src/model/motion";

test("angles of a turn are those of its quaternion", () => {
  for (const turn of [
    [0, 0, 0],
    [0.3, -0.2, 0.5],
    [-1.1, 0.9, 0.4],
    [0, 0, 3],
  ] as [number, number, number][]) {
    const angle = Math.hypot(...turn);
    const share = angle === 0 ? 0 : Math.sin(angle / 2) / angle;
    const expected = [...turn.map((part) => share * part), Math.cos(angle / 2)];
    quaternion(...anglesOfTurn(turn)).forEach((part, i) => expect(part).toBeCloseTo(expected[i] ?? NaN, 12));
  }
});

test("starts are what the sliders of the 3-D view say", () => {
  const data: JsonMap = {
    bodies: {
      base: { joint: { name: "b", kind: "free" } },
      arm: { joint: { name: "q", kind: "revolute", parent: "base" } },
      cart: { joint: { name: "x", kind: "prismatic", prescribed: true } },
    },
  };
  const shown = { "b.px": 1, "b.py": 0, "b.pz": -2, "b.turn_x": 0, "b.turn_y": 0, "b.turn_z": 0.25, q: 1 / 3, x: 5 };
  expect(startTexts(data, shown)).toEqual({
    "b.px": "1",
    "b.py": "0",
    "b.pz": "-2",
    "b.roll": "0",
    "b.pitch": "0",
    "b.yaw": "0.25",
    q: "0.3333333333",
  });
});
