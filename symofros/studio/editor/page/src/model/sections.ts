/** Sections of a mechanism's file, by where they are edited. */

import type { Path } from "../api/types";

/** What the system window shows: all that concerns no single block. */
export const SYSTEM: readonly string[] = [
  "system",
  "virtual_power",
  "potentials",
  "states",
  "couplings",
  "switches",
  "events",
  "include",
];

/** What has a window for each of its entries. */
export const ENTRIES: readonly string[] = ["bodies", "closures", "connections", "contacts", "nonholonomic"];

/** What has a table in the side pane. */
export const TABLES: readonly string[] = ["parameters", "inputs"];

/** What links two frames. */
export const LINKS: readonly string[] = ["closures", "connections", "contacts"];

/** The entry that is edited in the window of another one: gravity with the ground, its switch with a constraint. */
export function beside([section, name]: Path): Path | null {
  if (section === "bodies") return ["system"];
  return name !== undefined && (section === "closures" || section === "nonholonomic") ? ["switches", name] : null;
}
