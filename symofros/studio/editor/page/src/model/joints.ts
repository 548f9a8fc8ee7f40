/** Kinds of joints: how many speeds, and which entries of the file say something about them. */

import type { JsonMap } from "../api/types";

const SPEEDS: Record<string, number> = {
  fixed: 0,
  revolute: 1,
  continuous: 1,
  prismatic: 1,
  screw: 1,
  cylindrical: 2,
  universal: 2,
  planar: 3,
  ball: 3,
  free: 6,
};

export function speeds(joint: JsonMap): number {
  if (joint["kind"] === "general") return Array.isArray(joint["coordinates"]) ? joint["coordinates"].length : 0;
  return SPEEDS[String(joint["kind"])] ?? 0;
}

const OWN: Record<string, readonly string[]> = {
  revolute: ["axis", "limits"],
  continuous: ["axis"],
  prismatic: ["axis", "limits"],
  screw: ["axis", "pitch", "limits"],
  cylindrical: ["axis"],
  universal: ["axis", "axis2"],
  general: ["coordinates", "moving_position", "moving_rotation"],
};

/** Entries about how a joint of this kind moves; those that the file gives are never hidden. */
export function motionEntries(joint: JsonMap): string[] {
  const kind = String(joint["kind"]);
  const all = ["name", "kind", "parent", "frame", "position", "rotation", ...(OWN[kind] ?? [])];
  if (kind !== "fixed") all.push("prescribed");
  const rest = ["axis", "axis2", "pitch", "limits", "coordinates", "moving_position", "moving_rotation", "prescribed"];
  return [...all, ...rest.filter((key) => key in joint && !all.includes(key))];
}

export const forceEntries: readonly string[] = ["actuated", "effort", "elements", "armature", "rotors"];
