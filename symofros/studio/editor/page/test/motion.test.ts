import { expect, test } from "vitest";

import type { JsonMap } from "../src/api/types";
import { followed, known, newName, strangers } from "../src/model/asked";
import { JOINT_KINDS } from "../src/model/joints";
import { anglesOfTurn, inputs, quaternion, rates, startNumbers, startTexts, starts } from "../src/model/motion";

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

const model = (joint: JsonMap): JsonMap => ({ inputs: { tau: {} }, bodies: { a: { joint: { name: "q", ...joint } } } });
const names = (rows: { name: string }[]): string[] => rows.map(({ name }) => name);

test.each(Object.keys(JOINT_KINDS).filter((kind) => kind !== "general"))(
  "a joint of kind %s has a field for each speed, and one for each motion",
  (kind) => {
    const data = model({ kind, actuated: true });
    const count = JOINT_KINDS[kind]?.speeds;
    expect(rates(data)).toHaveLength(count ?? -1);
    expect(starts(data)).toHaveLength(count ?? -1); // Of an orientation three angles.
    expect(names(inputs(data))).toEqual(["tau", ...names(rates(data))]);
  },
);

test("coordinates of one's own", () => {
  const data = model({ kind: "general", coordinates: ["s", "r"], prescribed: true });
  expect(names(starts(data))).toEqual([]);
  expect(names(inputs(data))).toEqual(["tau", "s", "r", "ds", "dr", "dds", "ddr"]);
});

test("a prescribed orientation begins neutral", () => {
  const rows = inputs(model({ kind: "ball", prescribed: true }));
  expect(rows.find(({ name }) => name === "q.qw")?.fallback).toBe("1");
  expect(names(rows).slice(-3)).toEqual(["dq.wx", "dq.wy", "dq.wz"]);
});

test("roll, pitch, yaw are turns about fixed axes", () => {
  // By another program: Rotation.from_euler("xyz", ...) of SciPy.
  const expected = [0.2513019482416863, -0.13286838981801152, 0.5322705776530124, 0.7974216914293402];
  quaternion(0.3, -0.5, 1.1).forEach((part, i) => expect(part).toBeCloseTo(expected[i] ?? NaN, 14));
});

test("angles become a quaternion, other numbers stay", () => {
  const data = model({ kind: "free" });
  expect(startNumbers(data, { "q.px": "2", "q.yaw": "0" })).toEqual({
    "q.px": 2,
    "q.qx": 0,
    "q.qy": 0,
    "q.qz": 0,
    "q.qw": 1,
  });
  expect(startNumbers(data, { "q.px": "2" })).toEqual({ "q.px": 2 });
});

test("texts of names that are gone are apart from the others, and follow new names", () => {
  const texts = { tau: "sin(t)", left: "1", empty: " " };
  expect(known(texts, ["tau", "empty"])).toEqual({ tau: "sin(t)" });
  expect(strangers(texts, ["tau", "empty"])).toEqual({ left: "1" });
  const renamed = { torque: "sin(t)", left: "1", empty: " " };
  expect(followed(texts, newName(["a", "tau"], ["a", "torque"]))).toEqual(renamed);
  expect(followed(texts, newName(["tau"], []))).toEqual(texts);
});
