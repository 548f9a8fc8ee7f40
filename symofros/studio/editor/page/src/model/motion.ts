/** What a run can be given by name: starts of coordinates and speeds, and inputs. */

import type { JsonMap } from "../api/types";
import type { Texts } from "./asked";
import { coordinatesOf, type Quantity, speedsOf, turnsFreely } from "./joints";
import { bodyNames, jointName } from "./names";
import { mapAt } from "./paths";

interface Joint {
  name: string;
  entry: JsonMap;
}

function joints(data: JsonMap): Joint[] {
  return bodyNames(data).map((body) => ({
    name: jointName(data, body),
    entry: mapAt(data, ["bodies", body, "joint"]),
  }));
}

/** Joints that a run moves; those with a prescribed motion are inputs. */
const moving = (data: JsonMap): Joint[] => joints(data).filter(({ entry }) => entry["prescribed"] !== true);

// One gives an orientation by three angles: four numbers of unit length are for machines.
const ANGLES = ["roll", "pitch", "yaw"];
const QUATERNION = ["qx", "qy", "qz", "qw"];

const isOfQuaternion = ({ name }: Quantity): boolean => QUATERNION.some((suffix) => name.endsWith(`.${suffix}`));

/** Positions that a number each can start; orientations as roll, pitch, yaw. The others start neutral. */
export function starts(data: JsonMap): Quantity[] {
  return moving(data).flatMap(({ name, entry }) => {
    const all = coordinatesOf(entry, name);
    if (!turnsFreely(entry)) return all;
    const angles = ANGLES.map((angle) => ({ name: `${name}.${angle}`, unit: "rad" }));
    return [...all.filter((each) => !isOfQuaternion(each)), ...angles];
  });
}

/** Speeds that a number each can start; the others start at rest. */
export const rates = (data: JsonMap): Quantity[] => moving(data).flatMap(({ name, entry }) => speedsOf(entry, name));

/** x, y, z, w of turns about fixed axes: roll about x, then pitch about y, then yaw about z. */
export function quaternion(roll: number, pitch: number, yaw: number): [number, number, number, number] {
  const [cx, cy, cz] = [Math.cos(roll / 2), Math.cos(pitch / 2), Math.cos(yaw / 2)];
  const [sx, sy, sz] = [Math.sin(roll / 2), Math.sin(pitch / 2), Math.sin(yaw / 2)];
  return [
    sx * cy * cz - cx * sy * sz,
    cx * sy * cz + sx * cy * sz,
    cx * cy * sz - sx * sy * cz,
    cx * cy * cz + sx * sy * sz,
  ];
}

/** Numbers of the coordinates that a run starts from, out of those that were typed. */
export function startNumbers(data: JsonMap, typed: Texts): Record<string, number> {
  const numbers: Record<string, number> = Object.fromEntries(
    Object.entries(typed).map(([name, text]) => [name, Number(text)]),
  );
  for (const { name, entry } of moving(data)) {
    if (!turnsFreely(entry)) continue;
    const angles = ANGLES.map((angle) => `${name}.${angle}`);
    if (!angles.some((angle) => angle in numbers)) continue;
    const [roll, pitch, yaw] = angles.map((angle) => numbers[angle] ?? 0);
    for (const angle of angles) delete numbers[angle];
    quaternion(roll ?? 0, pitch ?? 0, yaw ?? 0).forEach((part, i) => {
      numbers[`${name}.${QUATERNION[i] ?? ""}`] = part;
    });
  }
  return numbers;
}

/** Roll, pitch, yaw of a rotation vector: what `quaternion` takes. */
export function anglesOfTurn(turn: readonly [number, number, number]): [number, number, number] {
  const angle = Math.hypot(...turn);
  const share = angle === 0 ? 0 : Math.sin(angle / 2) / angle;
  const [x, y, z] = [share * turn[0], share * turn[1], share * turn[2]];
  const w = Math.cos(angle / 2);
  return [
    Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x)))),
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
  ];
}

// Rounding below what a start that is kept may be off.
const START_DIGITS = 10;

/** The rotation vector of a quaternion x, y, z, w. */
function turnOf([x, y, z, w]: readonly number[]): [number, number, number] {
  const [a, b, c, d] = [x ?? 0, y ?? 0, z ?? 0, w ?? 1];
  const size = Math.hypot(a, b, c);
  const factor = size === 0 ? 0 : (2 * Math.atan2(size, d)) / size;
  return [factor * a, factor * b, factor * c];
}

/** The turn of a joint that turns freely: as the sliders say it, else of its quaternion. */
function turnIn(values: Readonly<Record<string, number>>, name: string): [number, number, number] {
  if (`${name}.qw` in values) return turnOf(QUATERNION.map((part) => values[`${name}.${part}`] ?? 0));
  const [x, y, z] = ["x", "y", "z"].map((axis) => values[`${name}.turn_${axis}`] ?? 0);
  return [x ?? 0, y ?? 0, z ?? 0];
}

/** The texts of a start at coordinates: a model's, or as the sliders of the 3-D view say them, by rotation vectors. */
export function startTexts(data: JsonMap, shown: Readonly<Record<string, number>>): Texts {
  const values: Record<string, number> = { ...shown };
  for (const { name, entry } of moving(data)) {
    if (!turnsFreely(entry)) continue;
    anglesOfTurn(turnIn(shown, name)).forEach((angle, i) => (values[`${name}.${ANGLES[i] ?? ""}`] = angle));
  }
  return Object.fromEntries(
    starts(data).flatMap(({ name }) => {
      const value = values[name];
      return value === undefined ? [] : [[name, String(Number(value.toPrecision(START_DIGITS)))]];
    }),
  );
}

/** An input, and what it is where nothing is given. */
export interface InputRow {
  name: string;
  fallback: string;
}

/** What a prescribed joint is moved by: coordinates, speeds, and the rates of these. */
function prescribedBy({ name, entry }: Joint): InputRow[] {
  const isFree = turnsFreely(entry);
  const speeds = speedsOf(entry, name).map((each) => (isFree ? each.name : `d${each.name}`));
  return [
    ...coordinatesOf(entry, name).map((each) => ({ name: each.name, fallback: each.name.endsWith(".qw") ? "1" : "0" })),
    ...[...speeds, ...speeds.map((speed) => `d${speed}`)].map((speed) => ({ name: speed, fallback: "0" })),
  ];
}

/** Inputs with names of their own, those of actuated joints, and those that prescribe a joint's motion. */
export function inputs(data: JsonMap): InputRow[] {
  const stated = Object.keys(mapAt(data, ["inputs"]));
  const actuated = moving(data).filter(({ entry }) => entry["actuated"] === true);
  const efforts = actuated.flatMap(({ name, entry }) => speedsOf(entry, name).map((each) => each.name));
  const prescribed = joints(data).filter(({ entry }) => entry["prescribed"] === true);
  return [...[...stated, ...efforts].map((name) => ({ name, fallback: "0" })), ...prescribed.flatMap(prescribedBy)];
}
