import { expect, test } from "vitest";

import published from "../../../../description/yaml/schema.json";
import { ENTRIES, SYSTEM, TABLES } from "../src/model/sections";

// The version of the format; a section that no file may have yet.
const WITHOUT = ["symofros", "options"];

test("every section of the format can be edited in a window or a table", () => {
  expect([...ENTRIES, ...SYSTEM, ...TABLES, ...WITHOUT].sort()).toEqual(Object.keys(published.properties).sort());
});
