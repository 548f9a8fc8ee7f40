/** What a block says about its body besides its name. */

import type { GraphNode, Json, JsonMap } from "../api/types";
import { jointName } from "./names";
import { at, isMap, mapAt, textAt } from "./paths";

export interface Summary {
  joint: { name: string; kind: string; actuated: boolean; sprung: boolean } | null;
  note: string;
}

function count(beam: JsonMap, key: string): number {
  const value = beam[key];
  return typeof value === "number" ? value : 0;
}

/** Such as `3y 2z`: how many shape functions a beam has in each direction. */
export function modes(beam: JsonMap): string {
  const directions = [
    ["bend_y", "y"],
    ["bend_z", "z"],
    ["twist", "twist"],
    ["stretch", "stretch"],
    ["shear_y", "shear y"],
    ["shear_z", "shear z"],
  ] as const;
  const present = directions.filter(([key]) => count(beam, key) > 0);
  return present.length === 0 ? "rigid" : present.map(([key, word]) => `${count(beam, key)} ${word}`).join(" · ");
}

function vector(value: Json | undefined): string {
  return Array.isArray(value) ? `[${value.map(String).join(", ")}]` : "[0, 0, -9.81]";
}

function note(node: GraphNode, data: JsonMap): string {
  const entry = mapAt(data, node.path);
  switch (node.kind) {
    case "base":
      return `g ${vector(at(data, ["system", "gravity"]))}`;
    case "beam":
      return modes(mapAt(entry, ["beam"]));
    case "rigid_body": {
      const mass = at(entry, ["inertia", "mass"]);
      const shape = textAt(entry, ["solid", "shape"]);
      if (shape !== undefined) return shape;
      return mass === undefined ? "" : `${String(mass)}${typeof mass === "number" ? " kg" : ""}`;
    }
    case "massless_body":
      return "massless";
    case "nonholonomic":
      return Object.keys(entry)[0]?.replace("_", " ") ?? "";
  }
}

export function summary(node: GraphNode, data: JsonMap): Summary {
  const joint = at(data, [...node.path, "joint"]);
  if (!isMap(joint) || node.kind === "nonholonomic") return { joint: null, note: note(node, data) };
  const effort = joint["effort"];
  return {
    joint: {
      name: jointName(data, node.title),
      kind: textAt(joint, ["kind"]) ?? "no kind",
      actuated: joint["actuated"] === true || (Array.isArray(effort) ? effort.length > 0 : effort !== undefined),
      sprung: Array.isArray(joint["elements"]) && joint["elements"].length > 0,
    },
    note: note(node, data),
  };
}
