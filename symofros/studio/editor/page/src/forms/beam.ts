/** Which properties of a beam stand in which part of its window: read off the published schema. */

import type { Json, JsonMap } from "../api/types";
import { mapAt } from "../model/paths";
import { field } from "./schema";

export const DIRECTIONS = ["bend_y", "bend_z", "twist", "stretch", "shear_y", "shear_z"];
const SHAPE_FUNCTIONS = [...DIRECTIONS, "family", "shapes"];

/** The properties of a beam by the parts of its window, in the order of the schema: formulas are of the section. */
export function beamGroups(root: JsonMap, properties: JsonMap, family: Json | undefined) {
  const names = Object.keys(properties);
  const shapeFunctions = names.filter(
    (name) => SHAPE_FUNCTIONS.includes(name) && (name !== "shapes" || family === "user"),
  );
  const others = names.filter((name) => !SHAPE_FUNCTIONS.includes(name));
  const section = others.filter((name) => field(root, mapAt(properties, [name])).shape.kind === "formula");
  return { shapeFunctions, section, model: others.filter((name) => !section.includes(name)) };
}
