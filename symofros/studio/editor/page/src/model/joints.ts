/** Kinds of joints: how many speeds, and which entries of the file say something about them. */

import type { JsonMap } from "../api/types";
import table from "./joint_kinds.json";

interface JointKind {
  speeds: number;
  /** Suffixes of the coordinates' names, a dot before each but ""; and units. */
  coordinates: string[];
  units: string[];
  /** Suffixes of the speeds where these are not the rates of the coordinates: of velocities in axes of the body. */
  quasi_velocities: string[] | null;
  entries: string[];
  glyph: string;
}

/** The table of joint kinds, written by symofros/studio/editor/joint_table.py. */
export const JOINT_KINDS: Record<string, JointKind> = table;

export function speeds(joint: JsonMap): number {
  if (joint["kind"] === "general") return Array.isArray(joint["coordinates"]) ? joint["coordinates"].length : 0;
  return JOINT_KINDS[String(joint["kind"])]?.speeds ?? 0;
}

/** A coordinate or a speed by the name that a run knows it by. */
export interface Quantity {
  name: string;
  unit: string;
}

const suffixed = (joint: string, suffix: string): string => (suffix === "" ? joint : `${joint}.${suffix}`);

/** The coordinates of a joint of that name. */
export function coordinatesOf(joint: JsonMap, name: string): Quantity[] {
  if (joint["kind"] === "general") {
    const names = Array.isArray(joint["coordinates"]) ? joint["coordinates"] : [];
    return names.map((each) => ({ name: String(each), unit: "" }));
  }
  const kind = JOINT_KINDS[String(joint["kind"])];
  return (kind?.coordinates ?? []).map((suffix, i) => ({ name: suffixed(name, suffix), unit: kind?.units[i] ?? "" }));
}

/** Which of two units, such as `N m or N`, a joint has that only turns, or only slides; both of another one. */
export function unitAt(joint: JsonMap, unit: string): string {
  const [turning, sliding] = unit.split(" or ");
  const [of, ...others] = new Set(JOINT_KINDS[String(joint["kind"])]?.units);
  if (sliding === undefined || turning === undefined || of === undefined || others.length > 0) return unit;
  return of === "rad" ? turning : sliding;
}

/** Its speeds: named as the coordinates whose rates they are, or velocities in axes of the body. */
export function speedsOf(joint: JsonMap, name: string): Quantity[] {
  const velocities = JOINT_KINDS[String(joint["kind"])]?.quasi_velocities ?? null;
  if (velocities === null)
    return coordinatesOf(joint, name).map((each) => ({ ...each, unit: each.unit === "" ? "" : `${each.unit}/s` }));
  return velocities.map((suffix) => ({
    name: suffixed(name, suffix),
    unit: suffix.startsWith("w") ? "rad/s" : "m/s",
  }));
}

/** Whether speeds are other than the rates of coordinates: then a quaternion is among these. */
export const turnsFreely = (joint: JsonMap): boolean =>
  (JOINT_KINDS[String(joint["kind"])]?.quasi_velocities ?? null) !== null;

const ENTRIES = [...new Set(Object.values(JOINT_KINDS).flatMap((kind) => kind.entries)), "prescribed"];

/** Entries about how a joint of this kind moves; those that the file gives are never hidden. */
export function motionEntries(joint: JsonMap): string[] {
  const kind = String(joint["kind"]);
  const all = ["name", "kind", "parent", "frame", "position", "rotation", ...(JOINT_KINDS[kind]?.entries ?? [])];
  if (kind !== "fixed") all.push("prescribed");
  return [...all, ...ENTRIES.filter((key) => key in joint && !all.includes(key))];
}

export const forceEntries: readonly string[] = ["actuated", "effort", "elements", "armature", "rotors"];
