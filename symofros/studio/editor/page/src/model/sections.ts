/** Sections of a mechanism's file, by where they are edited. */

/** What the system window shows: all that concerns no single block. */
export const SYSTEM: readonly string[] = ["system", "virtual_power", "potentials", "couplings", "include"];

/** What has a window for each of its entries. */
export const ENTRIES: readonly string[] = ["bodies", "closures", "connections", "nonholonomic"];

/** What has a table in the side pane. */
export const TABLES: readonly string[] = ["parameters", "inputs"];
