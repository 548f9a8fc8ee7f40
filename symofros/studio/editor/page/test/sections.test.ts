import { expect, test } from "vitest";

import published from "../../../../description/yaml/schema.json";
import { ENTRIES, SYSTEM, TABLES } from "../src/model/sections";

// The version of the format; a section that no file may have yet.
const WITHOUT = ["symofros", "options"];
// What is kept, and edited as text.
const AS_TEXT = ["contacts", "events", "states", "switches"];

test("every section of the format can be edited in a window, in a table or as text", () => {
  expect([...ENTRIES, ...SYSTEM, ...TABLES, ...WITHOUT, ...AS_TEXT].sort()).toEqual(
    Object.keys(published.properties).sort(),
  );
});
