/** Which properties of a beam stand in which part of its window: read off the published schema. */

import type { Json, JsonMap } from "../api/types";
import { mapAt } from "../model/paths";
import { field } from "./schema";

export const DIRECTIONS = ["bend_y", "bend_z", "twist", "stretch", "shear_y", "shear_z"];
/** What a section by material and shape takes the place of (Beam's section properties). */
const PROPERTIES = [
  ...["rhoA", "EI_y", "EI_z", "EI_yz", "GJ", "EA", "GA_y", "GA_z", "rhoJ", "rhoI_y", "rhoI_z", "rhoI_yz"],
  ...["tension_center", "shear_center", "mass_center", "stiffness"],
];
const SHAPE_FUNCTIONS = [...DIRECTIONS, "family", "shapes"];

/** The properties of a beam by the parts of its window, in the order of the schema: formulas are of the section. */
export function beamGroups(root: JsonMap, properties: JsonMap, family: Json | undefined) {
  const names = Object.keys(properties);
  const shapeFunctions = names.filter(
    (name) => SHAPE_FUNCTIONS.includes(name) && (name !== "shapes" || family === "user"),
  );
  const others = names.filter((name) => !SHAPE_FUNCTIONS.includes(name));
  const section = others.filter((name) => PROPERTIES.includes(name));
  const formulas = others.filter(
    (name) => !section.includes(name) && field(root, mapAt(properties, [name])).shape.kind === "formula",
  );
  const model = others.filter((name) => name !== "section" && ![...section, ...formulas].includes(name));
  return { shapeFunctions, section, formulas, model };
}
