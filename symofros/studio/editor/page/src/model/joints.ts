/** Kinds of joints: how many speeds, and which entries of the file say something about them. */

import type { JsonMap } from "../api/types";
import table from "./joint_kinds.json";

interface JointKind {
  speeds: number;
  entries: string[];
  glyph: string;
}

/** The table of joint kinds, written by symofros/studio/editor/joint_table.py. */
export const JOINT_KINDS: Record<string, JointKind> = table;

export function speeds(joint: JsonMap): number {
  if (joint["kind"] === "general") return Array.isArray(joint["coordinates"]) ? joint["coordinates"].length : 0;
  return JOINT_KINDS[String(joint["kind"])]?.speeds ?? 0;
}

const ENTRIES = [...new Set(Object.values(JOINT_KINDS).flatMap((kind) => kind.entries)), "prescribed"];

/** Entries about how a joint of this kind moves; those that the file gives are never hidden. */
export function motionEntries(joint: JsonMap): string[] {
  const kind = String(joint["kind"]);
  const all = ["name", "kind", "parent", "frame", "position", "rotation", ...(JOINT_KINDS[kind]?.entries ?? [])];
  if (kind !== "fixed") all.push("prescribed");
  return [...all, ...ENTRIES.filter((key) => key in joint && !all.includes(key))];
}

export const forceEntries: readonly string[] = ["actuated", "effort", "elements", "armature", "rotors"];
