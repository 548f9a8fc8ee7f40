/** Names: fresh ones, those that bodies and frames have, and where they are used. */

import type { Json, JsonMap } from "../api/types";
import { isMap, mapAt, textAt } from "./paths";

/** `stem`, or the stem with the first number that is free. */
export function fresh(stem: string, taken: Iterable<string>): string {
  const used = new Set(taken);
  if (!used.has(stem)) return stem;
  const root = stem.replace(/_?\d+$/, "");
  const separator = /\d$/.test(root) ? "_" : "";
  let number = 2;
  while (used.has(`${root}${separator}${number}`)) number += 1;
  return `${root}${separator}${number}`;
}

export function bodyNames(data: JsonMap): string[] {
  return Object.keys(mapAt(data, ["bodies"]));
}

export function jointName(data: JsonMap, body: string): string {
  return textAt(data, ["bodies", body, "joint", "name"]) ?? `q_${body}`;
}

/** Every name that a new parameter, input or coordinate must not have. */
export function symbols(data: JsonMap): string[] {
  const joints = bodyNames(data).map((body) => jointName(data, body));
  return [...Object.keys(mapAt(data, ["parameters"])), ...Object.keys(mapAt(data, ["inputs"])), ...joints];
}

/** A file's name without its suffix. */
export const stem = (file: string): string => file.replace(/\.[^.]+$/, "");

/** Frames of a body that something can be put on, apart from its own; a beam has one, at its tip. */
export function frameNames(data: JsonMap, body: string): string[] {
  const frames = Object.keys(mapAt(data, ["bodies", body, "frames"]));
  const isBeam = isMap(mapAt(data, ["bodies", body])["beam"]);
  return isBeam && frames.length === 0 ? ["tip"] : frames;
}

/** Frames by the names that a model has them under: each body's own, and BODY.FRAME. */
export const allFrames = (data: JsonMap): string[] =>
  bodyNames(data).flatMap((body) => [body, ...frameNames(data, body).map((frame) => `${body}.${frame}`)]);

/** Names in a formula, in order; functions included. */
export function namesIn(formula: string): string[] {
  return [...new Set(formula.match(/[A-Za-z_][A-Za-z_0-9.]*/g) ?? [])];
}

/** `value` with whole names in its formulas replaced. */
export function renamed(value: Json, names: ReadonlyMap<string, string>): Json {
  if (typeof value === "string") return value.replace(/[A-Za-z_][A-Za-z_0-9]*/g, (name) => names.get(name) ?? name);
  if (Array.isArray(value)) return value.map((item) => renamed(item, names));
  if (isMap(value)) return Object.fromEntries(Object.entries(value).map(([key, item]) => [key, renamed(item, names)]));
  return value;
}
